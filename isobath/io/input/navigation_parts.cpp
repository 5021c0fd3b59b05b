#include <cmath>
#include <isobath/io/input/navigation_parts.hpp>

namespace isobath {
namespace {

constexpr double kFarthestPosition = 1e6;  // m from the origin: limit of the local plane

bool held(const std::optional<Time>& at, Time now) {
  return at && now - *at <= NavigationParts::kHold && *at - now <= NavigationParts::kHold;
}

}  // namespace

std::optional<Navigation> NavigationParts::on_attitude(Time time, const Rotation& R_WB) {
  attitude_time_ = time;
  return fix_at(time, R_WB);
}

std::optional<Navigation> NavigationParts::on_position(Time time, const Eigen::Vector2d& north_east,
                                                       std::optional<Eigen::Vector3d> v_WB, double sigma_m) {
  if (!north_east.allFinite() || !(north_east.norm() < kFarthestPosition)) return {};
  if (v_WB && !v_WB->allFinite()) v_WB.reset();
  position_ = {time, north_east, v_WB, std::isfinite(sigma_m) ? sigma_m : 0};
  if (held(attitude_time_, time)) return {};
  if (v_WB && v_WB->head<2>().norm() > kMinSpeed) course_ = Angle::radians(std::atan2(v_WB->y(), v_WB->x()));
  return fix_at(time, Rotation::from_heading(course_));
}

std::optional<Navigation> NavigationParts::on_position(Time time, const GeoPoint& point,
                                                       const std::optional<Eigen::Vector3d>& v_WB, double sigma_m) {
  if (!valid(point) || point == GeoPoint{}) return {};
  const GeoOrigin origin = report_.origin.value_or(point);
  if (distance_m(origin, point) > kFarthestPosition) return {};
  report_.origin = origin;
  return on_position(time, LocalPlane(origin).to_plane(point), v_WB, sigma_m);
}

void NavigationParts::on_depth(Time time, double depth_m) {
  if (!std::isfinite(depth_m) || std::abs(depth_m) > kAnyDepth) return;
  depth_m_ = depth_m;
  depth_time_ = time;
}

std::optional<Navigation> NavigationParts::fix_at(Time time, const Rotation& R_WB) const {
  if (!position_ || !held(position_->time, time)) return {};
  Navigation fix;
  fix.time = time;
  Eigen::Vector2d p = position_->north_east;
  if (position_->v_WB) p += position_->v_WB->head<2>() * to_seconds(time - position_->time);
  fix.X_WB = {R_WB, {p.x(), p.y(), held(depth_time_, time) ? depth_m_ : 0}};
  if (!fix.X_WB.is_finite()) return {};
  fix.v_WB = position_->v_WB;
  if (position_->sigma_m > 0) {
    const double position = position_->sigma_m * position_->sigma_m;
    const double tilt = kTiltSigma.radians() * kTiltSigma.radians();
    const double heading = config_.heading_sigma.radians() * config_.heading_sigma.radians();
    Eigen::Matrix<double, 6, 1> variances;
    variances << position, position, 0, tilt, tilt, heading;
    fix.covariance = variances.asDiagonal().toDenseMatrix();
  }
  return fix;
}

}  // namespace isobath
