// How fast a simulation is to go, as --speed says it.
#pragma once

#include <string>

namespace isobath::app {

/// How many simulated seconds pass in a real one; 0 ("max"): as many as go. Throws Error.
double speed_of(const std::string& speed);

}  // namespace isobath::app
