// decision_json: decisions as JSON. decisions.json, the live page and the channel /decisions of a recorded log hold the
// same objects, and all are written here. A replay with the same decisions thus gives the same bytes. `number` is that
// of the decision (Decision::number), from 1. Positions are estimated positions in W, m; margins in m.
#pragma once

#include <isobath/mission/messages/messages.hpp>
#include <string>
#include <vector>

namespace isobath {

/// One decision as one line of JSON.
std::string decision_json(const Decision& decision);
/// The text of decisions.json.
std::string decisions_text(const std::vector<Decision>& decisions);
}  // namespace isobath
