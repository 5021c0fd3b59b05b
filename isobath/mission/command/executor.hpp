// Executor: runs the agents of a vehicle one after the other on a logical clock (Ganesan 2015, 5.1;
// ledger S6-32, S6-33).
//
//   Executor executor(std::move(slots), parameters_of(model), config, [&](const Envelope& e) { log.write(e); });
//   executor.on_message(navigation, time);  // for each sensor input
//   vehicle.obey(executor.helm(time));
//
// The clock starts with the first call and ticks every 0.1 s after that. At each tick, the agents take their turns in
// the order of their slots; then their messages are delivered. Messages wait in one queue, first in, first out. All
// agents receive each message in their order, its sender included; the messages of their turns join the queue. Ticks
// that are due come before sensor input of the same instant.
//
// Supervision: an agent that throws is dead; one that misses `missed_ticks` ticks is hung. A lost agent gets no further
// turn; all others receive AgentLost and go on. The messages of an agent beyond `max_messages` between two ticks are
// dropped, counted, and reported by a Decision. A clock that goes back is refused and counted. If the clock jumps ahead
// by more than `max_ticks` ticks, the first of them are skipped, and a Decision reports it.
//
// Deterministic: the same calls give the same envelopes and set-points. One thread at a time. Cost: 0.8 us a message
// for nine agents that do nothing.
#pragma once

#include <deque>
#include <isobath/mission/command/agent_executor.hpp>
#include <isobath/mission/command/bus.hpp>
#include <isobath/mission/command/command_arbiter.hpp>
#include <string_view>

namespace isobath {

struct ExecutorConfig {
  int missed_ticks = 5;
  int max_messages = 256;
  int max_ticks = 50;
  int mailbox = 1024;  ///< maximum number of messages that wait for one agent; ThreadedExecutor only
  CommandArbiterConfig arbiter;
};
std::vector<Field> fields(ExecutorConfig& config);

struct ExecutorCounts {
  std::uint64_t ticks = 0;
  std::uint64_t skipped_ticks = 0;
  std::uint64_t refused = 0;   ///< calls with a time before that of an earlier one
  std::uint64_t cut = 0;       ///< messages dropped because their agent sent too many
  std::uint64_t overflow = 0;  ///< messages dropped from full mailboxes
  std::uint64_t lost = 0;      ///< lost agents
  std::uint64_t limited = 0;   ///< set-points that were limited to what vehicle and mission allow (command_arbiter.hpp)
};

/// Throws Error where a name is empty, taken twice or reserved for another sender, a slot has no agent, or no agent has
/// the name of the gate's Safety Officer.
void check_slots(const std::vector<AgentSlot>& slots, const ExecutorConfig& config);

class Executor final : public AgentExecutor {
 public:
  /// Throws Error like check_slots.
  Executor(std::vector<AgentSlot> slots, const VehicleParameters& vehicle, const ExecutorConfig& config = {},
           Recorder recorder = {});

  /// `on_message` and `advance` return false where the time is before that of an earlier call; the call is then
  /// refused.
  bool on_message(Message sensed, Time now) override;
  bool advance(Time now);
  /// The set-point from now on; that of the latest instant where `now` is before it.
  Setpoint helm(Time now);
  /// CommandArbiter::served of the last set-point.
  [[nodiscard]] std::uint64_t served() const { return arbiter_.served(); }

  /// Faults for tests: `hang` gives an agent no further turn and sends no message about it; `kill` makes an agent die
  /// in its next turn. The name must be that of an agent.
  void hang(std::string_view name) override;
  void kill(std::string_view name) override;

  [[nodiscard]] bool has(std::string_view name) const override;
  [[nodiscard]] std::vector<AgentReport> crew() const override;
  [[nodiscard]] bool lost(std::string_view name) const;
  [[nodiscard]] const ExecutorCounts& counts() const { return counts_; }
  [[nodiscard]] const std::map<std::string, Bus::Counts>& said() const { return bus_.said(); }
  [[nodiscard]] HelmState helm_state() const { return arbiter_.state(); }

 private:
  struct Member {
    AgentSlot slot;
    bool lost = false;
    bool hanging = false;
    bool dying = false;
    int missed = 0;  ///< ticks in a row
    int said = 0;    ///< since the last tick
  };
  Member& member(std::string_view name);
  bool set_clock(Time now);
  void tick();
  void settle();  ///< until no message is left
  void drain();
  void end_turn(Member& member, Turn turn);
  void lose(Member& member, bool hung, const std::string& why);
  void post(const std::string& sender, Message message);
  void decide(const char* what, std::string reason);

  ExecutorConfig config_;
  Bus bus_;
  CommandArbiter arbiter_;
  std::vector<Member> members_;
  std::deque<Envelope> queue_;
  std::optional<Time> start_;
  Time now_;
  Time next_tick_;
  bool back_ = false;  ///< the last call was refused
  Setpoint setpoint_;
  ExecutorCounts counts_;
};

}  // namespace isobath
