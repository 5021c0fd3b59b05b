// Records of the native log from values: CDR, little-endian, field by field as native_log_kinds.hpp defines them.
// For the native log, and for the bags of ROS that
// carry the same records.
#pragma once

#include <cstdint>
#include <isobath/event/event.hpp>
#include <isobath/sonar/echo_truth.hpp>
#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/vehicle_state.hpp>
#include <vector>

namespace isobath::native {

/// Whether a ping has beams and its samples are beams x bins; no reader could use another one.
bool writable(const Ping& ping);

// Each overwrites `record`. A ping must be writable.
void encode(const Event& event, std::vector<std::uint8_t>& record);
/// A ping without its samples, for where these stand beside it.
void encode_geometry(const Ping& ping, std::vector<std::uint8_t>& record);
void encode(const TrueMotion& motion, std::vector<std::uint8_t>& record);
void encode(const EchoTruth& echoes, std::vector<std::uint8_t>& record);
void encode(Time time, const Setpoint& setpoint, std::vector<std::uint8_t>& record);

}  // namespace isobath::native
