// PageRequest: what a page may ask for (docs/live-page.md), read from its message.
//
// Input is untrusted: one JSON object with the keys of its request and no other, numbers finite and within their range.
#pragma once

#include <isobath/base/error.hpp>
#include <string>
#include <string_view>

namespace isobath {

struct PageRequest {
  enum class Ask { kPlay, kPause, kSpeed, kSeek, kStep, kLive, kControl, kCommand, kDetail };
  Ask ask = Ask::kPlay;
  double number = 0;  ///< times, s or steps
  std::string word;   ///< token, command or detail
};

struct BadRequest {
  std::string request;  ///< what it called itself, as far as that can be told; no more than 32 bytes
  std::string why;
};

Result<PageRequest, BadRequest> page_request_of(std::string_view text);
/// {"request": ..., "why": ...}
std::string refusal_text(const BadRequest& refusal);

}  // namespace isobath
