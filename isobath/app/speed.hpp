// The value of --speed: the pace of a simulation.
#pragma once

#include <string>

namespace isobath::app {

/// Simulated seconds per real second; 0 ("max"): no limit. Throws Error.
double speed_of(const std::string& speed);

}  // namespace isobath::app
