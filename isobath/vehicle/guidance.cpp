#include <algorithm>
#include <cmath>
#include <isobath/geometry/polygon.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kCrawl = 0.1;                // m/s: minimum speed of a hovering vehicle on its way
const Angle kTurning = Angle::degrees(20);    // larger heading error: still in the turn
const Angle kOnTheLine = Angle::degrees(30);  // smaller heading error: the integral may learn
const Angle kSteepestCrab = Angle::degrees(60);

Vector2d ahead_of(Angle heading) { return {cos(heading), sin(heading)}; }
Vector2d starboard_of(Angle heading) { return {-sin(heading), cos(heading)}; }
Angle bearing_of(const Vector2d& v) { return Angle::radians(std::atan2(v.y(), v.x())); }
Vector2d position_of(const Waypoint& w) { return {w.north, w.east}; }

Setpoint moving(const Vector2d& v_W, Angle now, Angle heading, double depth) {
  return {heading, depth, ahead_of(now).dot(v_W), starboard_of(now).dot(v_W)};
}

Vector2d limited(const Vector2d& v, double most) {
  const double size = v.norm();
  return size > most ? Vector2d(v * (most / size)) : v;
}

}  // namespace

std::vector<Field> fields(GuidanceConfig& c) {
  return {
      Field::real("lookahead", &c.lookahead, {0.1, 1000}, "m", "Distance ahead on the line that is steered for."),
      Field::real("acceptance_radius", &c.acceptance_radius, {0.05, 1000}, "m", "A way-point this near is reached."),
      Field::real("integral_gain", &c.integral_gain, {0, 0.9}, "1",
                  "Integral action against a current, as a share of the speed; 0: none."),
      Field::real("drift_time", &c.drift_time, {0, 100}, "s",
                  "Time constant of the drift filter; 0: the velocity over ground is not used."),
      Field::real("corner_tolerance", &c.corner_tolerance, {0.05, 1000}, "m",
                  "The vehicle slows down for a corner that it would overrun by more than this."),
      Field::flag("slow_at_corners", &c.slow_at_corners,
                  "Whether it slows down for corners, and brakes for the last way-point, at all."),
  };
}

std::vector<Field> fields(StationConfig& c) {
  return {
      Field::real("gain", &c.gain, {0.01, 5}, "1/s", "Speed towards the position per metre of distance."),
      Field::real("integral_gain", &c.integral_gain, {0, 1}, "1/s2", "Integral action; 0: none."),
      Field::real("turn_from", &c.turn_from, {0.1, 100}, "m",
                  "A hovering vehicle without sway turns to its position from this distance on."),
      Field::real("circle_radius", &c.circle_radius, {1, 1000}, "m", "Radius of a vehicle that cannot hover."),
      Field::real("drift_time", &c.drift_time, {0, 100}, "s",
                  "Time constant of the drift filter; 0: the velocity over ground is not used."),
  };
}

void Drift::update(Angle heading, const Eigen::Vector3d& v_W, double time_constant, double dt) {
  const Vector2d across = starboard_of(heading);
  const double lack = across.dot(v_W.head<2>() - velocity_W_);
  if (!(time_constant > 0) || !std::isfinite(lack)) return;
  velocity_W_ += (1 - std::exp(-dt / time_constant)) * lack * across;
}

Angle Drift::crab(Angle heading, double speed) const {
  const double side = starboard_of(heading).dot(velocity_W_);
  const Angle crab = Angle::radians(std::atan2(side, std::max(speed, kCrawl)));
  return std::clamp(crab, -kSteepestCrab, kSteepestCrab);
}

// Along way-points ---------------------------------------------------------------------------------------------------

LineOfSight::LineOfSight(const GuidanceConfig& config, std::vector<Waypoint> waypoints,
                         const std::optional<VehicleParameters>& parameters)
    : config_(config), parameters_(parameters) {
  follow(std::move(waypoints));
}

void LineOfSight::follow(std::vector<Waypoint> waypoints, const std::optional<Vector2d>& from) {
  if (waypoints.empty()) throw Error("no way-points", {}, "at least one");
  waypoints_ = std::move(waypoints);
  then_.reset();
  next_ = reached_ = 0;
  started_ = from.has_value();
  if (from) from_ = *from;
  cross_before_.reset();
  turn_limit_ = 0;
}

