// Logs of Kongsberg EM multibeam echo sounders: `.all` (EM datagrams) and `.kmall`; `.wcd` and `.kmwcd` have the same
// framing. Descriptions: Kongsberg 160692 and 410224. survey_track.hpp says how navigation is made of the records,
// kongsberg_water.hpp how pings are made of water columns.
//
// Soundings are Swath::Frame::kLevel: the recorder has taken out motion, ray bending and lever arms. Depth below the
// water line = z + depth of the transmit transducer (.all), z - z_waterLevelReRefPoint (.kmall); heave is within these
// and is not added again. Each datagram of soundings is a Swath of its own: two heads, several fans and several swaths
// of one ping are not joined. Beams without a detection, flagged invalid (.all: detection information) or rejected
// (.kmall: detection type 2), and such that real-time cleaning has flagged, are left out and counted by reason.
// Extra detections of .kmall (type 1) are Sounding::Kind::kWater.
// Water columns are a Ping for each fan of each head, without a second file or with it: `.wcd` and `.kmwcd` are read
// by their times between the records of the log beside them, and of what they hold else only the attitude (.wcd)
// counts, since it repeats the log.
// Attitude is that of the motion sensor: its mounting angles, named in the details, are not taken out.
// Damage costs the datagram in which it lies; checksums (.all) that are wrong are counted, since some recorders write
// them wrong. Errors: none but those of ByteWindow.
#pragma once

#include <isobath/io/byte_window.hpp>
#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <memory>

namespace isobath {

/// Datagrams STX, type, body, ETX, checksum, each behind its length. The byte order is the recorder's: found out from
/// the first datagram. Read: X and D (soundings), P (position of the active system: the reference of the soundings),
/// A and n (attitude of the active sensor), I (water line, lever arms), R (beam width), k (water column), U (noted).
/// Range: from the sounding and the transducer's place in the installation record. Standard deviation, X alone: quality
/// factor / 2500 of the range. The description says 250 sd / range, but that makes 3 % of the depth, ten times what the
/// same sonars state in .kmall and a hundred times the scatter between beams; other software reads 2500, too. A
/// Navigation is at the position reference; its depth is that of the vessel's reference point (heave less water line).
/// Head depth differences of the EM3000D are not known here.
bool looks_like_kongsberg_all(Bytes head);
std::unique_ptr<Source> open_kongsberg_all(ByteWindow input, const InputConfig& config);
std::unique_ptr<Source> open_kongsberg_all_with_water(ByteWindow input, ByteWindow beside, const InputConfig& config);

/// Datagrams with their length in front and behind. Structures state their own sizes and may have grown. Read: #MRZ
/// (soundings, with position and heading of the ping), #SPO (position where no ping states one; quality, velocity),
/// #SKM (attitude), #IIP (water line, lever arms), #MWC (water column), #SVP (noted). A datagram that is a part of
/// several, as the network carries them, is counted and left out. Standard deviation: the vertical uncertainty of the
/// sounding.
bool looks_like_kmall(Bytes head);
std::unique_ptr<Source> open_kmall(ByteWindow input, const InputConfig& config);
std::unique_ptr<Source> open_kmall_with_water(ByteWindow input, ByteWindow beside, const InputConfig& config);

}  // namespace isobath
