// StageTimes: how long each stage takes of the way from an event to a decision, by a real clock: no result depends on
// it (ledger S6-31).
//
// Whoever maps says when an event is begun (begin), when its ping is in the grid (mapped) and when the obstacles of its
// sweep are found (detected); what it does for others from `aside` to `resume` counts for no stage. Agents are timed in
// their seats (timed). A sweep that was heard after the clock was set back is not followed to its decision.
//
// begin, mapped, detected, aside and resume belong to one thread at a time; the rest to any.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <isobath/mission/agent.hpp>
#include <isobath/runtime/mission_outcome.hpp>
#include <isobath/runtime/stage_spread.hpp>
#include <map>
#include <memory>
#include <mutex>

namespace isobath {

class StageTimes {
 public:
  using Clock = std::chrono::steady_clock;

  void heard(Clock::duration lasted);
  void begin(Clock::time_point taken);
  void mapped();
  void detected(Time sweep);
  void aside();
  void resume();
  /// The Navigator's turn about a scan.
  void planned(Time scan, Clock::time_point from, Clock::time_point to);
  /// Processor time of any agent's turn.
  void worked(std::int64_t nanoseconds) { agents_ns_ += nanoseconds; }

  [[nodiscard]] MissionTimings timings() const;

 private:
  std::atomic<std::int64_t> agents_ns_{0};
  mutable std::mutex mutex_;
  Clock::time_point taken_, since_, aside_since_;
  std::map<Time, Clock::time_point> sweeps_;  ///< not decided yet: when their last event came
  StageSpread heard_, mapped_, detected_, planned_, decided_;
};

/// The seat, with its agent timed; `plans`: each of its turns about a scan of obstacles is planning. The times live as
/// long as the agent.
Seat timed(Seat seat, std::shared_ptr<StageTimes> times, bool plans);

}  // namespace isobath