// Passes way-points that are reached or abeam; then `bearing_`, `to_go_` and `cross_track_` are of the present leg.
double LineOfSight::acceptance_radius(const Waypoint& place) const {
  return place.radius_m > 0 ? std::min(place.radius_m, config_.acceptance_radius) : config_.acceptance_radius;
}

void LineOfSight::advance(const Vector2d& here) {
  while (!finished()) {
    const Vector2d to = position_of(waypoints_[next_]);
    const bool near = (to - here).norm() <= acceptance_radius(waypoints_[next_]);
    if (!near && (to - from_).norm() < 1e-9) from_ = here;  // a leg without length has no bearing
    const Vector2d leg = to - from_;
    const double length = leg.norm();
    const Vector2d tangent = length > 1e-9 ? Vector2d(leg / length) : Vector2d::UnitX();
    cross_track_ = cross(tangent, here - from_);
    to_go_ = length - tangent.dot(here - from_);
    if (length > 1e-9) bearing_ = bearing_of(leg);
    if (!near && to_go_ >= 0) return;
    reached_ += near;
    from_ = to;
    ++next_;
    cross_before_.reset();
    turn_limit_ = 0;
  }
}

void LineOfSight::learn(double aim, double dt) {
  const double ahead = config_.lookahead, speed = waypoints_[next_].speed, sigma = config_.integral_gain * speed;
  const double change = (cross_track_ - cross_before_.value_or(cross_track_)) / dt;
  const double left = cross_track_ + ahead / speed * std::clamp(change, -2 * speed, 2 * speed);
  const double rate = ahead * left / (aim * aim + ahead * ahead);
  integral_W_ = limited(integral_W_ + dt * rate * starboard_of(bearing_), ahead / sigma);
}

Setpoint LineOfSight::step(const Pose& X_WB, const std::optional<Eigen::Vector3d>& v_W, double dt) {
  if (!X_WB.is_finite() || !(dt > 0)) return last_;
  const Vector2d here = X_WB.translation.head<2>();
  const Angle heading = X_WB.rotation.heading();
  if (!started_) {
    from_ = here;
    bearing_ = heading;
    started_ = true;
  }
  advance(here);
  if (v_W) drift_.update(heading, *v_W, config_.drift_time, dt);
  if (finished()) return last_ = {bearing_, waypoints_.back().depth, parameters_ ? parameters_->min_speed : 0, 0};

  const Waypoint& goal = waypoints_[next_];
  const Vector2d across = starboard_of(bearing_);
  const double sigma = config_.integral_gain * goal.speed, distance = config_.lookahead;
  const double aim = cross_track_ + sigma * across.dot(integral_W_);
  const Angle course = bearing_ - Angle::radians(std::atan2(aim, distance));
  const Angle wanted = (course - drift_.crab(heading, goal.speed)).wrapped();
  const Angle off = abs((wanted - heading).wrapped());
  if (sigma > 0 && off < kOnTheLine && std::abs(cross_track_) < distance) learn(aim, dt);
  cross_before_ = cross_track_;

  double speed = goal.speed;
  if (parameters_) {
    if (config_.slow_at_corners) speed = speed_ahead();
    if (off > kTurning && config_.slow_at_corners) {  // a vehicle inside of the turn may use up that distance
      const double inside = (wanted - heading).wrapped().radians() > 0 ? cross_track_ : -cross_track_;
      const double limit = corner_speed(off, std::max(inside, 0.0));
      turn_limit_ = turn_limit_ > 0 ? std::min(turn_limit_, limit) : limit;
      speed = std::min(speed, turn_limit_);
    } else {
      turn_limit_ = 0;
    }
    const double least = std::max(parameters_->min_speed, std::min(kCrawl, goal.speed));
    speed = std::min(std::max(speed, least), parameters_->limits.max_speed);
  }
  return last_ = {wanted, depth_on(goal, speed), speed, 0};
}

// On a leg that rises or sinks: the depth of the leg where the vehicle will be when it has reached its set-point.
double LineOfSight::depth_on(const Waypoint& goal, double speed) const {
  if (!goal.from_depth) return goal.depth;
  const double length = (position_of(goal) - from_).norm();
  const double lead = parameters_ ? parameters_->depth_lag_s * speed : 0;
  const double share = length > 1e-9 ? std::clamp((length - to_go_ + lead) / length, 0.0, 1.0) : 1;
  return *goal.from_depth + share * (goal.depth - *goal.from_depth);
}

