// Plans a path past outlines: of obstacles that were seen, of a charted pier, of a fence.
#include <cstdio>
#include <isobath/planning/route_planner.hpp>
#include <isobath/report/plot/picture.hpp>

using namespace isobath;

int main() {
  // Convex outlines in a level frame, here north and east in m; the margin is how far each may reach beyond.
  const std::vector<Hazard> hazards{
      {.outline = {{28, -4}, {32, -4}, {32, 6}, {28, 6}}, .margin_m = 1, .kind = HazardKind::kSeen},
      {.outline = {{50, 2}, {54, 4}, {52, 9}, {49, 6}}, .margin_m = 2, .kind = HazardKind::kRemembered},
      {.outline = {{20, 12}, {64, 18}, {63, 22}, {19, 16}}, .margin_m = 0, .kind = HazardKind::kCharted},
  };
  const HazardMap map(hazards);
  const RouteTask task{.start = {0, 0}, .goal = {80, 10}, .half_width_m = 0.4, .turning_radius_m = 8};
  const RouteConfig config{.clearance_m = 3, .wished_clearance_m = 6};

  const auto straight = map.conflict(std::vector{task.start, task.goal}, task.half_width_m + config.clearance_m);
  if (straight)
    std::printf("the straight line conflicts with hazard %zu after %.1f m\n", straight->hazard, straight->along_m);

  const auto route = plan_route(map, task, config);
  if (!route) return std::printf("no route: %s\n", to_text(route.error())), 1;
  for (const Eigen::Vector2d& p : route->points) std::printf("  north %5.1f, east %5.1f\n", p.x(), p.y());
  std::printf("%.1f m long, %.1f m from the nearest hazard, %d cells expanded\n", route->length_m, route->clearance_m,
              route->expanded);

  PlanPicture picture({-5, 85, -30, 30}, 700, {"Route", "north (m)", "east (m)"});
  for (const Hazard& hazard : hazards) picture.polygon(hazard.outline, {palette::kObstacle}, {0.84, 0.37, 0, 0.3});
  picture.polyline(route->points, {palette::kTrack, 2});
  picture.vehicle(task.start, 0);
  picture.finish({{palette::kTrack, "route"}, {palette::kObstacle, "hazards"}});
  picture.save("route.png");

  if (map.conflict(route->points, task.half_width_m + config.clearance_m))
    return std::printf("the route does not keep the clearance\n"), 1;
  return 0;
}
