// message_json: a message of the agents as JSON, for readers of a recording: one object with number, time_ns, sender,
// type and content. Large content (maps, plans, grids) is given by its size. Exact values stand in the channels of
// events. Numbers are rounded to 1e-6; one that is not finite becomes null. SI units, angles in radians, positions
// in W.
#pragma once

#include <isobath/mission/command/bus.hpp>
#include <string>

namespace isobath {

std::string message_json(const Envelope& envelope);
/// The JSON Schema of these objects.
const char* message_schema();

}  // namespace isobath
