// StageTimes: how long each stage takes of the way from an event to a decision, by a real clock: no result depends on
// it (ledger S6-31).
//
// Whoever maps says when an event is begun (begin), when its ping is in the grid (mapped) and when the obstacles of its
// sweep are found (detected); what it does for others from `aside` to `resume` counts for no stage. The Navigator is
// timed in its seat (timed). A sweep that was heard after the clock was set back is not followed to its decision.
//
// begin, mapped, detected, aside and resume belong to one thread at a time; the rest to any.
#pragma once

#include <chrono>
#include <isobath/mission/agent.hpp>
#include <isobath/runtime/mission_outcome.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

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

  [[nodiscard]] MissionTimings timings() const;

 private:
  mutable std::mutex mutex_;
  Clock::time_point taken_, since_, aside_since_;
  std::map<Time, Clock::time_point> sweeps_;  ///< not decided yet: when their last event came
  std::vector<double> heard_ms_, mapped_ms_, detected_ms_, planned_ms_, decided_ms_;
};

/// The seat, with its agent timed at each scan of obstacles; the times live as long as the agent.
Seat timed(Seat seat, std::shared_ptr<StageTimes> times);

}  // namespace isobath
