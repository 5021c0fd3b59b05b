// How a fan stands in the body: flat, upright, or looking down.
#pragma once

#include <isobath/sonar/ping.hpp>

namespace isobath {

/// Whether a fan is horizontal: its beams lie side by side rather than one above the other, however far the fan is
/// tilted up or down. The fan of an echo sounder, which looks straight down and athwart, is not horizontal.
bool lies_flat(const Ping& ping);

/// Whether the down axis of the vehicle lies within the fan: it is an echo sounder, which measures the bottom.
bool looks_down(const Ping& ping);

}  // namespace isobath
