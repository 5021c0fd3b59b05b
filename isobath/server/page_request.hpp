// PageRequest: a request of a page (docs/live-page.md), parsed from its message.
//
// The input is untrusted. A message is one JSON object with exactly the keys of its request; numbers are finite and
// within their range.
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/mission/plan/mission_draft.hpp>
#include <string>
#include <string_view>

namespace isobath {

struct PageRequest {
  enum class Ask {
    kPlay,
    kPause,
    kSpeed,
    kSeek,
    kStep,
    kLive,
    kControl,
    kRelease,
    kCommand,
    kPreview,
    kMission,
    kDetail,
    kSeen
  };
  Ask ask = Ask::kPlay;
  double number = 0;        ///< times, s, steps or frame
  std::string word = {};    ///< token, command or detail
  MissionDraft draft = {};  ///< of a preview or a mission; in range, not checked as a mission
};

struct BadRequest {
  std::string request;  ///< its name, if the message has one; at most 32 bytes
  std::string why;
};

Result<PageRequest, BadRequest> page_request_of(std::string_view text);
/// {"request": ..., "why": ...}
std::string refusal_text(const BadRequest& refusal);

}  // namespace isobath
