#include <algorithm>
#include <isobath/onboard/mission_clock.hpp>

namespace isobath {

Time MissionClock::update(Time event) {
  if (!started_) {
    started_ = true;
    return now_ = event;
  }
  const Time at = event + offset_;
  if (at >= now_ - kLate) {
    late_ = 0;
    return now_ = std::max(now_, at);
  }
  late_ = late_ > 0 && event >= late_newest_ ? late_ + 1 : 1;
  late_newest_ = event;
  if (late_ >= kSetBackAfter) {
    offset_ = now_ - event;
    late_ = 0;
  }
  return now_;
}

}  // namespace isobath
