// CommandLevel: the six levels of command, from the mission to the actuators (Herman 1988, 1; ledger S2-02).
#pragma once

#include <cstddef>
#include <cstdint>

namespace isobath {

enum class CommandLevel : std::uint8_t { kMission, kGroup, kVehicle, kMove, kPrimitive, kServo };
inline constexpr std::size_t kCommandLevels = 6;
const char* to_text(CommandLevel level);

}  // namespace isobath
