// LiveLoop: the same pipeline and the same agents with real threads: mapping in one of its own, each agent in one of
// its own, and whoever senses in the caller's (design: one code path; Herman 1988, 2; ledger S2-12, S6-31).
//
//   caller        take(event): the crew hears it at once; what must be mapped goes into a queue
//   mapping       events of the queue -> pipeline -> sweeps and echoes to the crew
//   each agent    its mailbox (threaded_crew.hpp)
//
// Planning never blocks mapping, and neither blocks the caller, who asks for the set-point whenever he wants one. A
// queue that is full loses its oldest ping; navigation, ranges and health reports are never lost. What a run decides
// depends on who is faster: a recorded run is replayed by MissionHelm.
//
// Time is that of the events, here too. A source that is faster than the world must call settle between its steps, or
// the watchdog takes agents that are merely slower for hung. Any thread may call progress and decisions; the rest
// belongs to one.
#pragma once

#include <isobath/mission/threaded_crew.hpp>
#include <isobath/runtime/closed_loop.hpp>
#include <isobath/runtime/mission_ears.hpp>
#include <memory>

namespace isobath {

struct LiveCounts {
  PipelineCounts pipeline;
  CrewCounts crew;
  std::uint64_t lost_pings = 0;  ///< in a full queue
};

class LiveLoop {
 public:
  static constexpr std::size_t kLongestQueue = 1024;  ///< events that wait to be mapped

  /// Throws Error where the crew or the pipeline cannot be made.
  LiveLoop(std::vector<Seat> seats, const VehicleSheet& vehicle, std::shared_ptr<const MissionPlan> plan,
           const Configuration& configuration);
  LiveLoop(const LiveLoop&) = delete;
  LiveLoop& operator=(const LiveLoop&) = delete;
  ~LiveLoop();

  void take(Event event);
  [[nodiscard]] Setpoint steer();
  /// Waits until all that was taken is mapped, heard and answered.
  void settle();

  [[nodiscard]] MissionReport progress() const;
  [[nodiscard]] std::vector<Decision> decisions() const;
  /// Settles first.
  [[nodiscard]] LiveCounts counts();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A scenario under a live crew: as run_closed_loop, but with real threads, which are waited for ten times a second of
/// the simulator's clock. It ends when the mission does, or when the time is over.
LoopResult run_live_loop(const Scenario& scenario, std::vector<Seat> seats, const VehicleSheet& vehicle,
                         const Configuration& configuration);

}  // namespace isobath
