// A message of the crew as JSON, for whoever reads a recording: one object with number, time_ns, sender, type and
// content. What is large (maps, plans, grids) is told by its size; what is exact stands in the channels of events.
// Numbers are rounded to 1e-6, one that is not finite is null. SI units, angles in radians, positions in W.
#pragma once

#include <isobath/mission/bus.hpp>
#include <string>

namespace isobath {

std::string message_json(const Envelope& envelope);
/// JSON Schema of these objects.
const char* message_schema();

}  // namespace isobath
