// XTF (eXtended Triton Format, Triton Imaging, revision 40): attitude (packet 3), raw position (107) and bathymetry of
// R2Sonic heads (65). Packets of other types are counted by type and skipped. survey_track.hpp describes how navigation
// is made from the records.
//
// Soundings are Swath::Frame::kBody: range = two-way time x recorded sound speed / 2 at the recorded angle, athwart
// (port negative), without correction for ray bending. X_BS is InputConfig's mount_heading, mount_pitch, mount_roll and
// mount_m, since the log has no lever arms. Points without a detection (neither phase nor magnitude flag, or no range)
// are left out and counted. Attitude in degrees: pitch nose up, roll starboard down, heave positive up, heading.
// The attitude packet: u16 magic, u8 type, u8 channel, u16, 2 x u16, u32 bytes, 2 x u32, u32 microseconds, u32 epoch,
// f32 pitch (byte 30), roll (34), heave (38), yaw (42), u32 time tag, f32 heading (50), then date and time (54). On the
// survey line of San Francisco Bay, this roll reduces the tilt of the bottom between pings from 1.7 to 0.15 degrees.
// Errors: throws Error if nothing follows the file header.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

bool looks_like_xtf(Bytes head);
std::unique_ptr<Source> open_xtf(ByteWindow input, const InputConfig& config);

}  // namespace isobath
