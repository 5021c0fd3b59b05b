// Three-dimensional routes of the Navigator: over, under or between hazards that close the plan view (ledger S5-35,
// S5-37).
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/agents/navigator.hpp>
#include <isobath/mission/messages/reason_text.hpp>

namespace isobath {

using Eigen::Vector3d;

namespace {

constexpr double kNoBetter = 0.25;  // m of clearance
constexpr double kLeastKept = 0.5;  // m that a route must be clear beside the hull to be kept

}  // namespace

/// Hazards in W, grown by half of the clearance that a path in the plane would keep in addition. A gap between two of
/// them is then open only through measured water, unless it is wide. What voxels hold closes those voxels alone.
std::vector<Hazard> Navigator::hazards_W(const View& view) const {
  std::vector<Hazard> hazards(view.map.hazards().begin(), view.map.hazards().end());
  std::erase_if(hazards, [](const Hazard& h) { return h.kind == HazardKind::kVoxels; });
  for (Hazard& hazard : hazards) {
    hazard.margin_m += 0.5 * std::max(0.0, route_.clearance_m - space_route_.clearance_m);
    for (Eigen::Vector2d& corner : hazard.outline) corner = view.frame.to_world(corner);
  }
  return hazards;
}

SpaceRouteTask Navigator::space_task(std::span<const Hazard> hazards) const {
  const VehicleLimits& limits = vehicle_.limits;
  SpaceRouteTask task;
  task.start = here_->X_WB.translation;
  task.goal << request_->target.north_east, request_->target.depth_m;
  task.half_width_m = vehicle_.half_width_m;
  task.turning_radius_m = turning_radius();
  if (task.turning_radius_m > 0) task.heading = here_->X_WB.rotation.heading();
  task.steepest = vehicle_.min_speed > 0 ? limits.max_climb_rate / std::max(wanted_speed(), vehicle_.min_speed)
                                         : std::numeric_limits<double>::infinity();
  task.max_depth_m = limits.max_depth;
  if (plan_) {
    task.min_depth_m = plan_->limits.min_depth_m;
    task.max_depth_m = std::min(task.max_depth_m, plan_->limits.max_depth_m);
  }
  task.hazards = hazards;
  return task;
}

/// One clearance field serves all queries of a cycle: those about the current route, and searches.
const Navigator::Space& Navigator::space_of(View& view) const {
  if (!view.space) {
    std::vector<Hazard> hazards = hazards_W(view);
    SpaceRouteTask task = space_task(hazards);
    ClearanceField room = room_for(*space_, task, space_route_, true);
    view.space = std::make_unique<Space>(Space{std::move(hazards), task, std::move(room)});
  }
  return *view.space;
}

/// The current route from the vehicle on.
std::vector<Vector3d> Navigator::current_way(const Space& space) const {
  std::vector<Vector3d> way = {space.task.start};
  for (const Waypoint& w : way_) way.emplace_back(w.north, w.east, w.depth);
  return way;
}

/// Whether the current route keeps clear, in three dimensions, of all that is not known to be water. On a route that
/// was chosen in three dimensions, water that lies `decide_m` or more ahead need not be known yet.
bool Navigator::leads_through(View& view, const Conflict& conflict, Outbox& out) {
  if (!space_) return false;
  const Space& space = space_of(view);
  const std::vector<Vector3d> way = current_way(space);
  if (!is_clear_through(view, way)) return false;
  if (!through_) {
    if (sure_length(space.room, way) < way_length(way)) return false;  // a route round it may cost little: search first
    through_ = true;
    Decision d = about(view, view.way, conflict);
    d.what = "keep";
    d.reason += "; the water there was measured, and is clear at the depth of the route";
    out.say(std::move(d));
  }
  return true;
}

/// Whether a way from the vehicle on keeps clear, in three dimensions, as far as the water must be known.
bool Navigator::is_clear_through(View& view, std::span<const Vector3d> way) const {
  const Space& space = space_of(view);
  const double wanted = vehicle_.half_width_m + std::max(0.0, space_route_.clearance_m - space_->voxel_m());
  const double here = space.room.distance(space.task.start);
  return here >= vehicle_.half_width_m && is_clear(space.room, way, std::min(wanted, here));
}

/// Whether the current route keeps clear, in three dimensions, nearly as well as one with this clearance would.
/// Outlines grow and shrink by more than that from scan to scan: a vehicle before a gap must not turn to another route
/// for it.
bool Navigator::is_as_clear(View& view, double clearance_m) const {
  const Space& space = space_of(view);
  const double wanted = std::min(clearance_m - kNoBetter, space.room.distance(space.task.start));
  return wanted > vehicle_.half_width_m + kLeastKept && is_clear(space.room, current_way(space), wanted);
}

/// Empty where the path in the plane, if there is one, is good enough.
std::optional<SpaceRoutePath> Navigator::search_space(View& view, std::optional<double> plane_m) const {
  if (!space_) return {};
  const double straight = (view.goal - view.way.front()).norm();
  if (plane_m && *plane_m <= straight + config_.switch_m) return {};
  if (!is_finite(space_task({}))) return {};
  SpaceRouteConfig config = space_route_;
  config.max_expanded = static_cast<int>(std::max(1.0, budget_share_ * space_route_.max_expanded));
  const Space& space = space_of(view);
  auto path = plan_space_route(space.room, space.task, config);
  if (!path || (plane_m && path->length_m + config_.switch_m > *plane_m)) return {};
  return *std::move(path);
}

void Navigator::take_space_way(const View& view, const SpaceRoutePath& path, Decision d, Outbox& out) {
  const double before = (view.goal - view.way.front()).norm();
  Way plan;
  for (const Vector3d& p : path.points) plan.push_back(view.frame.to_local(p.head<2>()));
  const double speed = speed_on(view, plan);
  std::vector<Waypoint> waypoints;
  double shallowest = path.points.front().z(), deepest = shallowest;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const Vector3d& p = path.points[i];
    waypoints.push_back({p.x(), p.y(), p.z(), speed, path.points[i - 1].z()});
    shallowest = std::min(shallowest, p.z());
    deepest = std::max(deepest, p.z());
  }
  d.reason += fmt::format("; between {:.1f} and {:.1f} m of depth the clearance is {:.1f} m", shallowest, deepest,
                          path.clearance_m - vehicle_.half_width_m);
  if (path.sure_m < path.length_m - 1) d.reason += fmt::format(", known for {:.0f} m so far", path.sure_m);
  through_ = true;
  opening_.leave();
  adopt(view, std::move(waypoints), path.length_m - before, std::move(d), out);
}

}  // namespace isobath
