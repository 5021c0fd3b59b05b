// SensorReliability: how often the readings of each sensor agree with their predictions (ledger S1-06; the paper,
// Oskard 1990, I, names a learning module and gives no method).
//
//   reliability = (n+ + 1) / (n+ + n- + 2)     mean of the posterior of a share under a uniform prior (Laplace)
//
// with n+ confirming and n- conflicting readings. Irrelevant readings are counted but have no effect. One thread at a
// time; counting allocates nothing.
#pragma once

#include <cstdint>
#include <vector>

namespace isobath {

enum class Agreement : std::uint8_t { kConfirming, kConflicting, kIrrelevant };

struct ReliabilityCounts {
  std::uint64_t confirming = 0;
  std::uint64_t conflicting = 0;
  std::uint64_t irrelevant = 0;

  [[nodiscard]] double reliability() const {
    return (static_cast<double>(confirming) + 1) / (static_cast<double>(confirming + conflicting) + 2);
  }
};

class SensorReliability {
 public:
  explicit SensorReliability(std::size_t sensors) : counts_(sensors) {}

  void count(std::size_t sensor, Agreement agreement);
  [[nodiscard]] const std::vector<ReliabilityCounts>& counts() const { return counts_; }

 private:
  std::vector<ReliabilityCounts> counts_;
};

}  // namespace isobath
