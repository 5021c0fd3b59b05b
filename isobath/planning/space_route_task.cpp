#include <isobath/planning/space_route_task.hpp>

namespace isobath {

std::vector<Field> fields(SpaceRouteConfig& c) {
  return {
      Field::real("clearance_m", &c.clearance_m, {0, 100}, "m",
                  "Clearance from the hull to water that is not known to be clear, all round."),
      Field::real("wished_clearance_m", &c.wished_clearance_m, {0, 100}, "m",
                  "Clearance that is kept where there is room."),
      Field::real("room_weight", &c.room_weight, {0, 100}, "1", "Detour per metre that the wished clearance is worth."),
      Field::real("depth_weight", &c.depth_weight, {0, 10}, "1/m",
                  "Detour per metre that a metre off the goal's depth is worth."),
      Field::real("decide_m", &c.decide_m, {0, 1000}, "m",
                  "Distance before unmeasured water at which the vehicle must have another path."),
      Field::real("reach_m", &c.reach_m, {10, 1000}, "m",
                  "To a goal farther than this only a partial path is planned."),
      Field::real("margin_m", &c.margin_m, {0, 1000}, "m", "Margin of the box around start and goal."),
      Field::integer("max_expanded", &c.max_expanded, {1, 100'000'000}, "1",
                     "Maximum number of cells that a search expands.")
          .was("most_expanded"),
  };
}

bool is_finite(const SpaceRouteTask& task) {
  constexpr double kFarthest = 1e7;  // m
  const auto far = [](const Eigen::Vector3d& p) { return !p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthest; };
  return !far(task.start) && !far(task.goal);
}

}  // namespace isobath
