// MovingBody: a body of the traffic with its velocity, and where it is predicted to be (ledger S3-11, S3-12, S3-30).
//
// A body keeps its velocity and its turn rate. Its shape is a disc, or a simple outline grown by the radius; a still
// structure (a wall, a quay) is a body that does not move. Frame: the horizontal plane of W, x north, y east, m; turn
// rates are positive from north to east. What is not promised: that the body keeps its velocity. A planner must be told
// of each change, and plan again.
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/geometry/polygon.hpp>
#include <span>

namespace isobath {

struct MovingBody {
  int number = 0;
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();         ///< m
  Eigen::Vector2d velocity_W = Eigen::Vector2d::Zero();  ///< m/s
  double radius_m = 0;                                   ///< of the disc; with an outline: what the outline grows by
  Polygon outline = {};                                  ///< simple; corners from p_W along the axes of W, at `time`
  double turn_rate = 0;                                  ///< of the outline about p_W, rad/s
  Eigen::Matrix2d position_covariance = Eigen::Matrix2d::Zero();  ///< m^2
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Zero();  ///< (m/s)^2
  Time time{};                                                    ///< of this state
};

/// Whether all numbers are finite, the radius is not negative, and no variance is below zero.
bool is_valid(const MovingBody& body);

/// Whether it moves at most at `speed`, in m/s, does not turn, and its velocity is certain to within that.
bool is_still(const MovingBody& body, double speed);

/// Radius of the smallest disc about the body's position that holds its shape, whatever its heading.
double circumscribed_radius(const MovingBody& body);

/// k sqrt(lambda_max(P_pos + t^2 P_vel)), m: what the shape grows by, `ahead_s` after the body's time (S3-30).
double predicted_growth(const MovingBody& body, double ahead_s, double sigmas);

/// Distance from p_W to the body's shape `ahead_s` after its time, m: below 0 inside. In an outline it is minus the
/// distance to the nearest side.
double distance_to(const MovingBody& body, const Eigen::Vector2d& p_W, double ahead_s);

}  // namespace isobath
