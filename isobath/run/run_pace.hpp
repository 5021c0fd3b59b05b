// LivePace and WatchedPace: the speed of a run. No result depends on it, except in live runs, whose results depend on
// the timing of the threads.
#pragma once

#include <chrono>
#include <isobath/onboard/onboard.hpp>
#include <isobath/run/run_request.hpp>
#include <isobath/sim/simulator.hpp>
#include <optional>

namespace isobath {

/// Keeps the threads of a live run in step: by the real clock at `speed` times real time, or, at speed 0, by waiting
/// for all threads ten times per simulated second.
class LivePace {
 public:
  LivePace(double speed, const Simulator& simulator);
  /// Returns whether it waited for all threads.
  bool keep(Onboard& onboard);

 private:
  double speed_;
  const Simulator& simulator_;
  std::chrono::steady_clock::time_point start_;
  double settled_s_ = 0;
};

/// Paces a run that a page watches: it ends when `watch.stopped` says so, and runs no faster than `watch.speed` (0: no
/// limit, as for a live run). A gap in the times of a log delays the run by at most kLongestWait_s.
class WatchedPace {
 public:
  static constexpr double kLongestWait_s = 2;
  /// `watch` must outlive it.
  explicit WatchedPace(const RunWatch& watch) : watch_(watch) {}

  /// Call before each event, with its time. Returns false if the run is to end here.
  bool keep(Time time);

 private:
  using Clock = std::chrono::steady_clock;
  const RunWatch& watch_;
  std::optional<Time> last_;
  Clock::time_point due_ = Clock::now();
};

}  // namespace isobath
