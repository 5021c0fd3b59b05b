// MissionClock: the times of events as one clock that never goes back, for agents that count on it.
//
// It is the newest time that any event had. A late event changes nothing. Where `kSetBackAfter` events in a row, each
// in order after the last, lie behind it by more than `kLate`, the clock of the vehicle was set back: from then on it
// counts on from where it stood. A clock that was set forward, and silence, cannot be told apart: time has passed.
#pragma once

#include <isobath/base/time.hpp>

namespace isobath {

class MissionClock {
 public:
  static constexpr int kSetBackAfter = 20;
  static constexpr Duration kLate = std::chrono::milliseconds(500);

  /// The logical time at which an event of this time is heard.
  Time hear(Time event);
  [[nodiscard]] Time now() const { return now_; }
  /// What an event's own time must be moved by to be on this clock.
  [[nodiscard]] Duration offset() const { return offset_; }

 private:
  bool started_ = false;
  Time now_{};
  Duration offset_{};
  Time late_newest_{};
  int late_ = 0;
};

}  // namespace isobath
