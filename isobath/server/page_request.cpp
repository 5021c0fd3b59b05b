#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <isobath/server/page_draft.hpp>
#include <isobath/server/page_request.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using nlohmann::json;
using Ask = PageRequest::Ask;

struct AskRule {
  const char* name;
  Ask ask;
  const char* number = nullptr;  ///< key of a number
  double least = 0, most = 0;
  bool whole = false;
  const char* word = nullptr;  ///< key of a text
  bool draft = false;          ///< whether it has a draft of a mission
};
constexpr double kMaxSeconds = 1e9;
constexpr double kMaxFrame = 9e15;  // a double holds it
constexpr std::array<AskRule, 13> kRules{{
    {"play", Ask::kPlay},
    {"pause", Ask::kPause},
    {"speed", Ask::kSpeed, "times", 0.1, 100},
    {"seek", Ask::kSeek, "to_s", -kMaxSeconds, kMaxSeconds},
    {"step", Ask::kStep, "steps", -1000, 1000, true},
    {"live", Ask::kLive},
    {"control", Ask::kControl, nullptr, 0, 0, false, "token"},
    {"release", Ask::kRelease},
    {"command", Ask::kCommand, nullptr, 0, 0, false, "command"},
    {"preview", Ask::kPreview, nullptr, 0, 0, false, nullptr, true},
    {"mission", Ask::kMission, nullptr, 0, 0, false, nullptr, true},
    {"detail", Ask::kDetail, nullptr, 0, 0, false, "voxels"},
    {"seen", Ask::kSeen, "frame", 0, kMaxFrame, true},
}};

/// Truncates to 32 bytes at a character boundary.
std::string name_of_request(const std::string& asked) {
  std::size_t end = std::min<std::size_t>(asked.size(), 32);
  while (end > 0 && end < asked.size() && (static_cast<unsigned char>(asked[end]) & 0xc0) == 0x80) --end;
  return asked.substr(0, end);
}

}  // namespace

Result<PageRequest, BadRequest> page_request_of(std::string_view text) {
  const json message = json::parse(text, nullptr, false);
  if (!message.is_object()) return tl::unexpected(BadRequest{"", "not a JSON object"});
  const auto ask = message.find("ask");
  if (ask == message.end() || !ask->is_string()) return tl::unexpected(BadRequest{"", "no \"ask\""});
  const std::string& asked = ask->get_ref<const std::string&>();
  const auto refused = [&](std::string why) {
    return tl::unexpected(BadRequest{name_of_request(asked), std::move(why)});
  };

  const auto rule = std::find_if(kRules.begin(), kRules.end(), [&](const AskRule& r) { return asked == r.name; });
  if (rule == kRules.end()) return refused("unknown");
  if (message.size() != (rule->number || rule->word || rule->draft ? 2u : 1u)) return refused("wrong keys");
  PageRequest request{rule->ask};
  if (rule->number) {
    const auto number = message.find(rule->number);
    if (number == message.end() || !number->is_number()) return refused(fmt::format("no number {}", rule->number));
    request.number = number->get<double>();
    const bool fits = request.number >= rule->least && request.number <= rule->most &&
                      (!rule->whole || request.number == std::trunc(request.number));
    if (!fits) {
      return refused(fmt::format("{} must be {}from {} to {}", rule->number, rule->whole ? "whole, " : "", rule->least,
                                 rule->most));
    }
  }
  if (rule->word) {
    const auto word = message.find(rule->word);
    if (word == message.end() || !word->is_string()) return refused(fmt::format("no text {}", rule->word));
    request.word = word->get<std::string>();
  }
  if (rule->draft) {
    const auto draft = message.find("draft");
    if (draft == message.end()) return refused("no draft");
    auto read = draft_of(*draft);
    if (!read) return refused(std::move(read.error()));
    request.draft = *std::move(read);
  }
  return request;
}

std::string refusal_text(const BadRequest& refusal) {
  return json{{"request", refusal.request}, {"why", refusal.why}}.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace isobath
