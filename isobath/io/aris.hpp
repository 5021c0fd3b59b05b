// Recordings of an ARIS imaging sonar (Sound Metrics): a file header, then frames of one size, each a header of 1024
// bytes and beams x samples of 8 bits, row after row from the nearest. After the maker's public description of the
// format (type definitions and "Understanding ARIS Data" of the ARIS File SDK); the beams of a row run from starboard
// to port.
//
// Frame header, little-endian, by offset: 4 u64 microseconds since 1970 of the recorder, 12 u32 signature, 436 u32 ping
// mode (which says the number of beams), 440 u32 high frequency, 448 u32 ping cycle (us), 452 u32 sample period (us),
// 456 u32 transmitter on, 464 f32 sound speed (m/s), 468 u32 samples a beam, 476 u32 delay of the first sample (us),
// 480 u32 telephoto lens, 484 u32 system (1200, 1800, 3000), 516 u32 samples in the order of the beams.
//
// Range of a sample: half the sound speed times its delay; the window that the header states in metres is of another
// sound speed and is not used. Azimuths: a cubic of the beam's number, one for each lens and number of beams, within
// 0.1 degrees of the maker's table of an average lens. Beams are as wide as they are apart. Height: 14 degrees, 3 with
// the telephoto lens; where it matters, configure it. Samples are decibels, 80 dB over 255 counts, as they are.
//
// Nothing is said of the vehicle: there is no navigation in it, compass and depth of the sonar are not used. Damage: a
// frame has no checksum; one whose header contradicts itself is skipped, and the next is found by its signature.
// Errors: throws Error where nothing follows the file header.
#pragma once

#include <isobath/io/byte_window.hpp>
#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <memory>

namespace isobath {

bool looks_like_aris(Bytes head);
std::unique_ptr<Source> open_aris(ByteWindow input, const InputConfig& config);

}  // namespace isobath
