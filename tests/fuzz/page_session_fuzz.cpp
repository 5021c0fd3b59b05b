// A page of a run and its recording: any bytes as its messages, a line each; after each some time passes and a frame is
// made. The frames must be whole records, and nobody commands without the token.
#include <isobath/base/error.hpp>
#include <isobath/server/page_session.hpp>
#include <string_view>
#include <tests/server/records.hpp>
#include <utility>

namespace {

using namespace isobath;

const Time kStart{Duration(1'600'000'000'000'000'000)};

class HundredSeconds final : public Playback {
 public:
  TimeSpan span() override { return {kStart, kStart + seconds(100)}; }
  void show(Time moment, DisplayState& items) override {
    ISOBATH_ASSERT(moment >= span().start && moment <= span().end);
    items.set(DisplayKind::kVehicle, 0, moment, to_text(moment));
  }
  Time step(Time from, int steps) override { return from + seconds(steps); }  // the page keeps within the span
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size);
  DisplayState items;
  items.set(DisplayKind::kVehicle, 0, kStart, "now");
  std::chrono::steady_clock::time_point now{std::chrono::hours(1)};
  bool knows = false;
  PageSources sources;
  sources.clock = [&] { return now; };
  sources.open_playback = [] { return std::make_unique<HundredSeconds>(); };
  sources.token = "correct horse battery";
  sources.command = [&](PageCommand, const std::string&) {
    ISOBATH_ASSERT(knows);
    return std::string();
  };
  // The mission of the run has one point and no fence; a draft that is taken is a sound mission.
  MissionPlan mission;
  mission.points.resize(1);
  std::optional<std::string> answer;
  const auto planned = [&](const MissionDraft& draft) {
    ISOBATH_ASSERT(knows && draft.points.size() <= MissionDraft::kMaxPoints);
    try {
      check_mission(plan_of(draft, mission));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    answer = "{}";
    return std::string();
  };
  sources.planning = {[&](const MissionDraft& draft, const std::string&) { return planned(draft); },
                      [&](const MissionDraft& draft, std::uint64_t) { return planned(draft); },
                      [&](std::uint64_t) { return std::exchange(answer, std::nullopt); }};
  if (size % 2 == 0) {
    sources.live = std::make_shared<SharedChanges>(items);
    sources.live_span = [] { return TimeSpan{kStart, kStart + seconds(110)}; };
  }
  check_page_sources(sources);
  PageSession page(sources);
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (const auto request = page_request_of(line)) {
      knows = knows || (request->ask == PageRequest::Ask::kControl && request->word == sources.token);
    }
    const Hearing hearing = page.on_message(line);
    now += std::chrono::milliseconds(100);
    const WebFrame frame = page.next();
    const auto records = test::records_of(frame);
    ISOBATH_ASSERT(frame.own.size() < 16 * 1024);
    ISOBATH_ASSERT(hearing.refused.empty() == test::of_kind(records, DisplayKind::kRefusal).empty());
    if (hearing.hang_up) break;
  }
  return 0;
}
