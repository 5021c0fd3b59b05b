// sailing_time_s: how long the way through mission points takes, at the speeds of the points or of the mission.
#pragma once

#include <isobath/mission/plan/mission_plan.hpp>
#include <optional>
#include <span>

namespace isobath {

/// `order`: indices in `points`; those that are none are left out. `from`: where the way begins; empty: at the first
/// point. With the stays at the points, s.
double sailing_time_s(std::span<const MissionPoint> points, std::span<const std::size_t> order,
                      std::optional<Eigen::Vector2d> from, double speed);

}  // namespace isobath
