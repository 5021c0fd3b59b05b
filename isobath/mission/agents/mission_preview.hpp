// Mission preview: the way on which the Navigator would lead the vehicle through a mission that it does not have yet.
//
// For each point a Navigator of its own is told what the vehicle's Navigator knows (obstacles of the last scan, charted
// and mapped hazards, voxels, other vehicles of the group), the mission with its fence, and that the vehicle is at the
// point before; it is then asked for the route. So the preview has the planner, the clearances and the limits of the
// vehicle. What differs under way: the maps go on growing, bodies move, and a route starts where the vehicle then is. A
// point with an obstacle nearer than `drop_distance_m` may be given up when the vehicle comes near it; the preview says
// so in advance. Where no route leads to a point, the next leg starts where the last one ended, as the vehicle drops
// the point.
//
// Unknown water counts as free, as for the Navigator; `unknown_m` says on how much of a leg the last scan saw no free
// water and the depth map has no depth.
#pragma once

#include <functional>
#include <isobath/mission/agents/standard_agents.hpp>
#include <isobath/mission/messages/messages.hpp>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace isobath {

/// What the agents have last been told. Copying it copies pointers, and the hazards of a group.
class MissionKnowledge {
 public:
  void on_message(const Message& message, Time now);
  /// Throws Error where the vehicle is outside the fence of the plan, which would end the mission at once.
  void check_place(const MissionPlan& plan) const;

 private:
  friend class MissionPreviewSearch;
  Time now_, scanned_;
  std::optional<Navigation> here_;
  std::shared_ptr<const ObstacleScan> scan_;
  std::shared_ptr<const Detection> seen_;  ///< the last sweep
  ChartedHazards chart_;
  GroupHazards group_;
  WorldSnapshot world_;
};

struct PreviewLeg {
  std::vector<Eigen::Vector2d> way = {};  ///< N, E, from where the leg starts to the point; empty: there is no route
  std::string why = {};                   ///< of the route, or why there is none
  double length_m = 0;
  /// From the hull to the nearest obstacle; infinite where none is known; below 0: the route leads over or under it.
  double clearance_m = std::numeric_limits<double>::infinity();
  std::string nearest = {};  ///< that obstacle, and where
  double unknown_m = 0;      ///< length in water that no map knows
  bool may_drop = false;     ///< an obstacle is so near to the point that the vehicle may give it up
};

/// One leg for each point of the plan. `give_up` is called before each leg: where it returns true, the rest has no
/// route. Throws Error where the vehicle's position is not known.
std::vector<PreviewLeg> preview_of(const MissionKnowledge& known, const std::shared_ptr<const MissionPlan>& plan,
                                   const MissionConfig& config, const VehicleParameters& vehicle,
                                   const std::function<bool()>& give_up);

}  // namespace isobath
