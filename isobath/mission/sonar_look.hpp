// What the Safety Officer is told of a ping, before any map and apart from it (ledger S1-43, S1-44): its vitals as soon
// as it comes, which need no pose, and its echoes once it is decided and placed.
#pragma once

#include <isobath/mission/messages.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <optional>
#include <string>

namespace isobath {

/// The ping must pass `check`.
SonarLook look_of(const Ping& ping, std::string sonar);

/// The nearest echoes that stand out by `contrast` (ping_vitals.hpp), and where the vehicle was. Empty where no bin
/// could be decided.
std::optional<SonarEchoes> echoes_of(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
                                     double contrast);

}  // namespace isobath
