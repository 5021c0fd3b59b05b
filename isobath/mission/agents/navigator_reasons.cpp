// The reasons of the Navigator's decisions: which obstacle, which leg, how near.
#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/agents/navigator.hpp>
#include <isobath/mission/agents/way_keeping.hpp>
#include <isobath/mission/messages/reason_text.hpp>

namespace isobath {

using Eigen::Vector2d;

Navigator::Refusal Navigator::refusal_of(RouteRefusal refusal, const View& view) const {
  const Vector2d& vehicle = view.way.front();
  const auto nearest = view.map.nearest(vehicle);
  const std::string obstacle =
      nearest ? fmt::format("{} at {}", text_of(view.map.hazards()[*nearest]),
                            text_of(view.frame.to_world(nearest_point(view.map.hazards()[*nearest].outline, vehicle))))
              : "nothing known";
  switch (refusal) {
    case RouteRefusal::kStartBlocked: return {RouteRefused::Reason::kStartBlocked, "the vehicle is inside " + obstacle};
    case RouteRefusal::kGoalBlocked:
      return {RouteRefused::Reason::kGoalBlocked,
              fmt::format("the point is within {:.1f} m of a hazard", std::max(0.0, view.map.distance(view.goal)))};
    case RouteRefusal::kOutOfBudget:
      return {
          RouteRefused::Reason::kOutOfBudget,
          fmt::format(
              "no path within {} expansions{}{}", route_.max_expanded,
              mode_ == Mode::kEmergency ? fmt::format(" times {}", config_.emergency_factor) : "",
              budget_share_ < 1 ? fmt::format(", of which the computer leaves a share of {:g}", budget_share_) : "")};
    case RouteRefusal::kCannotTurn:
      return {RouteRefused::Reason::kNoPath, "no path fits the turning radius; nearest to the vehicle: " + obstacle};
    case RouteRefusal::kNotFinite:
    case RouteRefusal::kNoPath: break;
  }
  const double deviation_m = request_->target.deviation_m;
  const std::string within =
      deviation_m > 0 ? fmt::format(" within {:g} m of the straight line", deviation_m) : std::string();
  return {RouteRefused::Reason::kNoPath,
          fmt::format("there is no path{}; nearest to the vehicle: {}", within, obstacle)};
}

Decision Navigator::decision(std::string what, std::string reason) const {
  return {now_, "navigator", std::move(what), std::move(reason)};
}

Decision Navigator::about(const View& view, const Way& way, const Conflict& conflict) const {
  const Hazard& hazard = view.map.hazards()[conflict.hazard];
  const bool through = conflict.distance_m + hazard.margin_m <= 0;  // then the place where the route first meets it
  Decision d = decision("", "");
  d.obstacle =
      view.frame.to_world(through ? nearest_point(hazard.outline, point_at(way, conflict.along_m)) : conflict.place);
  d.leg = conflict.leg + 1;
  d.margin_m = conflict.distance_m - vehicle_.half_width_m;
  double wanted = route_.clearance_m;
  if (hazard.kind == HazardKind::kFence) {
    *d.margin_m += hazard.margin_m;
    wanted = config_.fence_clearance_m;
  }
  const std::string how = *d.margin_m > 0 ? fmt::format("pass {:.1f} m from {}", *d.margin_m, text_of(hazard))
                                          : fmt::format("run into {}", text_of(hazard));
  d.obstacle_number = hazard.obstacle;
  const std::string where = direction_of(view.frame.to_local(*d.obstacle), way.front(), view.heading);
  d.reason =
      fmt::format("leg {} would {} at {}, {} ({:.1f} m wanted)", *d.leg, how, text_of(*d.obstacle), where, wanted);
  return d;
}

}  // namespace isobath
