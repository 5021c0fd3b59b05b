// The corner fixes of a run in words and as JSON (corner_navigation.hpp). Lengths in m, to a millimetre in JSON.
#pragma once

#include <isobath/onboard/corner_navigation.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace isobath {

nlohmann::ordered_json corner_fix_json(const CornerFixOutcome& fixes);
/// "corner fixes: 31 taken, 2 refused, in 40 sweeps with a corner; ...".
std::string corner_fix_text(const CornerFixOutcome& fixes);

}  // namespace isobath
