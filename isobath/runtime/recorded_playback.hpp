// RecordedPlayback: a recording (RunRecorder) as a page plays it, finished or still growing.
//
// One that grows is looked at again at most every kRefresh of a real clock; its end is the end of its last whole chunk,
// so that it lags behind what happens by `recorder.log.chunk_s` at most.
#pragma once

#include <chrono>
#include <isobath/runtime/playback.hpp>
#include <isobath/runtime/recorded_display.hpp>

namespace isobath {

class RecordedPlayback final : public Playback {
 public:
  static constexpr std::chrono::milliseconds kRefresh{500};

  /// Throws Error where the file is no recording, or holds no moment yet.
  explicit RecordedPlayback(const std::filesystem::path& file);

  TimeSpan span() override;
  void show(Time moment, DisplayItems& items) override;
  Time step(Time from, int steps) override;

 private:
  using Clock = std::chrono::steady_clock;
  RecordedDisplay display_;
  TimeSpan span_;
  Clock::time_point refreshed_;
};

}  // namespace isobath
