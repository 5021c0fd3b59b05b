// PlaneScan: the echoes of one level turn of a scanning sonar, and their runs of constant range (Auran, Silven 1995,
// 3.1, after Leonard, Durrant-Whyte and Cox 1992; ledger S4-43).
//
// The position of an echo has the standard deviation sigma_r along the beam and range x sigma across it. Besides, a
// beam is wide, and its echo is that of the nearest object in it. So the point that echoed lies off the beam's axis, by
// up to half its width, on the side where the surface is nearer (`point_towards`).
//
// A run is a maximal set of neighbouring directions in which the range changes by at most `step` from one to the next:
// a surface at normal incidence. A cylinder has a run about its bearing, a plane has one about its normal, and echoes
// by a second reflection have short runs or none.
//
// Plan coordinates are (north, east) of W, m; bearings are clockwise from north. Pure.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <vector>

namespace isobath {

inline Eigen::Vector2d plan_direction(Angle bearing) { return {cos(bearing), sin(bearing)}; }
inline Angle plan_bearing(const Eigen::Vector2d& v) { return Angle::radians(std::atan2(v.y(), v.x())); }

struct PlaneEcho {
  PlaneEcho(Angle of_axis, double range, const Eigen::Vector2d& off = Eigen::Vector2d::Zero())
      : bearing(of_axis), axis(plan_direction(of_axis)), range_m(range), offset(off) {}
  Angle bearing;  ///< bearing of the beam's axis
  Eigen::Vector2d axis;
  double range_m;
  Eigen::Vector2d offset;  ///< of the sonar from PlaneScan::from at this echo: a vehicle moves during a sweep
};

/// Full width of a beam, with the cosine and sine of its half, which each echo of each fit needs.
struct BeamWidth {
  explicit BeamWidth(Angle width) : full(width), cos_half(cos(width / 2)), sin_half(sin(width / 2)) {}
  Angle full;
  double cos_half, sin_half;
};

struct PlaneScan {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< the sonar, but for the offset of each echo
  std::vector<PlaneEcho> echoes;                   ///< in order of bearing, 0 .. 360 degrees; see sort()
  BeamWidth beam_width{Angle::degrees(2.5)};
  Angle sigma = Angle::degrees(2.5 / 2.355);   ///< standard deviation of a bearing
  double sigma_m = 0.15, sigma_share = 0.003;  ///< standard deviation of a range: the larger one

  /// Wraps all bearings and sorts the echoes by bearing.
  void sort();
  [[nodiscard]] double range_sigma(double range_m) const { return std::max(sigma_m, sigma_share * range_m); }
  [[nodiscard]] Eigen::Vector2d point(const PlaneEcho& echo) const {
    return from + echo.offset + echo.range_m * echo.axis;
  }
  /// The point that echoed, if its surface is nearest in the direction `nearest`, a unit vector.
  [[nodiscard]] Eigen::Vector2d point_towards(const PlaneEcho& echo, const Eigen::Vector2d& nearest) const;
  /// Variance of a point along the unit vector n.
  [[nodiscard]] double variance_along(const Eigen::Vector2d& n, const PlaneEcho& echo) const;
};

/// Echoes `first`, `first + 1`, ... `first + count - 1`; the indices wrap after the last echo.
struct RangeRun {
  std::size_t first = 0, count = 0;
  Angle begin, end;    ///< bearings of the first and the last echo; `end` may be beyond 360 degrees
  double range_m = 0;  ///< the mean

  [[nodiscard]] Angle middle() const { return (begin + (end - begin) / 2).wrapped_positive(); }
};

struct RangeRunConfig {
  double step = 2;  ///< maximum change of range to the next direction, standard deviations
  Angle least = Angle::degrees(2.5);
  Angle neighbours = Angle::degrees(5);  ///< maximum angle between neighbouring directions
};
/// The runs, in order of bearing.
std::vector<RangeRun> constant_range_runs(const PlaneScan& scan, const RangeRunConfig& config = {});

}  // namespace isobath
