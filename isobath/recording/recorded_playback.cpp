#include <algorithm>
#include <cstdlib>
#include <isobath/base/error.hpp>
#include <isobath/recording/recorded_playback.hpp>
#include <string>
#include <utility>

namespace isobath {

RecordedPlayback::RecordedPlayback(const std::filesystem::path& file) : display_(file), refreshed_(Clock::now()) {
  const auto span = display_.span();
  if (!span) throw Error("the recording is still empty", {file.string(), {}, {}, {}, {}}, "", "try again later");
  span_ = {span->first, span->last};
}

TimeSpan RecordedPlayback::span() {
  const Clock::time_point now = Clock::now();
  if (display_.complete() || now - refreshed_ < kRefresh) return span_;
  refreshed_ = now;
  if (!display_.refresh()) return span_;
  if (const auto span = display_.span()) span_ = {span->first, span->last};
  return span_;
}

void RecordedPlayback::show(Time moment, DisplayState& items) {
  if (std::exchange(signals_told_, true)) return display_.advance(moment, items);
  DisplayState end;  // a page plots its signals over the whole recording
  display_.seek(span_.end, end);
  display_.seek(moment, items);
  std::string signals;
  for_each_record(end.changes_after(0).records, [&](const DisplayRecord& r) {
    if (r.kind == DisplayKind::kSignals) append_record(signals, r.kind, r.number, r.time, r.payload, r.gone);
  });
  items.update(signals);
}

Time RecordedPlayback::step(Time from, int steps) {
  Time moment = from;
  for (int i = 0; i < std::abs(steps); ++i) {
    const auto next = steps > 0 ? display_.moment_after(moment) : display_.moment_before(moment);
    if (!next) break;
    moment = *next;
  }
  return std::clamp(moment, span_.start, span_.end);
}

}  // namespace isobath
