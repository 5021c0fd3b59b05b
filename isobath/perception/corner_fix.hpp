// Fixes of the vehicle's position by corners of known objects (Auran, Silven 1995, 3.2; ledger S4-49): what is seen of
// a charted body bounds the drift of an inertial unit, which grows with time.
//
// Corners that were told in W as if the vehicle stood where it believes, and stand elsewhere on the chart, say how far
// it is off: the mean of chart - seen, each weighing by its covariance and by the error of the heading, which swings a
// corner across the line of sight. A corner is taken for the charted one that it fits; where it fits two, or none
// within the gate, it says nothing.
//
// Plan coordinates (north, east) of W, m. Pure.
#pragma once

#include <isobath/perception/plane_shapes.hpp>
#include <optional>
#include <span>

namespace isobath {

struct PlanePosition {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};
struct CornerFix : PlanePosition {
  int corners = 0;  ///< that it is of
};

/// `gate` in standard deviations of seen and believed places together.
std::optional<CornerFix> corner_fix(const PlanePosition& believed, std::span<const PlaneCorner> seen,
                                    std::span<const Eigen::Vector2d> charted, Angle heading_sigma = {},
                                    double gate = 3);

/// Of two independent ones (the update of a Kalman filter).
PlanePosition fused(const PlanePosition& a, const PlanePosition& b);

}  // namespace isobath
