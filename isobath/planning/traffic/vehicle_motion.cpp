#include <algorithm>
#include <cmath>
#include <isobath/planning/traffic/vehicle_motion.hpp>
#include <numbers>

namespace isobath {
namespace {

using std::numbers::pi;

constexpr double kStraight = 1e-9;  ///< rad; a turn below it is none

}  // namespace

double TrafficVehicle::max_curvature() const { return std::min(1 / turning_radius_m, max_turn_rate / max_speed); }

std::vector<Field> fields(TrafficVehicle& v) {
  return {
      Field::real("radius", &v.radius_m, {0, 100}, "m", "Radius of the disc that holds the hull."),
      Field::real("turning_radius", &v.turning_radius_m, {0.1, 1e9}, "m", "Minimum turning radius."),
      Field::real("max_turn_rate", &v.max_turn_rate, {1e-6, 10}, "rad/s", "Maximum turn rate."),
      Field::real("min_speed", &v.min_speed, {0, 20}, "m/s", "Minimum speed; above 0 the vehicle cannot stop."),
      Field::real("max_speed", &v.max_speed, {0.05, 20}, "m/s", "Maximum speed, which is kept in open water."),
      Field::real("acceleration", &v.acceleration, {0.001, 10}, "m/s^2", "Maximum acceleration."),
      Field::real("braking", &v.braking, {0.001, 10}, "m/s^2", "Maximum deceleration."),
  };
}

MotionState along_arc(const MotionState& start, double curvature, double way_m) {
  MotionState end = start;
  const double turn = curvature * way_m;
  // The chord of an arc points half the turn aside of the heading and has the length way sin(turn / 2) / (turn / 2).
  const double half = 0.5 * turn;
  const double chord = std::abs(half) < 1e-6 ? way_m : way_m * std::sin(half) / half;
  end.p_W += chord * Eigen::Vector2d(std::cos(start.heading + half), std::sin(start.heading + half));
  end.heading += turn;
  return end;
}

MotionState MotionSegment::after(double elapsed_s) const {
  const double t = std::min(elapsed_s, duration_s);
  const double moving = acceleration < 0 ? std::min(t, start.speed / -acceleration) : t;
  MotionState end = along_arc(start, curvature, moving * (start.speed + 0.5 * acceleration * moving));
  end.speed = std::max(0.0, start.speed + acceleration * moving);
  return end;
}

double Trajectory::duration_s() const {
  return segments.empty() ? 0 : segments.back().start_s + segments.back().duration_s;
}

MotionState Trajectory::at(double time_s) const {
  if (segments.empty()) return {};
  const auto later = std::ranges::upper_bound(segments, time_s, {}, &MotionSegment::start_s);
  const MotionSegment& segment = later == segments.begin() ? segments.front() : *(later - 1);
  return segment.after(std::max(0.0, time_s - segment.start_s));
}

void Trajectory::append(const MotionState& start, double curvature, double acceleration, double duration_s) {
  if (segments.empty()) {
    segments.push_back({0, duration_s, start, curvature, acceleration});
  } else {
    const MotionSegment& last = segments.back();
    segments.push_back(
        {last.start_s + last.duration_s, duration_s, last.after(last.duration_s), curvature, acceleration});
  }
}

MotionState DirectMotion::at(double time_s) const {
  const double faster = std::min(time_s, accelerating_s);
  const double way = time_s * start.speed + faster * acceleration * (time_s - 0.5 * faster);
  MotionState end = along_arc(start, curvature, std::min(way, arc_m));
  if (way > arc_m) end = along_arc(end, 0, way - arc_m);
  end.speed = start.speed + acceleration * faster;
  return end;
}

void DirectMotion::append_to(Trajectory& trajectory, double duration_s) const {
  // Time at which the arc ends: while the speed rises, or after.
  const double risen_m = accelerating_s * (start.speed + 0.5 * acceleration * accelerating_s);
  const double arc_s =
      arc_m <= 0        ? 0
      : arc_m < risen_m ? (std::sqrt(start.speed * start.speed + 2 * acceleration * arc_m) - start.speed) / acceleration
                        : accelerating_s + (arc_m - risen_m) / max_speed;
  const double first = std::min(arc_s, accelerating_s), second = std::max(arc_s, accelerating_s);
  double from = 0;
  for (const double to : {first, second, duration_s}) {
    const double end = std::min(to, duration_s);
    if (end <= from) continue;
    const double middle = 0.5 * (from + end);
    trajectory.append(start, middle < arc_s ? curvature : 0, middle < accelerating_s ? acceleration : 0, end - from);
    from = end;
  }
}

std::optional<DirectMotion> direct_motion(const TrafficVehicle& vehicle, const MotionState& start,
                                          const Eigen::Vector2d& goal_W, double arrival_m) {
  DirectMotion motion;
  motion.start = start;
  const Eigen::Vector2d ahead(std::cos(start.heading), std::sin(start.heading)), to_goal = goal_W - start.p_W;
  const double along = ahead.dot(to_goal), aside = ahead.x() * to_goal.y() - ahead.y() * to_goal.x();
  const double side = aside < 0 ? -1 : 1, radius = 1 / vehicle.max_curvature();
  // Seen from the centre of the turning circle, mirrored so that the goal lies to starboard.
  const double across = side * aside - radius, far2 = along * along + across * across;
  if (far2 < radius * radius) return std::nullopt;
  const double straight = std::sqrt(far2 - radius * radius);
  // The sum of the angles of (along, across) and (straight, radius).
  double turn = std::atan2(across * straight + along * radius, along * straight - across * radius);
  if (turn < -kStraight) turn += 2 * pi;
  turn = std::max(turn, 0.0);
  motion.curvature = side / radius;
  motion.arc_m = turn * radius;
  motion.acceleration = vehicle.acceleration;
  motion.max_speed = vehicle.max_speed;
  const double gain = std::max(0.0, vehicle.max_speed - start.speed);
  motion.accelerating_s = gain / vehicle.acceleration;
  const double way = std::max(0.0, motion.arc_m + straight - arrival_m);
  const double risen_m = motion.accelerating_s * (start.speed + 0.5 * gain);
  motion.arrival_s =
      way < risen_m
          ? (std::sqrt(start.speed * start.speed + 2 * vehicle.acceleration * way) - start.speed) / vehicle.acceleration
          : motion.accelerating_s + (way - risen_m) / vehicle.max_speed;
  return motion;
}

}  // namespace isobath
