// CommandChain: names the level of each command and the command of the level above that it serves, down to the
// set-point of the servo level (Herman 1988, 1; ledger S2-02, S2-26, S2-52).
//
//   level      command                  from              parent
//   mission    mission order            Captain           the operator's command
//   group      visit order              Commodore         the mission order
//   vehicle    route request            Executive Officer the visit order; without one, the mission order
//              sonar order          Executive Officer the visit order; without one, the mission order
//   move       route planned,           Navigator,        the route request that it names,
//              follow order,            Executive Officer the route that it names; none: it holds for the order above
//              motion order             Goal Selector     the follow order that it names
//   primitive  helm order               Pilot             the motion order while it lasts, else the follow order
//              safety action            Safety Officer    none: it overrides the helm orders, as a reflex
//   servo      set-point to actuators   helm gate         the helm order or safety action (CommandArbiter::served)
//
// A parent is found by what the command names, not by what was last said, so that a command that serves an old order
// shows it. Only the last kKept requests, routes and orders are known; a command that serves an older one has no
// parent. One thread at a time; allocates nothing after construction.
#pragma once

#include <array>
#include <isobath/mission/messages/messages.hpp>
#include <optional>

namespace isobath {

/// The level of a command, and the command that it serves.
struct CommandLink {
  CommandLevel level = CommandLevel::kMission;
  std::uint64_t parent = 0;  ///< Envelope::number of the command above; 0: none
  bool operator==(const CommandLink&) const = default;
};

class CommandChain {
 public:
  static constexpr std::size_t kKept = 16;

  /// Empty: the message is no command. `number`: that of its envelope; calls in the order of the bus.
  std::optional<CommandLink> link(const Message& message, std::uint64_t number, Time now);

 private:
  /// The numbers of the last messages that others name by an id.
  class Named {
   public:
    void note(std::uint32_t id, std::uint64_t number) {
      known_[next_] = {id, number};
      next_ = (next_ + 1) % kKept;
    }
    [[nodiscard]] std::uint64_t number_of(std::uint32_t id) const;

   private:
    std::array<std::pair<std::uint32_t, std::uint64_t>, kKept> known_{};
    std::size_t next_ = 0;
  };

  std::uint64_t operator_ = 0, mission_ = 0;  ///< the last command of the operator, the last mission order
  std::uint64_t order_ = 0;                   ///< the last order of mission or group
  Named requests_, routes_, follows_;
  std::uint64_t follow_ = 0;  ///< the last follow order
  std::uint32_t follow_version_ = 0;
  std::uint64_t motion_ = 0;
  std::optional<Time> motion_at_;
};

}  // namespace isobath
