// Plane shapes: least-squares fits of lines, arcs and corners to the echoes of a level scan, with their uncertainty
// (Auran, Silven 1995, 3.1, after Mathisen 1993; ledger S4-45, S4-47).
//
//   line    total least squares: the minimum over n, c of sum w_i (n.(p_i - c))^2, 1 / w_i the variance of p_i along n.
//   arc     an algebraic circle (Kasa 1976), then Gauss-Newton on w_i (|p_i - c| - r)^2.
//   corner  the intersection of two lines. An echo within its own standard deviation of the corner may belong to either
//           face: its weight is reduced by its distance from the corner over the standard deviation along the line.
//
// Both fits use for each beam the point that is nearest on the current shape (PlaneScan::point_towards). Without it, a
// wall at oblique incidence appears turned by half a beam's width. Weights depend on the shape, so both fits iterate.
//
// A right angle observed by beams of 2.5 degrees at 9 m (18 m) has an error of at most 0.7 (0.85) of the distance of
// its nearest echo. Covariances are consistent, except for corners with a face at oblique incidence: errors there are
// 1.5 times as large as stated. Plan coordinates (north, east), m. Pure.
#pragma once

#include <array>
#include <isobath/perception/plane_scan.hpp>
#include <optional>
#include <span>

namespace isobath {

/// A straight edge. It keeps the moments of its echoes, so that the same edge of two scans can be merged.
struct PlaneLine {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();   ///< weighted centre of the echoes
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< unit vector, towards the sonar's side
  double weight = 0;                                  ///< sum of w, 1/m2
  double spread = 0;                                  ///< sum of w x (distance along the line)^2, 1
  double residual = 0;                                ///< sum of w x (distance from the line)^2: chi^2
  double begin_m = 0, end_m = 0;                      ///< extent of the echoes along the line, from the centre
  int support = 0;                                    ///< number of echoes

  [[nodiscard]] Eigen::Vector2d along() const { return {-normal.y(), normal.x()}; }
  [[nodiscard]] Eigen::Vector2d at(double along_m) const { return centre + along_m * along(); }
  [[nodiscard]] double length() const { return end_m - begin_m; }
  /// Distance from the line, above 0 on the sonar's side.
  [[nodiscard]] double height_of(const Eigen::Vector2d& p) const { return normal.dot(p - centre); }
  [[nodiscard]] double along_of(const Eigen::Vector2d& p) const { return along().dot(p - centre); }
  /// Variance of the normal's bearing, rad2; variance of the line's position along its normal, m2.
  [[nodiscard]] double bearing_variance() const { return 1 / spread; }
  [[nodiscard]] double variance_at(double along_m) const { return 1 / weight + along_m * along_m / spread; }
};

struct PlaneArc {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 1;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< covariance of (centre, radius)
  Angle first, sweep;                                    ///< bearings of its echoes from the centre
  bool hollow = false;                                   ///< observed from inside
  double residual = 0;                                   ///< chi^2
  int support = 0;
};

struct PlaneCorner {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  bool convex = true;  ///< corner of a body; false: concave, the corner of a room
  /// Unit vectors from the corner along its two faces.
  std::array<Eigen::Vector2d, 2> along{Eigen::Vector2d::UnitX(), Eigen::Vector2d::UnitY()};
};

/// Fits at least two of the scan's echoes. `factors` multiply their weights (empty: 1 each). `about`: a line fitted to
/// nearly the same echoes, as a start that saves iterations. Empty result if the echoes are one point.
std::optional<PlaneLine> fit_line(const PlaneScan& scan, std::span<const std::size_t> echoes,
                                  std::span<const double> factors = {}, const PlaneLine* about = nullptr);
/// Fits at least four echoes. Empty if they have no curvature.
std::optional<PlaneArc> fit_arc(const PlaneScan& scan, std::span<const std::size_t> echoes,
                                const PlaneArc* about = nullptr);

/// Distance of an echo from a shape, over its standard deviation in that direction.
double deviation(const PlaneScan& scan, const PlaneEcho& echo, const PlaneLine& line);
double deviation(const PlaneScan& scan, const PlaneEcho& echo, const PlaneArc& arc);

/// The line of the echoes of both.
PlaneLine merged(const PlaneLine& a, const PlaneLine& b);
/// Empty if the angle between the lines is below `least`.
std::optional<PlaneCorner> corner_of(const PlaneLine& a, const PlaneLine& b, Angle least = Angle::degrees(15));
/// Weight factors of a line's echoes for the fit of a corner: 0 at the corner, 1 from one standard deviation on.
std::vector<double> factors_near(const PlaneScan& scan, std::span<const std::size_t> echoes, const PlaneLine& line,
                                 const Eigen::Vector2d& corner);

}  // namespace isobath
