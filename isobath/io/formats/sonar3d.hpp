// Water Linked Sonar 3D-15 (.sonar): shots of an imaging sonar with 256 x 64 narrow beams ahead, with true elevation.
//
// Packets back to back, little-endian: "RIP2", u32 length of the packet, payload, u32 CRC-32 of all bytes before it.
// The payload is a Snappy block of a protocol-buffer message Packet { 1: Any { 1: type name, 2: message } }. The reader
// uses the type RangeImage:
//   1 header { 1 time { 1 seconds, 2 nanoseconds }, 2 shot }, 2 sound speed m/s, 3 range m, 4 mode, 5 width, 6 height,
//   7 and 8 width and height of view in degrees, 9 metres per count, 10 packed counts, row by row; 0: no echo.
// Other types, such as the image of echo strengths, are counted and skipped.
//
// A shot gives one Swath::Frame::kBody with soundings of Sounding::Kind::kWater: the range to the strongest echo in
// each direction. Column 0 looks to port, row 0 looks up. Yaw and pitch are evenly spaced from edge to edge of the
// view, and the point is r (cos p cos y, cos p sin y, sin p) ahead, to starboard, down. The maker states the outermost
// directions, not the borders of the view. A beam's number is row x width + column. X_BS is InputConfig's
// mount_heading, mount_pitch, mount_roll and mount_m. The file has no pose, attitude or velocity:
// InputConfig::navigation gives them; without it the sonar is taken to be stationary.
//
// Damage is skipped and counted. Images with a wrong size, or an impossible view, scale or time, are refused and
// counted. Throws nothing.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

bool looks_like_sonar3d(Bytes head);
std::unique_ptr<Source> open_sonar3d(ByteWindow input, const InputConfig& config);

}  // namespace isobath
