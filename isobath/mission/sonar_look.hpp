// SonarLook made of a ping: what the Safety Officer looks at, before any map and apart from it (ledger S1-43, S1-44).
//
// The vitals need no pose and can be told as soon as the ping comes, by a look without echoes; the echoes need the
// decisions, and may follow by a second look of the same time.
#pragma once

#include <isobath/mission/messages.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <string>

namespace isobath {

/// The ping must pass `check`. Without echoes.
SonarLook look_of(const Ping& ping, std::string sonar);

/// Adds the nearest echoes that stand out by `contrast` (ping_vitals.hpp), and where the vehicle was.
void add_echoes(SonarLook& look, const Ping& ping, const EchoDecisions& decisions, bool decided, const Pose& X_WB,
                double contrast);

}  // namespace isobath
