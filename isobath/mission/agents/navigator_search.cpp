// What the Navigator asks the route planner for: with which limits, wishes and speeds.
#include <algorithm>
#include <cmath>
#include <isobath/geometry/segment.hpp>
#include <isobath/mission/agents/navigator.hpp>
#include <isobath/mission/agents/way_keeping.hpp>
#include <limits>

namespace isobath {

using Eigen::Vector2d;

namespace {

/// From the vehicle along the way-points, in W.
std::vector<Vector2d> way_to_point(const Navigation& here, const std::vector<Waypoint>& way) {
  std::vector<Vector2d> ahead{here.X_WB.translation.head<2>()};
  for (const Waypoint& w : way) ahead.emplace_back(w.north, w.east);
  return ahead;
}

}  // namespace

Result<RoutePath, RouteRefusal> Navigator::search(const View& view) const {
  RouteConfig config = route_;
  config.max_expanded = max_expanded();
  const RouteTask task = task_of(view);
  auto found = plan_route(view.map, task, config);
  // Where hazards hem it in, a vehicle that needs room to turn is given a smaller clearance.
  for (const double share : {0.6, 0.3}) {
    const bool hemmed_in =
        !found && (found.error() == RouteRefusal::kCannotTurn || found.error() == RouteRefusal::kStartBlocked);
    if (!hemmed_in) break;
    config.clearance_m = share * route_.clearance_m;
    found = plan_route(view.map, task, config);
  }
  return found;
}

RouteTask Navigator::task_of(const View& view) const {
  RouteTask task;
  task.start = view.way.front();
  task.goal = view.goal;
  task.half_width_m = vehicle_.half_width_m;
  task.turning_radius_m = turning_radius();
  if (task.turning_radius_m > 0) task.heading = view.heading.radians();
  if (weighs_risks()) {
    for (const RiskArea& area : plan_->risks) {
      task.costly.push_back({view.frame.to_local(area.centre_W), area.radius_m, extra_cost(area, plan_->priorities)});
    }
  }
  if (request_->target.deviation_m > 0) {
    task.corridor = {view.frame.to_local(leg_from_), view.goal, request_->target.deviation_m};
  }
  return task;
}

/// Where the route to the point after will first lead, as far as is known now. A point that cannot be reached counts as
/// straight ahead.
std::optional<Vector2d> Navigator::corner_after(const View& view) const {
  if (!request_->then_W) return std::nullopt;
  const Vector2d then = view.frame.to_local(*request_->then_W);
  if (view.map.leg_is_clear(view.goal, then, least_clearance())) return request_->then_W;
  RouteTask task = task_of(view);
  task.start = view.goal;
  task.goal = then;
  task.corridor.reset();
  task.heading.reset();
  RouteConfig config = route_;
  config.max_expanded = max_expanded();
  const auto found = plan_route(view.map, task, config);
  return found && found->points.size() > 2 ? view.frame.to_world(found->points[1]) : *request_->then_W;
}

/// Whether it leads farther from the straight line than the point allows.
bool Navigator::deviates(const View& view, const Way& way) const {
  const double most_m = request_->target.deviation_m;
  if (most_m <= 0) return false;
  const Vector2d from = view.frame.to_local(leg_from_);
  return std::ranges::any_of(way, [&](const Vector2d& p) {
    return (nearest_on_segment(from, view.goal, p) - p).norm() > most_m + route_.cell_m;
  });
}

/// At the speed at which the vehicle goes to the point.
double Navigator::turning_radius() const {
  const double least = vehicle_.limits.turning_radius;
  const double rate = vehicle_.limits.max_yaw_rate.radians();
  return least > 0 && rate > 0 ? std::max(least, wanted_speed() / rate) : least;
}

double Navigator::wanted_speed() const {
  return request_->target.speed > 0 ? request_->target.speed : (plan_ ? plan_->speed : 1);
}

int Navigator::max_expanded() const {
  const int factor = mode_ == Mode::kEmergency ? config_.emergency_factor : 1;
  const double all = budget_share_ * route_.max_expanded * factor;
  return static_cast<int>(std::clamp<double>(all, 1, std::numeric_limits<int>::max()));
}

/// Slower where there is little room: more scans per metre before hidden obstacles come into sight.
double Navigator::speed_on(const View& view, const Way& way) const {
  const double speed = wanted_speed();
  double room = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < way.size(); ++i) room = std::min(room, view.map.leg_distance(way[i - 1], way[i]));
  const bool tight = room < clearance() + config_.tight_m;
  return tight ? std::min(speed, std::max(config_.tight_speed * speed, vehicle_.min_speed)) : speed;
}

/// The rest of the route: what it costs.
std::string Navigator::cost_text() const {
  return to_text(cost_of_way(way_to_point(*here_, way_), wanted_speed(), plan_->priorities, plan_->risks));
}

void Navigator::note_plan(Outbox& out) {
  double metres = 0;
  if (request_ && here_ && !way_.empty()) {
    std::vector<Vector2d> ahead = way_to_point(*here_, way_);
    if (request_->then_W) ahead.push_back(*request_->then_W);
    metres = length_of(ahead);
  }
  plans_.note(now_, metres > 0 ? metres / std::max(wanted_speed(), 0.01) : 0, version_ != noted_, out);
  noted_ = version_;
}

}  // namespace isobath
