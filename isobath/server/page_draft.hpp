// The draft of a mission in a request of a page (docs/live-page.md). The input is untrusted: known keys only, numbers
// within their range, no more points and corners than MissionDraft allows.
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/mission/plan/mission_draft.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace isobath {

/// Or what is wrong with it, as a sentence.
Result<MissionDraft, std::string> draft_of(const nlohmann::json& draft);

}  // namespace isobath
