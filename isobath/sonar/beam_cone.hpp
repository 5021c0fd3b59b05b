// BeamCone: the circular cone of water that a range reading covers, and its depth interval in each vertical column
// (Oskard 1990, IV-B; ledger S1-52, S1-57, S1-60, S1-61, S1-65, S1-E08).
//
// Frames: world W, north-east-down; columns are (north, east) in W, m. Apex p_WS, unit axis u_W, half-angle a in
// [0, 90) degrees; depression delta is positive down, azimuth clockwise from north.
//
// In a column at horizontal distance h and azimuth offset eta the cone lies between the roots of a quadratic,
//   A = cos^2 a - sin^2 delta,  D = cos^2 eta cos^2 delta - A,
//   z = s_z + h (cos eta cos delta sin delta -+ cos a sqrt(D)) / A,
// and only the nappe ahead of the apex counts. A > 0: an interval, empty beyond sin eta_max = sin a / cos delta.
// A <= 0: the cone contains the vertical, all azimuths are inside, and one end of the interval is infinite. The roots
// are computed in the form without cancellation, so that A near 0 loses no digits. The cone is unbounded; callers with
// a range cut it there.
//
// Immutable after construction: safe for any number of threads.
#pragma once

#include <array>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <optional>
#include <span>

namespace isobath {

/// Depths below the datum, positive down, m; infinite where the cone contains the vertical.
struct DepthInterval {
  double top_m = 0;
  double bottom_m = 0;
};

class BeamCone {
 public:
  /// u_W is a unit vector.
  BeamCone(const Eigen::Vector3d& p_WS, const Eigen::Vector3d& u_W, Angle half_angle);
  /// s = p_WB + R_WB p_BS, u = R_WB R_BS e_x (S1-52).
  BeamCone(const RangeReading& reading, const Pose& X_WB);

  [[nodiscard]] const Eigen::Vector3d& apex() const { return p_WS_; }
  [[nodiscard]] const Eigen::Vector3d& axis() const { return u_W_; }
  [[nodiscard]] Angle half_angle() const { return half_angle_; }
  [[nodiscard]] double sin_half_angle() const { return sin_a_; }
  [[nodiscard]] double cos_half_angle() const { return cos_a_; }
  [[nodiscard]] Angle depression() const;
  [[nodiscard]] double cos_depression() const { return cos_delta_; }
  /// Unit vector (north, east) of the azimuth; north for a vertical axis.
  [[nodiscard]] const Eigen::Vector2d& heading() const { return e_; }

  /// A of S1-65; positive if the cone does not contain the vertical.
  [[nodiscard]] double vertical_term() const { return vertical_term_; }
  [[nodiscard]] bool contains_vertical() const { return vertical_term_ <= 0; }
  /// tan of the half-angle of the cone's plan, asin(sin a / cos delta); infinite if the cone contains the vertical.
  [[nodiscard]] double plan_tangent() const;

  /// The part of the column inside the cone (S1-65); empty: none.
  [[nodiscard]] std::optional<DepthInterval> depth_interval(const Eigen::Vector2d& north_east) const;
  /// Distance from the apex to the point of the column at the smallest angle to the axis: h sqrt(1 + (tan delta /
  /// cos eta)^2), on the axis h / cos delta (S1-60). Infinite abeam of the axis and behind it.
  [[nodiscard]] double slant_range(const Eigen::Vector2d& north_east) const;
  /// The two planes of S1-61 at horizontal distance h: s_z + h tan(delta -+ a). Only if |delta| + a < 90 degrees.
  [[nodiscard]] DepthInterval planes(double h) const;
  /// Smallest distance from the apex to a point of the level plane at this depth inside the cone: for a flat bottom at
  /// altitude A, A / sin(delta + a), or A if the cone contains the vertical; the same upwards for the surface.
  [[nodiscard]] std::optional<double> range_to_level(double depth_m) const;

 private:
  Eigen::Vector3d p_WS_;
  Eigen::Vector3d u_W_;
  Angle half_angle_;
  Eigen::Vector2d e_;
  double sin_a_;
  double cos_a_;
  double cos_delta_;
  double vertical_term_;
};

/// A convex polygon (north, east) in W that contains the plan of the cone up to a range.
struct PlanFootprint {
  std::array<Eigen::Vector2d, 4> corners;
  int count = 0;

  [[nodiscard]] bool is_triangle() const { return count == 3; }
  [[nodiscard]] std::span<const Eigen::Vector2d> polygon() const {
    return {corners.data(), static_cast<std::size_t>(count)};
  }
};

/// The triangle of S1-57, extended by `extension_m` (S1-58): apex, and base at L = R cos(max(0, |delta| - a)) +
/// extension, with `plan_tangent` for its sides. If the cone contains the vertical, or is so nearly vertical that the
/// triangle would be much wider than the beam, a rectangle along the azimuth.
PlanFootprint plan_footprint(const BeamCone& cone, double range_m, double extension_m, double plan_tangent);

}  // namespace isobath
