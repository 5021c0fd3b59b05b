// LevelDisplay: the command in force at each level, for the page: from the mission down to the actuators, who gave it,
// since when, which command above it serves, how far ahead the level plans, and where the vehicle is in its plan graph
// (ledger S2-52). The levels of the mission, the group, the vehicle and the moves are shown when they change, those
// below at most once a second.
#pragma once

#include <array>
#include <isobath/display/display_state.hpp>
#include <isobath/mission/command/bus.hpp>
#include <optional>
#include <string>

namespace isobath {

class LevelDisplay {
 public:
  explicit LevelDisplay(DisplayState& items) : items_(items) {}

  /// Every message of the agents.
  void on_message(const Envelope& envelope);
  /// Commands to the actuators as text, and the number of the message that they serve.
  void on_servo(Time time, std::uint64_t parent, const std::string& text);

 private:
  struct Command {
    std::uint64_t number = 0, parent = 0;
    Time since;
    std::string by, text;
  };
  void show(Time time, bool often);
  void put(CommandLevel level, Command command);

  DisplayState& items_;
  std::array<Command, kCommandLevels> levels_{};
  std::array<double, kCommandLevels> horizon_s_{};
  std::string step_;  ///< of the plan graph
  std::optional<Time> shown_;
};

/// One line: "heading 5 deg, depth 12.0 m, 1.50 m/s"; empty: the message is no command.
std::string command_text(const Message& message);

}  // namespace isobath
