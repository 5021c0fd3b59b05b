// SoundingGate: quarantine for depths without support around them (ledger S1-72: the bottom is usually smooth).
//
// A depth sonar's reading is compared with the last accepted reading of its sensor. It is plausible if the depths
// differ by at most the larger of `slack_m` and `slack_share` of the depth, plus `max_slope` times the horizontal
// distance. Implausible readings are held. When `accept_after` consecutive held readings agree among themselves (a
// quay, a wreck, another place) they are all confirmed. A depth outside [min_depth_m, max_depth_m] is impossible and
// never used. Soundings of a swath are compared with the median of the neighbouring beams instead.
//
// Points p_W are those of the bottom, north-east-down, m. One gate per vehicle, one thread. Nothing allocates after
// construction.
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <span>
#include <vector>

namespace isobath {

struct SoundingGateConfig {
  double slack_m = 1.5;
  double slack_share = 0.15;
  double max_slope = 2;
  int accept_after = 3;
  double min_depth_m = -10;
  double max_depth_m = 12000;
  int neighbours = 5;  ///< beams on either side
};
std::vector<Field> fields(SoundingGateConfig& config);

class SoundingGate {
 public:
  static constexpr int kSensors = 64;

  explicit SoundingGate(const SoundingGateConfig& config);

  enum class Verdict : std::uint8_t {
    kBelieved,   ///< use it, and discard the held readings of this sensor
    kHeld,       ///< hold it
    kConfirmed,  ///< use it, and the last `accept_after` - 1 held readings of this sensor
    kImpossible,
  };
  /// 0 <= sensor < kSensors.
  Verdict judge(int sensor, const Eigen::Vector3d& p_W);
  /// Writes for each sounding whether the beams around it support it. `believed` has as many elements as `points`.
  void judge_swath(std::span<const Eigen::Vector3d> points, std::span<std::uint8_t> believed);

 private:
  struct Sensor {
    bool known = false;
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    Eigen::Vector3d held = Eigen::Vector3d::Zero();
    int in_row = 0;
  };
  [[nodiscard]] bool plausible(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;
  [[nodiscard]] bool possible(double depth_m) const {
    return depth_m >= config_.min_depth_m && depth_m <= config_.max_depth_m;
  }

  SoundingGateConfig config_;
  std::array<Sensor, kSensors> sensors_;
  std::vector<double> depths_;
};

}  // namespace isobath
