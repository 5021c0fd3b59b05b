// Health: a report on the state of a part of the vehicle, by the part itself or by a watchdog after it has gone silent.
#pragma once

#include <cstdint>
#include <isobath/base/time.hpp>
#include <string>

namespace isobath {

enum class HealthState : std::uint8_t { kOk, kDegraded, kLost };
const char* to_text(HealthState state);

struct Health {
  Time time;
  std::string source;  ///< "vehicle", or the name of a sensor: "sonar", "dvl", ...
  HealthState state = HealthState::kOk;
  float battery_share = 1;  ///< of a full charge, 0..1
  bool leak = false;
  std::string note = {};  ///< for people
};

/// Note of a report that an agent ("agent.NAME") is lost because it hangs; without it the agent has died.
inline constexpr const char* kHangs = "hangs";

}  // namespace isobath
