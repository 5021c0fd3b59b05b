// RecordedPlayback: plays a recording (RunRecorder) for a page. The recording may be finished or still growing.
//
// A growing recording is read again at most every kRefresh of a real clock. It ends with its last complete chunk, so it
// lags behind the run by at most `recorder.log.chunk_s`.
#pragma once

#include <chrono>
#include <isobath/display/playback.hpp>
#include <isobath/recording/recorded_display.hpp>

namespace isobath {

class RecordedPlayback final : public Playback {
 public:
  static constexpr std::chrono::milliseconds kRefresh{500};

  /// Throws Error if the file is not a recording, or holds no moment yet.
  explicit RecordedPlayback(const std::filesystem::path& file);

  TimeSpan span() override;
  void show(Time moment, DisplayState& items) override;
  Time step(Time from, int steps) override;

 private:
  using Clock = std::chrono::steady_clock;
  RecordedDisplay display_;
  TimeSpan span_;
  Clock::time_point refreshed_;
  bool signals_told_ = false;
};

}  // namespace isobath
