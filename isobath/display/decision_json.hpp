// decision_json: decisions as JSON. decisions.json, the live page and the channel /decisions of a recorded log hold the
// same objects, and all are written here. A replay with the same decisions thus gives the same bytes. Only the live
// page is also told where the obstacle of a closest approach will be. `number` is that of the decision
// (Decision::number), from 1. Positions are estimated positions in W, m; margins in m.
#pragma once

#include <isobath/mission/messages/messages.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// One decision as one line of JSON. `obstacle_then_W`: the obstacle's place at the closest approach, if it is known.
std::string decision_json(const Decision& decision,
                          const std::optional<Eigen::Vector2d>& obstacle_then_W = std::nullopt);
/// The text of decisions.json.
std::string decisions_text(const std::vector<Decision>& decisions);
}  // namespace isobath
