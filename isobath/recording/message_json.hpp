// message_json: a message of the agents as JSON, for readers of a recording: one object with number, time_ns, sender,
// type and content. Large content (maps, plans, grids) is given by its size. Exact values stand in the channels of
// events. Numbers are rounded to 1e-6; one that is not finite becomes null. SI units, angles in radians, positions
// in W.
#pragma once

#include <isobath/mission/command/bus.hpp>
#include <string>

namespace isobath {

/// A command also has its level and the number of the command that it serves (command_chain.hpp).
std::string message_json(const Envelope& envelope);
/// The JSON Schema of these objects.
const char* message_schema();

/// The servo level: commands to the actuators of a simulated vehicle, in the order of the vehicle file (thrusters in N,
/// fins in rad), and the number of the helm order or safety action that they serve.
std::string servo_json(Time time, std::uint64_t parent, const ActuatorVector& commands);
const char* servo_schema();

}  // namespace isobath
