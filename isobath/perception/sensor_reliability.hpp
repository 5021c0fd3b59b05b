// SensorReliability: how often the readings of each sensor agree with their predictions (ledger S1-06; the paper,
// Oskard 1990, I, names a learning module and gives no method).
//
//   reliability = (n+ + 1) / (n+ + n- + 2)     mean of the posterior of a share under a uniform prior (Laplace)
//
// with n+ confirming and n- conflicting readings. Irrelevant readings are counted but have no effect. Weights are
// suggestions: they apply only if the configuration says so. One thread at a time; counting allocates nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

enum class Agreement : std::uint8_t { kConfirming, kConflicting, kIrrelevant };

/// Compares a reading with its prediction (S1-04): confirming if it is within `gate` standard deviations, sigma that of
/// their difference. An absent echo confirms a predicted absence and conflicts with a predicted echo. Do not call it
/// without a prediction.
Agreement agreement(std::optional<double> range_m, std::optional<double> predicted_m, double sigma_m, double gate = 3);

struct ReliabilityCounts {
  std::uint64_t confirming = 0;
  std::uint64_t conflicting = 0;
  std::uint64_t irrelevant = 0;

  [[nodiscard]] double reliability() const {
    return (static_cast<double>(confirming) + 1) / (static_cast<double>(confirming + conflicting) + 2);
  }
  /// Standard deviation of this posterior, Beta(n+ + 1, n- + 1).
  [[nodiscard]] double sigma() const;
};

class SensorReliability {
 public:
  explicit SensorReliability(std::size_t sensors) : counts_(sensors) {}

  void count(std::size_t sensor, Agreement agreement);
  [[nodiscard]] const std::vector<ReliabilityCounts>& counts() const { return counts_; }
  /// The present weights times reliability, scaled so that the most reliable sensor keeps its weight.
  [[nodiscard]] std::vector<double> suggested_weights(std::span<const double> in_force) const;

 private:
  std::vector<ReliabilityCounts> counts_;
};

}  // namespace isobath
