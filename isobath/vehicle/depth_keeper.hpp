// DepthKeeper: computes the depth set-point from a requested depth or altitude and the echoes of an altimeter.
//
// The bottom is a profile of the last echoes in W. Each sample is the median of five readings, so that two outliers in
// five change nothing; samples are `spacing` apart along the path. The samples are projected onto the vehicle's present
// course, whatever path it has followed. The slope of the profile (Theil-Sen 1968) is taken over all samples and over
// the last few; the one that rises more predicts the bottom ahead. Echoes are placed where the beam meets the bottom.
//
//   deepest(t) = bottom(speed t) - min_altitude + climb_rate max(0, t - lag),  t from 0 to lag + look_ahead
//
// is the depth that leaves room to climb over the bottom that the vehicle reaches after t; its minimum over t limits
// the result in both modes. `lag` is the time by which the vehicle lags its set-point. In altitude mode the result
// follows the shallower of the bottom below and the bottom a lag ahead. Where the bottom rises faster than the vehicle
// climbs, the result also limits the speed.
//
// When echoes stop, the last bottom remains valid for `hold`. Then, in altitude mode, the vehicle goes up to
// `safe_depth`. In depth mode it goes no deeper than the last limit or, if that is deeper, than the depth to which the
// altimeter has since measured no echo, less `min_altitude`. If there was never an echo of a bottom, a requested depth
// is limited only by `min_depth`, and by `max_depth` or the maximum depth of the vehicle.
//
// Readings may come from any rangefinder; those whose axis is within 45 degrees of straight down count. Units are SI; W
// is north-east-down. No function allocates. One thread at a time. Readings that are not finite are refused and
// counted.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <limits>
#include <optional>

namespace isobath {

struct DepthKeeperConfig {
  double min_depth = 0;      ///< m
  double max_depth = 1000;   ///< m; the vehicle's own limit applies as well
  double min_altitude = 1;   ///< m, always, in both modes
  double safe_depth = 2;     ///< m, where the vehicle goes when it has lost the bottom
  double hold = 10;          ///< s that the last bottom counts without echoes
  double look_ahead = 8;     ///< s
  double spacing = 0.75;     ///< m between samples of the profile
  double climb_share = 0.7;  ///< of the maximum climb rate that is relied on
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
  double depth = 0;                  ///< m, if there is no requested altitude
  std::optional<double> altitude_m;  ///< above the bottom
};

struct DepthOrder {
  double depth = 0;                                            ///< for Setpoint.depth
  double max_speed = std::numeric_limits<double>::infinity();  ///< at which it climbs as fast as the bottom rises, m/s
  bool raised = false;                                         ///< the minimum altitude made it shallower
  bool lost = false;                                           ///< altitude mode without a known bottom
};

class DepthKeeper {
 public:
  DepthKeeper(const DepthKeeperConfig& config, const VehicleParameters& parameters);

  /// Returns whether the reading counts: finite, and its beam points down.
  bool on_altimeter(const AltimeterReading& reading, const Pose& X_WB);
  /// `v_W` over ground; the pose must be finite. `now`: not before the times of the readings so far.
  DepthOrder step(const DepthWish& wish, const Pose& X_WB, const Eigen::Vector3d& v_W, Time now);

  /// Depth of the bottom below the vehicle at the last step, m; empty if unknown.
  [[nodiscard]] std::optional<double> bottom_depth() const { return bottom_; }
  /// Metres deeper per metre ahead at the last step; negative if the bottom rises.
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
  int recent_count_ = 0, profile_count_ = 0;  ///< totals since construction
  std::optional<Time> last_echo_;
  std::optional<double> seen_empty_;  ///< depth down to which readings since the last echo saw nothing
  std::optional<double> last_allowed_;
  std::optional<double> bottom_;
  double slope_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace isobath
