// PlaneScan: the echoes of one level turn of a scanning sonar, and the runs of constant range in it (Auran, Silven
// 1995, 3.1, after Leonard, Durrant-Whyte and Cox 1992; ledger S4-43).
//
// A reading says where its echo is to sigma_r along the beam and range x sigma across it, and more: a beam is wide, and
// its echo that of the nearest thing in it. So the point that echoed lies off the axis of the beam, by up to half its
// width, on the side where the surface comes nearer (`point_towards`).
//
// A run is a set of neighbouring directions, as many as possible, in which the range changes by no more than `step`
// from each to the next: a surface that is met squarely. A cylinder has one about its bearing, a plane has one about
// its normal, and echoes that came by way of a second surface have short ones or none.
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
  PlaneEcho(Angle of_axis, double range) : bearing(of_axis), axis(plan_direction(of_axis)), range_m(range) {}
  Angle bearing;  ///< of the beam's axis
  Eigen::Vector2d axis;
  double range_m;
};

/// Of a beam, full; with the cosine and the sine of its half, which are asked for at every echo of every fit.
struct BeamWidth {
  explicit BeamWidth(Angle width) : full(width), cos_half(cos(width / 2)), sin_half(sin(width / 2)) {}
  Angle full;
  double cos_half, sin_half;
};

struct PlaneScan {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< the sonar
  std::vector<PlaneEcho> echoes;                   ///< by bearing, of [0, 360) degrees: sort()
  BeamWidth beam_width{Angle::degrees(2.5)};
  Angle sigma = Angle::degrees(2.5 / 2.355);   ///< of a bearing
  double sigma_m = 0.15, sigma_share = 0.003;  ///< of a range: the larger one

  /// Wraps all bearings and puts the echoes in their order.
  void sort();
  [[nodiscard]] double range_sigma(double range_m) const { return std::max(sigma_m, sigma_share * range_m); }
  [[nodiscard]] Eigen::Vector2d point(const PlaneEcho& echo) const { return from + echo.range_m * echo.axis; }
  /// Where the echo came from, if what it is of is nearest in the direction `nearest`, a unit vector.
  [[nodiscard]] Eigen::Vector2d point_towards(const PlaneEcho& echo, const Eigen::Vector2d& nearest) const;
  /// Variance of a point along the unit vector n.
  [[nodiscard]] double variance_along(const Eigen::Vector2d& n, const PlaneEcho& echo) const;
};

/// Echoes `first`, `first + 1`, ... `first + count - 1`, counted on from the last to the first.
struct RangeRun {
  std::size_t first = 0, count = 0;
  Angle begin, end;    ///< bearings of the first and the last; `end` may be beyond 360 degrees
  double range_m = 0;  ///< the mean

  [[nodiscard]] Angle middle() const { return (begin + (end - begin) / 2).wrapped_positive(); }
};

struct RangeRunConfig {
  double step = 2;  ///< standard deviations of a range, from a direction to the next
  Angle least = Angle::degrees(2.5);
  Angle neighbours = Angle::degrees(5);  ///< directions farther apart are none
};
/// In order of bearing.
std::vector<RangeRun> constant_range_runs(const PlaneScan& scan, const RangeRunConfig& config = {});

}  // namespace isobath
