// MAVLink telemetry logs (.tlog) of ground stations: a big-endian time in microseconds since 1970 before each frame.
//
// The vehicle is the system of InputConfig::mavlink_system, else the first that states its attitude or position. Read
// are its messages
//   ATTITUDE                               attitude, from which each Navigation comes (navigation_parts.hpp)
//   LOCAL_POSITION_NED                     position, velocity and depth; GPS_GLOBAL_ORIGIN ties it to the globe
//   GLOBAL_POSITION_INT                    the same, in a log that does not begin with LOCAL_POSITION_NED
//   SCALED_PRESSURE2, else SCALED_PRESSURE depth, in a log whose positions state none
//   DISTANCE_SENSOR, else RANGEFINDER      a RangeReading along the orientation that the message states (RANGEFINDER:
//                                          down), at the origin of the body and moved by InputConfig::mount_m
// A distance at or above the stated maximum is no echo. The beam is hfov wide, else 25 degrees as of a Ping1D, unless
// InputConfig::beam_width sets it. Times are those at which the ground station received a frame: late by the delay of
// the link. VISION_POSITION_DELTA is counted, not used: it moves the positions that the autopilot states.
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
