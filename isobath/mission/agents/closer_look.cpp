#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/agents/closer_look.hpp>
#include <limits>
#include <numbers>
#include <span>

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

/// Whether a place keeps clear of all obstacles.
bool is_free(std::span<const RememberedObstacle> obstacles, const Vector2d& p, double keep_m) {
  return std::ranges::all_of(
      obstacles, [&](const RememberedObstacle& o) { return distance_from(o.outline_W, p) >= keep_m + o.margin_m; });
}

bool is_free(std::span<const RememberedObstacle> obstacles, const Vector2d& a, const Vector2d& b, double keep_m) {
  const auto steps = static_cast<int>(std::ceil((b - a).norm()));
  for (int i = 0; i <= steps; ++i) {
    if (!is_free(obstacles, a + (b - a) * i / std::max(steps, 1), keep_m)) return false;
  }
  return true;
}

Vector2d nearest_of(std::span<const RememberedObstacle> obstacles, const RememberedObstacle& looked_at,
                    const Vector2d& p) {
  Vector2d nearest = Vector2d::Zero();
  double distance = std::numeric_limits<double>::infinity();
  for (const RememberedObstacle& o : obstacles) {
    if (!of_one_obstacle(o, looked_at)) continue;
    const Vector2d q = nearest_point(o.outline_W, p);
    if ((q - p).norm() >= distance) continue;
    distance = (q - p).norm();
    nearest = q;
  }
  return nearest;
}

/// Whether nothing else stands between p and the point q of the obstacle.
bool in_sight(std::span<const RememberedObstacle> obstacles, const RememberedObstacle& looked_at, const Vector2d& p,
              const Vector2d& q) {
  const double range = (q - p).norm();
  if (range <= 0) return false;
  return std::ranges::none_of(obstacles, [&](const RememberedObstacle& o) {
    if (of_one_obstacle(o, looked_at)) return false;
    const auto hit = ray_hit(o.outline_W, p, (q - p) / range);
    return hit && *hit < range;
  });
}

}  // namespace

std::optional<ViewingPose> viewing_pose(std::span<const RememberedObstacle> obstacles, std::size_t piece,
                                        double range_m, double keep_m, double lead_m, const Vector2d& vehicle) {
  const RememberedObstacle& looked_at = obstacles[piece];
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
    while (far > kStep_m &&
           (nearest_of(obstacles, looked_at, middle + far * out) - middle - far * out).norm() > view_m) {
      far -= kStep_m;
    }
    ViewingPose pose{middle + (far + kStep_m) * out, {}};
    pose.seen = nearest_of(obstacles, looked_at, pose.place);
    if (best && (pose.place - vehicle).norm() >= (best->place - vehicle).norm()) continue;
    if (pose.range_m() > range_m || !is_free(obstacles, pose.place, keep_m)) continue;
    if (!in_sight(obstacles, looked_at, pose.place, pose.seen)) continue;
    const Vector2d from = pose.place + lead_m * (pose.place - pose.seen).normalized();
    if (is_free(obstacles, from, pose.place, keep_m)) pose.from = from;
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
  std::size_t nearest = obstacles.size();
  double distance = within;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const double away = distance_from(obstacles[i].outline_W, at.north_east);
    if (away > distance) continue;
    distance = away;
    nearest = i;
  }
  if (nearest == obstacles.size()) throw Error(fmt::format("no obstacle is known within {} m of the point", within));
  const double lead = 2 * turning_radius_m_ + keep_m_;
  const auto pose = viewing_pose(obstacles, nearest, range, keep_m_, lead, vehicle.value_or(at.north_east));
  if (!pose) throw Error(fmt::format("no place within {} m of the obstacle is free, with a line of sight", range));
  const double speed = at.speed > 0 ? at.speed : config_.speed;
  Offer offer{0.9, {}};
  if (pose->from) offer.waypoints.push_back({pose->from->x(), pose->from->y(), at.depth_m, speed});
  offer.waypoints.push_back({pose->place.x(), pose->place.y(), at.depth_m, speed});
  offer.waypoints.back().radius_m = std::max(kMinRadius_m, kReached * (range - pose->range_m()));
  offer.drop_distance_m = keep_m_;
  offer.what =
      fmt::format("obstacle {} is {:.1f} m from the point and is seen from {:.1f} m, in range of the camera ({} m)",
                  obstacles[nearest].number, distance, pose->range_m(), range);
  return offer;
}

}  // namespace isobath
