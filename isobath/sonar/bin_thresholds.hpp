// BinThresholds: compares the samples of a ping with a threshold for each range bin. Samples of 8 bits are compared
// eight at a time with the smallest whole number at or above each threshold, which gives the same result as comparing
// in floating point.
#pragma once

#include <cstdint>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <vector>

namespace isobath {

class BinThresholds {
 public:
  /// Prepares for these thresholds; infinite: none.
  void set(const std::vector<float>& thresholds);
  /// Sets the hits of all usable bins. `thresholds`: as prepared.
  void decide(const Intensities& samples, const std::vector<float>& thresholds, EchoDecisions& out) const;

 private:
  std::vector<std::uint8_t> whole_;
  std::vector<std::uint64_t> reachable_;  ///< bins whose threshold an 8-bit sample can reach
};

}  // namespace isobath
