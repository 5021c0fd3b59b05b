// Crew: the agents of a vehicle, run one after the other on a logical clock (Ganesan 2015, 5.1; ledger S6-32, S6-33).
//
//   Crew crew(std::move(seats), sheet_of(model), config, [&](const Envelope& e) { log.write(e); });
//   crew.hear(navigation, time);           // as often as something is sensed
//   vehicle.obey(crew.helm(time));
//
// The clock starts with the first call. It ticks every 0.1 s after that: first each agent has its turn to tick, in the
// order of the seats, then what they said is heard. Messages stand in one queue, first in, first out; each is heard by
// all seats in their order, its sender's included, and what an agent says in its turn joins the queue. Ticks that are
// due come before what is sensed at the same instant.
//
// Supervision: an agent that throws is dead, one that misses `missed_ticks` ticks is hung: it gets no further turn, and
// all others hear AgentLost. The others go on. What an agent says beyond `most_said` messages between two ticks is cut,
// counted and reported by a Decision. A clock that goes back is refused and counted; one that jumps ahead by more than
// `most_ticks` ticks skips the first of them, and a Decision says so.
//
// Deterministic: the same calls give the same envelopes and set-points. One thread at a time. Cost: 0.8 us a message
// for nine seats that do nothing.
#pragma once

#include <deque>
#include <isobath/mission/bus.hpp>
#include <isobath/mission/helm_gate.hpp>
#include <string_view>

namespace isobath {

struct CrewConfig {
  int missed_ticks = 5;
  int most_said = 256;
  int most_ticks = 50;
  int mailbox = 1024;  ///< messages that wait for one agent; of agents in threads of their own only
  HelmGateConfig gate;
};
std::vector<Field> fields(CrewConfig& config);

struct CrewCounts {
  std::uint64_t ticks = 0;
  std::uint64_t skipped_ticks = 0;
  std::uint64_t refused = 0;   ///< calls with a time before that of an earlier one
  std::uint64_t cut = 0;       ///< messages of agents that said too much
  std::uint64_t overflow = 0;  ///< messages that found a mailbox full
  std::uint64_t lost = 0;      ///< agents
  std::uint64_t limited = 0;   ///< set-points that were cut to what vehicle and mission allow (helm_gate.hpp)
};

/// Throws Error where a name is empty, taken twice or a sender of its own, a seat has no agent, or the gate's Safety
/// Officer has no seat.
void check_seats(const std::vector<Seat>& seats, const CrewConfig& config);

class Crew {
 public:
  /// Throws Error as check_seats.
  Crew(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config = {}, Recorder recorder = {});

  /// All of these: false where the time is before that of an earlier call; then nothing happens.
  bool hear(Message sensed, Time now);
  bool advance(Time now);
  /// What the vehicle shall do from now on; of the latest instant where `now` is before it.
  Setpoint helm(Time now);

  /// Faults for tests: from now on it gets no turn, and nobody is told; or it dies in its next turn. The name must be
  /// that of a seat.
  void hang(std::string_view name);
  void kill(std::string_view name);

  [[nodiscard]] bool has(std::string_view name) const;  ///< whether there is such a seat
  [[nodiscard]] bool lost(std::string_view name) const;
  [[nodiscard]] const CrewCounts& counts() const { return counts_; }
  [[nodiscard]] const std::map<std::string, Bus::Counts>& said() const { return bus_.said(); }
  [[nodiscard]] HelmState helm_state() const { return gate_.state(); }

 private:
  struct Member {
    Seat seat;
    bool lost = false;
    bool hanging = false;
    bool dying = false;
    int missed = 0;  ///< ticks in a row
    int said = 0;    ///< since the last tick
  };
  Member& member(std::string_view name);
  bool set_clock(Time now);
  void tick();
  void settle();  ///< until nobody has anything to say
  void drain();
  void end_turn(Member& member, Turn turn);
  void lose(Member& member, bool hung, const std::string& why);
  void post(const std::string& sender, Message message);
  void decide(const char* what, std::string reason);

  CrewConfig config_;
  Bus bus_;
  HelmGate gate_;
  std::vector<Member> members_;
  std::deque<Envelope> queue_;
  std::optional<Time> start_;
  Time now_;
  Time next_tick_;
  bool back_ = false;  ///< the last call was refused
  Setpoint setpoint_;
  CrewCounts counts_;
};

}  // namespace isobath
