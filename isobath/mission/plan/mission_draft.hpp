// MissionDraft: a mission as an operator has edited it on the page: its points, and its fence where that was edited,
// made from the mission that the vehicle has. Plain data, untrusted until plan_of has checked it.
#pragma once

#include <cstdint>
#include <isobath/mission/plan/mission_plan.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct DraftPoint {
  std::optional<std::size_t> from = {};  ///< index of the mission's point of which it keeps all that it does not state
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();
  double depth_m = 1;                     ///< where no altitude is given
  std::optional<double> altitude_m = {};  ///< above the bottom
  double speed = 0;                       ///< m/s; 0: that of the mission
};

struct MissionDraft {
  static constexpr std::size_t kMaxPoints = 100, kMaxCorners = 100;

  std::uint32_t mission = 0;  ///< number of the mission that it was made from (MissionInForce)
  std::vector<DraftPoint> points;
  std::optional<Polygon> fence = {};  ///< empty: that of the mission; without corners: none
};

/// The mission with the points and the fence of the draft, checked as check_mission does. Maps that the mission injects
/// are left out, because they have been injected. Throws Error, also where a group shares the mission.
MissionPlan plan_of(const MissionDraft& draft, const MissionPlan& mission);

}  // namespace isobath
