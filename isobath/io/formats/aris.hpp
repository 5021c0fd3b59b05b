// ARIS imaging sonar recordings (Sound Metrics).
//
// A file header is followed by frames of equal size. Each frame has a header of 1024 bytes and beams x samples of
// 8 bits, row after row, nearest row first. The beams of a row run from starboard to port. The layout follows the
// maker's public description (type definitions and "Understanding ARIS Data" of the ARIS File SDK).
//
// Frame header, little-endian, by offset: 4 u64 recorder time in microseconds since 1970, 12 u32 signature, 436 u32
// ping mode (sets the number of beams), 440 u32 high frequency, 448 u32 ping cycle (us), 452 u32 sample period (us),
// 456 u32 transmitter on, 464 f32 sound speed (m/s), 468 u32 samples per beam, 476 u32 delay of the first sample (us),
// 480 u32 telephoto lens, 484 u32 system (1200, 1800, 3000), 516 u32 samples are in beam order.
//
// Range of a sample: half the sound speed times its delay. The header also states the window in metres, computed with
// another sound speed; that field is not used. Azimuths follow a cubic in the beam number, one for each lens and number
// of beams; it agrees within 0.1 degrees with the maker's table of an average lens. Beam width equals beam spacing.
// Beam height is 14 degrees, or 3 with the telephoto lens; configure it where it matters. Samples stay in the recorded
// decibel scale, 80 dB over 255 counts.
//
// The source gives no navigation: the sonar's own compass and depth are not used. Frames have no checksum. A frame with
// a contradictory header is skipped, and the next frame is found by its signature.
// Errors: throws Error if nothing follows the file header.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

bool looks_like_aris(Bytes head);
std::unique_ptr<Source> open_aris(ByteWindow input, const InputConfig& config);

}  // namespace isobath
