// StageTimes: measures by a real clock how long each stage takes from an event to a decision (ledger S6-31). No result
// depends on it.
//
// The mapping thread reports when it begins an event (begin), when its ping is in the grid (mapped) and when the
// obstacles of its sweep are found (detected). The time from `aside` to `resume` counts for no stage. `timed` wraps an
// agent to measure its turns. A sweep that came after the clock was set back is not followed to its decision.
//
// begin, mapped, detected, aside and resume belong to one thread at a time; any thread may call the rest.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <isobath/mission/messages/agent.hpp>
#include <isobath/onboard/latency_histogram.hpp>
#include <map>
#include <memory>
#include <mutex>

namespace isobath {

struct MissionTimings {
  StageTime event_to_agents;   ///< until all agents have handled an event; live: until it is in their mailboxes
  StageTime ping_to_grid;      ///< until a ping is detected and mapped into the body grid
  StageTime detection;         ///< from the end of a sweep until its obstacles are found
  StageTime planning;          ///< the Navigator's turn on a scan of obstacles
  StageTime scan_to_decision;  ///< from the arrival of the event that ended a sweep until the Navigator has decided
  StageTime cycle;             ///< live: by how much cycles of the executors depart from their interval
  double agents_s = 0;         ///< processor time of the turns of all agents
};

class StageTimes {
 public:
  using Clock = std::chrono::steady_clock;

  void heard(Clock::duration lasted);
  void begin(Clock::time_point taken);
  void mapped();
  void detected(Time sweep);
  void aside();
  void resume();
  /// A turn of the Navigator on a scan.
  void planned(Time scan, Clock::time_point from, Clock::time_point to);
  /// Processor time of a turn of any agent.
  void worked(std::int64_t nanoseconds) { agents_ns_ += nanoseconds; }

  [[nodiscard]] MissionTimings timings() const;

 private:
  std::atomic<std::int64_t> agents_ns_{0};
  mutable std::mutex mutex_;
  Clock::time_point taken_, since_, aside_since_;
  std::map<Time, Clock::time_point> sweeps_;  ///< undecided sweeps: arrival of their last event
  LatencyHistogram heard_, mapped_, detected_, planned_, decided_;
};

/// Returns the slot with a timed agent. `plans`: its turns on scans of obstacles count as planning. The agent keeps
/// `times` alive.
AgentSlot timed(AgentSlot slot, std::shared_ptr<StageTimes> times, bool plans);

}  // namespace isobath