// The maximum speed from which every corner ahead can still be taken.
double LineOfSight::speed_ahead() const {
  const double braking = 0.5 * parameters_->braking;
  double speed = waypoints_[next_].speed;
  double distance = std::max(0.0, to_go_);
  Angle before = bearing_;
  for (std::size_t i = next_; i < waypoints_.size(); ++i) {
    if (2 * braking * (distance - acceptance_radius(waypoints_[i])) > speed * speed) break;
    const bool is_last = i + 1 == waypoints_.size();
    if (is_last && !then_) {
      if (parameters_->min_speed <= 0) speed = std::min(speed, std::sqrt(2 * braking * distance));
      break;
    }
    const Vector2d leg = (is_last ? *then_ : position_of(waypoints_[i + 1])) - position_of(waypoints_[i]);
    const Angle after = leg.norm() > 1e-9 ? bearing_of(leg) : before;
    const double early = config_.acceptance_radius;
    const Angle turn = abs((after - before).wrapped());
    const double through = corner_speed(turn, early * sin(turn));
    speed = std::min(speed, std::sqrt(through * through + 2 * braking * std::max(0.0, distance - early)));
    distance += leg.norm();
    before = after;
  }
  return speed;
}

// The speed at which a turn that begins `inside` metres beside the next leg ends within the tolerance on its other
// side.
double LineOfSight::corner_speed(Angle turn, double inside) const {
  const double radius = (config_.corner_tolerance + inside) / std::max(1 - cos(turn), 1e-6);
  return parameters_->limits.max_yaw_rate.radians() * std::max(radius, parameters_->limits.turning_radius);
}

// At a place ---------------------------------------------------------------------------------------------------------

void StationKeeper::hold(const Waypoint& place, const std::optional<Angle>& heading) {
  place_ = place;
  heading_ = heading;
  turning_ = false;
}

double StationKeeper::radius(double speed) const {
  if (parameters_.min_speed <= 0) return 0;
  const double widest = speed / std::max(parameters_.limits.max_yaw_rate.radians(), 1e-3);
  return std::max({config_.circle_radius, 1.3 * parameters_.limits.turning_radius, 1.3 * widest});
}

Setpoint StationKeeper::step(const Pose& X_WB, const std::optional<Eigen::Vector3d>& v_W, double dt) {
  if (!X_WB.is_finite() || !(dt > 0)) return last_;
  const Vector2d gap = position_of(place_) - X_WB.translation.head<2>();
  const Angle heading = X_WB.rotation.heading();
  if (v_W) drift_.update(heading, *v_W, config_.drift_time, dt);
  if (!heading_) heading_ = heading;
  return last_ = parameters_.min_speed > 0 ? circle(gap, heading) : hover(gap, heading, dt);
}

Setpoint StationKeeper::hover(const Vector2d& gap, Angle heading, double dt) {
  const Vector2d asked = config_.gain * gap + integral_W_;
  const Vector2d v_W = limited(asked, place_.speed);
  if (v_W == asked) integral_W_ = limited(integral_W_ + config_.integral_gain * dt * gap, 0.5 * place_.speed);
  if (parameters_.can_sway) return moving(v_W, heading, *heading_, place_.depth);

  // Without sway it turns to its position when it has drifted too far, and keeps that heading: into the current.
  if (gap.norm() > config_.turn_from) turning_ = true;
  if (gap.norm() < 0.5 * config_.turn_from) turning_ = false;
  if (turning_) heading_ = bearing_of(gap);
  return {*heading_, place_.depth, ahead_of(heading).dot(v_W), 0};
}

// Course along the tangent, turned inwards by atan((distance - radius) / (radius / 2)).
Setpoint StationKeeper::circle(const Vector2d& gap, Angle heading) const {
  const double circle = radius(place_.speed),
               speed = std::min(std::max(place_.speed, parameters_.min_speed), parameters_.limits.max_speed);
  const Angle inwards = Angle::radians(std::atan2(gap.norm() - circle, 0.5 * circle));
  const Angle course = bearing_of(gap) - Angle::degrees(90) + inwards;
  return {(course - drift_.crab(heading, speed)).wrapped(), place_.depth, speed, 0};
}

}  // namespace isobath
