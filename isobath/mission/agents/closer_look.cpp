#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/polygon_parts.hpp>
#include <isobath/mission/agents/closer_look.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kNear = 0.8;     // of the camera's range: what is left is for the errors of navigation and map
constexpr int kDirections = 48;   // round the obstacle
constexpr double kStep_m = 0.1;   // towards it
constexpr double kReached = 0.5;  // of the distance that the range leaves
constexpr double kMinRadius_m = 0.3;

bool of_one_obstacle(const RememberedObstacle& a, const RememberedObstacle& b) {
  return a.id == b.id || (a.number != 0 && a.number == b.number);
}

HazardMap remembered_hazards(std::span<const RememberedObstacle> obstacles) {
  std::vector<Hazard> hazards;
  for (const RememberedObstacle& o : obstacles) hazards.push_back({o.outline_W, o.margin_m, HazardKind::kRemembered});
  return HazardMap(std::move(hazards));
}

}  // namespace

std::optional<ViewingPose> viewing_pose(std::span<const RememberedObstacle> obstacles, std::size_t piece,
                                        double range_m, double keep_m, double lead_m, const Vector2d& vehicle) {
  const RememberedObstacle& looked_at = obstacles[piece];
  std::vector<Polygon> parts, others;
  for (const RememberedObstacle& o : obstacles) {
    (of_one_obstacle(o, looked_at) ? parts : others).push_back(o.outline_W);
  }
  const HazardMap hazards = remembered_hazards(obstacles);
  const auto in_sight = [&](const Vector2d& p, const Vector2d& q) {
    return std::ranges::none_of(others, [&](const Polygon& o) { return leg_distance(o, p, q).distance_m <= 0; });
  };
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& corner : looked_at.outline_W) middle += corner / static_cast<double>(looked_at.outline_W.size());
  double reach = range_m;
  for (const Vector2d& corner : looked_at.outline_W) reach = std::max(reach, range_m + (corner - middle).norm());
  const double view_m = std::max(kNear * range_m, keep_m + looked_at.margin_m);
  std::optional<ViewingPose> best;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kDirections;
    const Vector2d out(std::cos(angle), std::sin(angle));
    double far = reach;
    while (far > kStep_m && distance_from(parts, middle + far * out) > view_m) far -= kStep_m;
    ViewingPose pose{middle + (far + kStep_m) * out, {}};
    pose.seen = nearest_point(parts, pose.place);
    if (best && (pose.place - vehicle).norm() >= (best->place - vehicle).norm()) continue;
    if (pose.range_m() > range_m || hazards.distance(pose.place) < keep_m) continue;
    if (!in_sight(pose.place, pose.seen)) continue;
    const Vector2d from = pose.place + lead_m * (pose.place - pose.seen).normalized();
    if (hazards.leg_is_clear(from, pose.place, keep_m)) pose.from = from;
    best = pose;
  }
  return best;
}

std::vector<Field> fields(CloserLookConfig& c) {
  return {Field::real("range_m", &c.range_m, {0.5, 100}, "m", "Range of the camera, where the task gives none."),
          Field::real("within_m", &c.within_m, {1, 1e3}, "m",
                      "Distance from the point within which an obstacle is looked at, where the task gives none."),
          Field::real("speed", &c.speed, {0.01, 10}, "m/s", "Speed, where the mission point gives none.")};
}

void CloserLookDriver::hear(const Message& message) {
  const auto* scan = std::get_if<ObstacleScan>(&message);
  if (scan && scan->known) known_ = scan->known;
}

std::optional<BackSeatDriver::Offer> CloserLookDriver::offer(const Task& task, const MissionPoint& at,
                                                             const std::optional<Vector2d>& vehicle) const {
  if (task.name != "look") return std::nullopt;
  TaskNumbers numbers(task);
  const double range = numbers.take("range_m", config_.range_m, 0.5, 100);
  const double within = numbers.take("within_m", config_.within_m, 1, 1e3);
  numbers.refuse_others();
  if (range < keep_m_) {
    throw Error(fmt::format("a camera range of {} m is too short", range), {},
                fmt::format("{:.1f} m and more, which the route keeps from obstacles", keep_m_));
  }
  std::span<const RememberedObstacle> obstacles;
  if (known_) obstacles = known_->obstacles;
  const auto away = [&](const RememberedObstacle& o) { return distance_from(o.outline_W, at.north_east); };
  const auto nearest = std::ranges::min_element(obstacles, {}, away);
  if (nearest == obstacles.end() || away(*nearest) > within) {
    throw Error(fmt::format("no obstacle is known within {} m of the point", within));
  }
  const double lead = 2 * turning_radius_m_ + keep_m_;
  const auto pose = viewing_pose(obstacles, static_cast<std::size_t>(nearest - obstacles.begin()), range, keep_m_, lead,
                                 vehicle.value_or(at.north_east));
  if (!pose) throw Error(fmt::format("no place within {} m of the obstacle is free, with a line of sight", range));
  Offer offer{kOwnTask, {}};
  if (pose->from) offer.waypoints.push_back(waypoint(at, *pose->from, config_.speed));
  offer.waypoints.push_back(waypoint(at, pose->place, config_.speed));
  offer.waypoints.back().radius_m = std::max(kMinRadius_m, kReached * (range - pose->range_m()));
  offer.drop_distance_m = keep_m_;
  offer.what =
      fmt::format("obstacle {} is {:.1f} m from the point and is seen from {:.1f} m, in range of the camera ({} m)",
                  nearest->number, away(*nearest), pose->range_m(), range);
  return offer;
}

}  // namespace isobath
