// ThreadedExecutor: runs the same agents as Executor, each in a thread of its own (Ganesan 2015, 5.1; Herman 1988, 2;
// ledger S6-33, S2-12). For vehicles, where an agent that plans for long must not keep the others waiting.
//
// Every message goes into the mailbox of every agent, in one order. Each agent empties its mailbox at its own pace, so
// that replies have no order between agents and a run is not reproducible; Executor runs are. A full mailbox loses its
// oldest message, and no more than one tick waits in it. Both losses are counted; a Decision also reports the first.
//
// Supervision: an agent that throws is dead; one whose turn has not ended within `missed_ticks` ticks of the clock is
// hung. A lost agent receives no more messages, its own messages are discarded, all others receive AgentLost, and no
// thread waits for it. The destructor, too, waits for running turns only as long as the watchdog would, by the same
// clock. A thread that never returns keeps its own agent alive, and ends when its turn does; that agent must not use
// objects that other code may destroy.
//
// `clock` and the recorder are called from all threads, one at a time; they must be quick and must not call the
// executor. Any thread may call the functions below.
#pragma once

#include <functional>
#include <isobath/mission/command/executor.hpp>
#include <thread>

namespace isobath {

class ThreadedExecutor final : public AgentExecutor {
 public:
  /// Throws Error like check_slots, and where the system has no thread left.
  ThreadedExecutor(std::vector<AgentSlot> slots, const VehicleParameters& vehicle, const ExecutorConfig& config,
                   std::function<Time()> clock, Recorder recorder = {});
  ~ThreadedExecutor() override;

  /// Refuses nothing. The time does not matter: the executor has a clock.
  bool on_message(Message sensed, Time now) override;
  /// Runs the ticks that are due, the watchdog and the helm; must be called at least ten times a second of the clock.
  void advance();
  /// Advances, and returns the set-point from now on.
  Setpoint helm();
  /// CommandArbiter::served of the last set-point.
  [[nodiscard]] std::uint64_t served() const;
  /// Waits until all mailboxes are empty and no turn is running, except for agents that are lost, or hang by `hang`. An
  /// agent that hangs by itself keeps it waiting until the `advance` of another thread has given that agent up.
  void settle();

  /// Faults for tests, like those of Executor: the agent's next turn does not end before it is given up; or it dies in
  /// that turn. The name must be that of an agent.
  void hang(std::string_view name) override;
  void kill(std::string_view name) override;

  [[nodiscard]] bool has(std::string_view name) const override;
  [[nodiscard]] std::vector<AgentReport> crew() const override;
  [[nodiscard]] bool lost(std::string_view name) const;
  [[nodiscard]] ExecutorCounts counts() const;
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
