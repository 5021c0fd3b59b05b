// Logs of Blue Robotics devices. Each format is recognised by its first bytes; ping_device.hpp describes how frames
// become events.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

/// Ping Viewer's sensor log (.bin): big-endian QDataStream records of a time since the start and the bytes received.
/// A record with a damaged time or length loses only itself; reading continues at the next time stamp. Throws Error if
/// the header is impossible or if no record follows it.
bool looks_like_ping_viewer_log(Bytes head);
std::unique_ptr<Source> open_ping_viewer_log(ByteWindow input, const InputConfig& config);

/// Raw frames of the ping protocol without times; times are estimated from the range setting.
bool looks_like_ping_stream(Bytes head);
std::unique_ptr<Source> open_ping_stream(ByteWindow input, const InputConfig& config);

/// Messages as printed by the brping library ("ID: 2300 - device_data", "- angle: 150", ...), one value per line. The
/// reader rebuilds each frame from its text, and the frame must agree with the printed checksum. Times are estimated as
/// above.
bool looks_like_ping_messages(Bytes head);
std::unique_ptr<Source> open_ping_messages(ByteWindow input, const InputConfig& config);

/// A table of a Ping360 arc: heading "Angle (gradian)...", then one angle with its intensities per line, separated by
/// ';' or ','. The table has no sample period: the full range is InputConfig::range_m, else 2 m.
bool looks_like_ping360_arc(Bytes head);
std::unique_ptr<Source> open_ping360_arc(ByteWindow input, const InputConfig& config);

}  // namespace isobath
