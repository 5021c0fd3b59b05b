// Lines, arcs and corners that echoes of a level scan are of: least squares, each with its uncertainty (Auran, Silven
// 1995, 3.1, after Mathisen 1993; ledger S4-45, S4-47).
//
//   line    total least squares: of all n, c the least sum of w_i (n.(p_i - c))^2, 1 / w_i the variance of p_i along n.
//   arc     an algebraic circle (Kasa 1976), then Gauss-Newton on w_i (|p_i - c| - r)^2.
//   corner  where two lines meet. An echo that lies nearer to the corner than its own error reaches may be of either
//           face: it counts the less the nearer it is, by its distance over the standard deviation along the line.
//
// Both fits take the point of each beam that is nearest on the shape that they have so far (PlaneScan::point_towards):
// without that a wall that is seen aslant stands turned by half a beam's width. Weights follow from the shape, so both
// are iterated.
//
// A right angle that is told by beams of 2.5 degrees at 9 m (18 m) is 0.7 (0.85) as far off as its nearest echo, or
// less. Covariances are honest, but for corners of which one face is seen aslant: deviations are 1.5 times as large
// there. Plan coordinates (north, east), m. Pure.
#pragma once

#include <isobath/perception/plane_scan.hpp>
#include <optional>
#include <span>

namespace isobath {

/// A straight edge. The moments of its echoes are kept, so that the same edge of two scans can be merged.
struct PlaneLine {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();   ///< of the echoes, as they weigh
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< unit, to the side that it was heard from
  double weight = 0;                                  ///< sum of w, 1/m2
  double spread = 0;                                  ///< sum of w x (distance along the line)^2, 1
  double residual = 0;                                ///< sum of w x (distance from the line)^2: chi^2
  double begin_m = 0, end_m = 0;                      ///< of the echoes, along the line, from the centre
  int support = 0;                                    ///< echoes

  [[nodiscard]] Eigen::Vector2d along() const { return {-normal.y(), normal.x()}; }
  [[nodiscard]] Eigen::Vector2d at(double along_m) const { return centre + along_m * along(); }
  [[nodiscard]] double length() const { return end_m - begin_m; }
  /// Above 0 on the side that it was heard from.
  [[nodiscard]] double height_of(const Eigen::Vector2d& p) const { return normal.dot(p - centre); }
  [[nodiscard]] double along_of(const Eigen::Vector2d& p) const { return along().dot(p - centre); }
  /// Variance of the normal's bearing, rad2; of the line's place along its normal, m2.
  [[nodiscard]] double bearing_variance() const { return 1 / spread; }
  [[nodiscard]] double variance_at(double along_m) const { return 1 / weight + along_m * along_m / spread; }
};

struct PlaneArc {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 1;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (centre, radius)
  Angle first, sweep;                                    ///< bearings of its echoes from the centre
  bool hollow = false;                                   ///< heard from inside
  double residual = 0;                                   ///< chi^2
  int support = 0;
};

struct PlaneCorner {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  bool convex = true;  ///< of a body; a hollow one is the corner of a room
};

/// Of at least two of the scan's echoes, `factors` (1 each where empty) on their weights. `about`: a line near by, that
/// of nearly the same echoes; few rounds are enough then. Empty where they are one point.
std::optional<PlaneLine> fit_line(const PlaneScan& scan, std::span<const std::size_t> echoes,
                                  std::span<const double> factors = {}, const PlaneLine* about = nullptr);
/// Of at least four. Empty where they have no curvature.
std::optional<PlaneArc> fit_arc(const PlaneScan& scan, std::span<const std::size_t> echoes,
                                const PlaneArc* about = nullptr);

/// Distance of an echo from a shape over the standard deviation that it has along this distance.
double deviation(const PlaneScan& scan, const PlaneEcho& echo, const PlaneLine& line);
double deviation(const PlaneScan& scan, const PlaneEcho& echo, const PlaneArc& arc);

/// The line of all echoes of both.
PlaneLine merged(const PlaneLine& a, const PlaneLine& b);
/// Empty where the lines are closer to parallel than `least`.
std::optional<PlaneCorner> corner_of(const PlaneLine& a, const PlaneLine& b, Angle least = Angle::degrees(15));
/// Factors of a line's echoes in a fit that shall tell of a corner: 0 at it, 1 from a standard deviation on.
std::vector<double> factors_near(const PlaneScan& scan, std::span<const std::size_t> echoes, const PlaneLine& line,
                                 const Eigen::Vector2d& corner);

}  // namespace isobath
