// FanLooks: what a detector of fans decided of one ping, one decision for each resolution cell (fan_detector.hpp).
#pragma once

#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>

namespace isobath {

/// The looks of one ping: one decision per resolution cell. `ping` has the geometry of the cells and no samples.
struct FanLooks {
  Ping ping;
  EchoDecisions decisions;
};

}  // namespace isobath
