// DepthKeeper: the depth to ask for, from a wished depth or a wished altitude and the echoes of an altimeter.
//
// The bottom is a profile of the last echoes in W: each sample is the median of five readings, so that two wild ones in
// five change nothing; samples stand `spacing` apart along the way. Seen along the vehicle's heading of the moment,
// whichever way it came, the profile has a slope (Theil-Sen 1968; over its last few samples or all of them, whichever
// rises more), and so a bottom ahead. Echoes stand where the beam meets the bottom.
//
//   deepest(t) = bottom(speed t) - min_altitude + climb_rate max(0, t - lag),  t from 0 to lag + look_ahead
//
// is what leaves room to climb over the bottom that is reached after t; the least of them bounds the answer in both
// modes. `lag` is the time by which the vehicle comes after its set-point. In altitude mode the answer follows the
// shallower of the bottom below and the bottom a lag ahead. Where the bottom rises faster than the vehicle climbs, the
// answer says how fast it may go.
//
// A bottom that gives no echo any more is believed for `hold`. Then, by altitude, the vehicle goes up to `safe_depth`;
// by depth it goes no deeper than it was last allowed, or than the range that the altimeter saw empty since. Where no
// bottom was ever heard, a wished depth is given back as it is.
//
// Readings are of any rangefinder: those whose axis is within 45 degrees of straight down count. Units SI, W
// north-east-down. Nothing allocates. One thread at a time. What is not finite is refused and counted.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/vehicle/vehicle_sheet.hpp>
#include <limits>
#include <optional>

namespace isobath {

struct DepthKeeperConfig {
  double min_depth = 0;      ///< m
  double max_depth = 1000;   ///< m; the vehicle's own limit holds beside it
  double min_altitude = 1;   ///< m, always, in both modes
  double safe_depth = 2;     ///< m, where a lost bottom is waited for
  double hold = 10;          ///< s that a bottom without echo is believed
  double look_ahead = 8;     ///< s
  double spacing = 0.75;     ///< m between samples of the profile
  double climb_share = 0.7;  ///< of the greatest climb rate that may be counted on
};

std::vector<Field> fields(DepthKeeperConfig& config);

/// A single range of a beam that may look down.
struct AltimeterReading {
  Time time;
  std::optional<double> range_m;  ///< empty: no echo within max_range_m
  double max_range_m = 0;
  Angle width;  ///< full width of the cone
  Pose X_BS;    ///< x of S is the axis
};

struct DepthWish {
  double depth = 0;                  ///< m, where no altitude is wished
  std::optional<double> altitude_m;  ///< above the bottom
};

struct DepthOrder {
  double depth = 0;                                            ///< for Setpoint.depth
  double max_speed = std::numeric_limits<double>::infinity();  ///< that still climbs as fast as the bottom rises, m/s
  bool raised = false;                                         ///< the least altitude made it shallower than wished
  bool lost = false;                                           ///< by altitude, and no bottom is known
};

class DepthKeeper {
 public:
  DepthKeeper(const DepthKeeperConfig& config, const VehicleSheet& sheet);

  /// Whether the reading counts: finite, with a beam that looks down.
  bool hear(const AltimeterReading& reading, const Pose& X_WB);
  /// `v_W` over ground; the pose is finite. `now`: not before the times of the readings heard.
  DepthOrder step(const DepthWish& wish, const Pose& X_WB, const Eigen::Vector3d& v_W, Time now);

  /// Below the vehicle of the last step, m; empty where none is known.
  [[nodiscard]] std::optional<double> bottom_depth() const { return bottom_; }
  /// Metres deeper for each metre ahead, at the last step; below 0: it rises.
  [[nodiscard]] double slope() const { return slope_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  static constexpr int kRecent = 5, kProfile = 12, kNewest = 4;
  struct Sample {
    Eigen::Vector2d north_east = Eigen::Vector2d::Zero();
    double depth = 0;
  };
  void add(const Sample& sample);
  void look(const Eigen::Vector2d& here, const Eigen::Vector2d& ahead);
  [[nodiscard]] double deepest_allowed(double speed) const;

  DepthKeeperConfig config_;
  double climb_rate_;
  double lag_;
  double deepest_;
  std::array<Sample, kRecent> recent_;
  std::array<Sample, kProfile> profile_;
  int recent_count_ = 0, profile_count_ = 0;  ///< ever
  std::optional<Time> last_echo_;
  std::optional<double> seen_empty_;  ///< depth down to which there was no echo, by readings since the last one
  std::optional<double> last_allowed_;
  std::optional<double> bottom_;
  double slope_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace isobath
