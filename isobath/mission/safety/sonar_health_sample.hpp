// The Safety Officer's data about a ping, independent of all maps (ledger S1-43, S1-44): its quality as soon as it
// arrives, which needs no pose, and its echoes once they are decided and the pose is known.
#pragma once

#include <isobath/mission/messages/messages.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <optional>
#include <string>

namespace isobath {

/// The ping must pass `check`.
SonarHealthSample look_of(const Ping& ping, std::string sonar);

/// The nearest echoes that stand out by `contrast` (ping_quality.hpp), and the pose of the vehicle. Empty where no bin
/// could be decided. Without the fan, which would tell where it is silent, if the beams are tilted by more than a
/// quarter of their height.
std::optional<SonarEchoes> echoes_of(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
                                     double contrast);

}  // namespace isobath
