#include <algorithm>
#include <cmath>
#include <isobath/vehicle/guidance.hpp>
#include <utility>

namespace isobath {

std::vector<Field> fields(GuidanceConfig& c) {
  return {
      Field::real("lookahead", &c.lookahead, {0.1, 1000}, "m", "How far ahead on the line it steers for."),
      Field::real("acceptance_radius", &c.acceptance_radius, {0.05, 1000}, "m", "A way-point this near is reached."),
      Field::real("integral_gain", &c.integral_gain, {0, 10}, "m/s", "Integral action against a current; 0: none."),
  };
}

LineOfSight::LineOfSight(const GuidanceConfig& config, std::vector<Waypoint> waypoints)
    : config_(config), waypoints_(std::move(waypoints)) {
  if (waypoints_.empty()) throw Error("no way-points", {}, "at least one");
}

Setpoint LineOfSight::step(const VehicleState& state, double dt) {
  const Eigen::Vector2d here = state.X_WB.translation.head<2>();
  if (!started_) {
    from_ = here;
    bearing_ = state.X_WB.rotation.heading();
    started_ = true;
  }
  double along = 0;
  while (!finished()) {
    const Waypoint& w = waypoints_[next_];
    const Eigen::Vector2d to(w.north, w.east);
    const Eigen::Vector2d leg = to - from_;
    const double length = leg.norm();
    const Eigen::Vector2d tangent = length > 1e-9 ? Eigen::Vector2d(leg / length) : Eigen::Vector2d::UnitX();
    along = tangent.dot(here - from_);
    cross_track_ = tangent.x() * (here - from_).y() - tangent.y() * (here - from_).x();
    if (length > 1e-9) bearing_ = Angle::radians(std::atan2(leg.y(), leg.x()));
    const bool near = (to - here).norm() <= config_.acceptance_radius;
    if (!near && along <= length) break;
    reached_ += near;
    from_ = to;
    ++next_;
    integral_ = 0;
  }
  const Waypoint& goal = waypoints_[std::min(next_, waypoints_.size() - 1)];
  if (finished()) return {bearing_, goal.depth, 0, 0};

  const double aim = cross_track_ + config_.integral_gain * integral_;
  const double ahead = config_.lookahead;
  integral_ += dt * ahead * cross_track_ / (aim * aim + ahead * ahead);
  const Angle heading = bearing_ - Angle::radians(std::atan2(aim, ahead));
  return {heading.wrapped(), goal.depth, goal.speed, 0};
}

Setpoint hold_station(const VehicleState& state, const Waypoint& place, Angle heading, double gain) {
  const Eigen::Vector2d gap = Eigen::Vector2d(place.north, place.east) - state.X_WB.translation.head<2>();
  Eigen::Vector2d v_W = gain * gap;
  if (v_W.norm() > place.speed) v_W *= place.speed / v_W.norm();
  const Angle psi = state.X_WB.rotation.heading();
  return {heading, place.depth, cos(psi) * v_W.x() + sin(psi) * v_W.y(), cos(psi) * v_W.y() - sin(psi) * v_W.x()};
}

}  // namespace isobath
