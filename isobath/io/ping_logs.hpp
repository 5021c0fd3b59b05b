// Logs of Blue Robotics devices. Each is recognised by its first bytes; ping_device.hpp says what becomes of the
// frames.
#pragma once

#include <isobath/io/byte_window.hpp>
#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <memory>

namespace isobath {

/// Ping Viewer's sensor log (.bin): big-endian QDataStream records of a time since the start and the bytes received.
/// A record whose time or length is damaged costs itself; the search goes on at the next time stamp. Throws Error on a
/// header that cannot be right and where no record follows it.
bool looks_like_ping_viewer_log(Bytes head);
std::unique_ptr<Source> open_ping_viewer_log(ByteWindow input, const InputConfig& config);

/// Frames of the ping protocol as they come off the wire, without times: these are made from the range setting.
bool looks_like_ping_stream(Bytes head);
std::unique_ptr<Source> open_ping_stream(ByteWindow input, const InputConfig& config);

/// Messages as the brping library prints them ("ID: 2300 - device_data", "- angle: 150", ...), one value a line. The
/// frame is built again from its text and must agree with the printed checksum. No times: as above.
bool looks_like_ping_messages(Bytes head);
std::unique_ptr<Source> open_ping_messages(ByteWindow input, const InputConfig& config);

/// A table of a Ping360 arc: heading "Angle (gradian)...", then an angle and its intensities a line, separated by ';'
/// or
/// ','. The sample period is not in it: InputConfig::range_m, else 2 m, is taken for the whole range.
bool looks_like_ping360_arc(Bytes head);
std::unique_ptr<Source> open_ping360_arc(ByteWindow input, const InputConfig& config);

}  // namespace isobath
