// Corner fix: corrects the vehicle's position by corners of charted objects (Auran, Silven 1995, 3.2; ledger S4-49).
// Observed corners bound the drift of an inertial unit, which grows with the way.
//
// Observed corners are placed in W by the estimated position. Their offsets from the charted corners give the position
// error: the mean of chart - observed, weighted by the covariance of each corner, including the heading error, which
// moves a corner across the line of sight. An observed corner is matched to the charted corner within the gate whose
// faces have the same directions to 20 degrees. It is ignored if it matches none or more than one.
//
// `isobath sphere --drift` runs it on simulated level scans, [corner_fix] in a mission (onboard/corner_navigation.hpp).
// docs/spherical-grid.md states the accuracy of both.
//
// Plan coordinates (north, east) of W, m. Pure.
#pragma once

#include <array>
#include <isobath/perception/plane_shapes.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// A straight wall of the chart.
struct ChartedWall {
  Eigen::Vector2d a = Eigen::Vector2d::Zero(), b = Eigen::Vector2d::Zero();
};
struct ChartedCorner {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::array<Eigen::Vector2d, 2> along;  ///< unit vectors from the corner along its walls
};
/// Where two walls of at least 2 m meet, end to end, at an angle between 20 and 160 degrees; each corner once.
std::vector<ChartedCorner> corners_of(std::span<const ChartedWall> walls);

struct PlanePosition {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};
struct CornerFix : PlanePosition {
  int corners = 0;  ///< number of matched corners
};

/// `gate`: in standard deviations of observed corner and estimated position combined.
std::optional<CornerFix> corner_fix(const PlanePosition& believed, std::span<const PlaneCorner> seen,
                                    std::span<const ChartedCorner> charted, Angle heading_sigma = {}, double gate = 3);

/// Fuses two independent positions (Kalman update).
PlanePosition fused(const PlanePosition& a, const PlanePosition& b);

}  // namespace isobath
