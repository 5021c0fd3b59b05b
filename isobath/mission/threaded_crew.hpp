// ThreadedCrew: the same seats as Crew, each agent in a thread of its own (Ganesan 2015, 5.1; Herman 1988, 2; ledger
// S6-33, S2-12). For vehicles, where an agent that plans for long must not keep the others waiting.
//
// Every message goes into the mailbox of every seat, in one order; how fast each works its mailbox off is its own
// affair, so that replies have no order between agents and a run is not reproducible: that is what Crew is for. A full
// mailbox loses its oldest message; no more than one tick waits in it. Both are counted, the first also by a Decision.
//
// Supervision: an agent that throws is dead, one whose turn has not ended within `missed_ticks` ticks of the clock is
// hung. It is no longer fed, what it says is no longer heard, all others hear AgentLost, and nobody waits for it: not
// even the destructor, which waits for turns under way only as long as the watchdog would, by the same clock. A thread
// that never comes back keeps its own agent alive, and ends when its turn does; that agent must not lean on what others
// may destroy.
//
// `clock` and the recorder are called from all threads, one at a time, and must be quick and not call the crew. Any
// thread may call the functions below.
#pragma once

#include <functional>
#include <isobath/mission/crew.hpp>
#include <thread>

namespace isobath {

class ThreadedCrew {
 public:
  /// Throws Error as check_seats, and where the system has no thread left.
  ThreadedCrew(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config,
               std::function<Time()> clock, Recorder recorder = {});
  ThreadedCrew(const ThreadedCrew&) = delete;
  ThreadedCrew& operator=(const ThreadedCrew&) = delete;
  ~ThreadedCrew();

  void hear(Message sensed);
  /// Ticks that are due, the watchdog, the helm; to be called at least ten times a second of the clock.
  void advance();
  /// Advances; what the vehicle shall do from now on.
  Setpoint helm();
  /// Waits until no mailbox holds anything and no turn is under way, but for agents that are lost, or hang by `hang`.
  /// One that hangs of itself keeps it waiting until another thread's advance has given it up.
  void settle();

  /// Faults for tests, as those of Crew: its next turn does not end before it is given up; or it dies in it. The name
  /// must be that of a seat.
  void hang(std::string_view name);
  void kill(std::string_view name);

  [[nodiscard]] bool has(std::string_view name) const;  ///< whether there is such a seat
  [[nodiscard]] bool lost(std::string_view name) const;
  [[nodiscard]] CrewCounts counts() const;
  [[nodiscard]] std::map<std::string, Bus::Counts> said() const;

 private:
  struct Post;
  struct State;
  [[nodiscard]] Post& post(std::string_view name) const;
  void stop();

  std::shared_ptr<State> state_;
  std::vector<std::thread> threads_;
};

}  // namespace isobath
