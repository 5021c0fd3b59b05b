#include <fmt/format.h>
#include <isobath/mission/plan/mission_draft.hpp>
#include <utility>

namespace isobath {

MissionPlan plan_of(const MissionDraft& draft, const MissionPlan& mission) {
  if (mission.search.on() || !mission.group.empty()) {
    throw Error("the vehicles of a group share this mission, and it cannot be edited on the page");
  }
  MissionPlan plan = mission;
  plan.points.clear();
  plan.injected.clear();
  for (const DraftPoint& p : draft.points) {
    MissionPoint point;
    if (p.from && *p.from < mission.points.size()) point = mission.points[*p.from];
    if (point.name.empty()) point.name = fmt::format("point {}", plan.points.size() + 1);
    point.place = {};
    point.north_east = p.north_east;
    point.depth_m = p.depth_m;
    point.altitude_m = p.altitude_m;
    point.speed = p.speed;
    plan.points.push_back(std::move(point));
  }
  if (draft.fence) plan.fence = *draft.fence;
  plan.fence_place = {};
  plan.fence_place.key = "fence";
  check_mission(plan);
  return plan;
}

}  // namespace isobath
