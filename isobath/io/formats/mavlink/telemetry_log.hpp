// MAVLink telemetry logs (.tlog) of ground stations: a big-endian time in microseconds since 1970 before each frame.
//
// The vehicle is the system of InputConfig::mavlink_system, else the first that states its attitude or position;
// mavlink_vehicle.hpp says which of its messages are read. VISION_POSITION_DELTA is counted, not used: it moves the
// positions that the autopilot states.
//
// The report counts the messages by name. A frame with a wrong checksum among others is counted as rejected, and costs
// only itself; other bytes are damage. Frames of unknown messages have no checksum that could be tested: they are
// passed over where a frame follows. Throws nothing.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

bool looks_like_telemetry_log(Bytes head);
std::unique_ptr<Source> open_telemetry_log(ByteWindow input, const InputConfig& config);

}  // namespace isobath
