// How fast a run goes. No result depends on it, but for a live run: there it decides which thread is first.
#pragma once

#include <chrono>
#include <isobath/runtime/onboard.hpp>
#include <isobath/runtime/run_request.hpp>
#include <isobath/sim/simulator.hpp>
#include <optional>

namespace isobath {

/// Keeps the threads of a live run together: by the real clock, at `speed` times real time, or, at speed 0, by waiting
/// for all of them ten times a simulated second.
class LivePace {
 public:
  LivePace(double speed, const Simulator& simulator);
  /// Whether all of them were waited for.
  bool keep(Onboard& onboard);

 private:
  double speed_;
  const Simulator& simulator_;
  std::chrono::steady_clock::time_point start_;
  double settled_s_ = 0;
};

/// Lets a run be looked at: stopped when the watch says so, and, but for a live run, not faster than the watch says,
/// and stopped when it says so. A gap of time in a log is waited for no longer than kLongestWait_s.
class WatchedPace {
 public:
  static constexpr double kLongestWait_s = 2;
  /// `watch` must outlive it.
  explicit WatchedPace(const RunWatch& watch) : watch_(watch) {}

  /// Before an event of this time is heard. False: it is to end here.
  bool keep(Time time);

 private:
  using Clock = std::chrono::steady_clock;
  const RunWatch& watch_;
  std::optional<Time> last_;
  Clock::time_point due_ = Clock::now();
};

}  // namespace isobath
