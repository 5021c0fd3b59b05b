// LevelNotes: what each level of command did in a run: its commands, their intervals, and how long a command went on
// that served a superseded one; how often each level planned, and how far ahead (Herman 1988, 1, 3.4, 5; ledger S2-02,
// S2-25, S2-32, S2-38, S2-40, S2-52). Any thread may call on_message.
#pragma once

#include <array>
#include <deque>
#include <isobath/mission/command/bus.hpp>
#include <isobath/report/mission_outcome.hpp>
#include <mutex>
#include <optional>
#include <vector>

namespace isobath {

class LevelNotes {
 public:
  explicit LevelNotes(const TimingTable& timing);

  /// Every message of the agents, in order.
  void on_message(const Envelope& envelope);
  /// Commands to the actuators at a time that serve this message (CommandArbiter::served).
  void on_servo(Time time, std::uint64_t parent);
  /// One entry for each level that gave a command, from the mission down.
  [[nodiscard]] std::vector<LevelOutcome> outcome() const;

 private:
  static constexpr std::size_t kKept = 256;
  struct Command {
    std::uint64_t number = 0;
    CommandLink link;
  };
  struct Newest {
    std::uint64_t number = 0;
    Time time;
  };
  void note(Time time, std::uint64_t number, const CommandLink& link);
  void note_plan(Time time, const LevelPlan& plan);
  [[nodiscard]] const Command* find(std::uint64_t number) const;

  mutable std::mutex mutex_;
  std::deque<Command> commands_;  ///< the last ones, by number
  std::array<Newest, kCommandLevels> newest_{};
  std::array<std::optional<Time>, kCommandLevels> planned_{};
  std::array<std::uint64_t, kCommandLevels> with_horizon_{};  ///< plans that had something to plan
  std::array<LevelOutcome, kCommandLevels> levels_{};
};

}  // namespace isobath
