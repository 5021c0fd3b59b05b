// MissionClock: turns the times of events into one clock that never goes back; the agents rely on that.
//
// The clock shows the newest time of any event. A late event does not change it. If `kSetBackAfter` events in a row,
// in order among themselves, are more than `kLate` behind it, then the clock of the vehicle was set back: MissionClock
// then goes on from the time that it shows. A clock that was set forward cannot be told from silence: in both cases
// time has passed.
#pragma once

#include <isobath/base/time.hpp>

namespace isobath {

class MissionClock {
 public:
  static constexpr int kSetBackAfter = 20;
  static constexpr Duration kLate = std::chrono::milliseconds(500);

  /// Takes the time of the next event. Returns the logical time of its arrival.
  Time update(Time event);
  [[nodiscard]] Time now() const { return now_; }
  /// Added to an event's own time, it gives the time on this clock.
  [[nodiscard]] Duration offset() const { return offset_; }

 private:
  bool started_ = false;
  Time now_{};
  Duration offset_{};
  Time late_newest_{};
  int late_ = 0;
};

}  // namespace isobath
