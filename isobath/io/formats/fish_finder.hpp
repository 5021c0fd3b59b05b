// Recordings of fish finders: Lowrance .sl2 and Humminbird .SON, as soundings with the position of the boat.
//
// Lowrance .sl2, little-endian: a head of 8 bytes (format 2, version, block size, 0), then frames. A frame states its
// own offset in the file, its length, channel, limits, depth (feet), speed (knots), easting and northing (spherical
// Mercator, radius 6356752.3142 m), track and heading (radians), and the milliseconds since the recorder was switched
// on; echoes follow. Read is the primary channel; where the first 256 KiB have none, the first channel that they have.
// Humminbird .SON, big-endian: pings that begin with C0 DE AB 21 and hold values with a tag of one byte each: record
// number, milliseconds, easting and northing (Mercator with radius 6378388 m on the latitude of the International
// ellipsoid), heading, speed, depth (0.1 m), frequency, then the echoes. Each .SON is one channel. A single .DAT of 64
// bytes in its folder states when the recording began; without it times begin at zero. .IDX is not needed.
//
// A sounding is the depth that the device itself picked: a RangeReading below a transducer at
// SurveyInput::transducer_depth_m, 20 degrees wide unless InputConfig::beam_width sets it. A depth of 0 means "no
// bottom": it is counted, not read. A Navigation comes where the position changes, since devices repeat it until the
// next fix; its heading is the device's, else its track. The echoes themselves are not read.
//
// Damage is skipped and counted. A last frame that is cut off within its echoes still gives its sounding. Throws
// nothing. Checked on a river (1726 pings of 83 kHz, 1.0 to 6.6 m) and a lake (112 frames of the primary channel).
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

bool looks_like_lowrance(Bytes head);
std::unique_ptr<Source> open_lowrance(ByteWindow input, const InputConfig& config);

bool looks_like_humminbird(Bytes head);
/// `start`: when the recording began.
std::unique_ptr<Source> open_humminbird(ByteWindow input, const InputConfig& config, Time start = {});
std::unique_ptr<Source> open_humminbird_file(const std::filesystem::path& file, const InputConfig& config);

}  // namespace isobath
