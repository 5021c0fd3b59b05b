#include <algorithm>
#include <isobath/run/run_pace.hpp>
#include <thread>

namespace isobath {

LivePace::LivePace(double speed, const Simulator& simulator)
    : speed_(speed), simulator_(simulator), start_(std::chrono::steady_clock::now()) {}

bool LivePace::keep(Onboard& onboard) {
  const double now_s = simulator_.now_s();
  if (speed_ > 0) {
    std::this_thread::sleep_until(start_ + std::chrono::duration<double>(now_s / speed_));
  } else if (now_s - settled_s_ >= to_seconds(kTick)) {
    onboard.settle();
    settled_s_ = now_s;
    return true;
  }
  return false;
}

bool WatchedPace::keep(Time time) {
  constexpr Clock::duration kMaxBehind = std::chrono::milliseconds(500);
  if (watch_.stopped && watch_.stopped()) return false;
  if (watch_.speed <= 0) return true;
  const auto now = Clock::now();
  const double ahead_s = last_ ? to_seconds(time - *last_) / watch_.speed : 0;
  if (time > last_.value_or(Time::min())) last_ = time;
  due_ += std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(std::clamp(ahead_s, 0.0, kLongestWait_s)));
  due_ = std::max(due_, now - kMaxBehind);  // the run catches up after a delay, but by no more than kMaxBehind
  while (due_ > Clock::now()) {
    if (watch_.stopped && watch_.stopped()) return false;
    std::this_thread::sleep_until(std::min(due_, Clock::now() + kMaxBehind));
  }
  return true;
}

}  // namespace isobath
