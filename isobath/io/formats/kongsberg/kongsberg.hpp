// Logs of Kongsberg EM multibeam echo sounders: `.all` (EM datagrams) and `.kmall`. `.wcd` and `.kmwcd` files have the
// same framing. Descriptions: Kongsberg 160692 and 410224. survey_track.hpp describes how navigation is made from the
// records, kongsberg_water.hpp how pings are made from water columns.
//
// Soundings are Swath::Frame::kLevel: the recorder has already removed motion, ray bending and lever arms. Depth below
// the water line = z + depth of the transmit transducer (.all), z - z_waterLevelReRefPoint (.kmall). These include
// heave, which is not added again. Each sounding datagram is a separate Swath: two heads, several fans and several
// swaths of one ping are not joined. Beams are left out and counted by reason if they have no detection, are flagged
// invalid (.all: detection information), are rejected (.kmall: detection type 2), or are flagged by real-time cleaning.
// Extra detections of .kmall (type 1) are Sounding::Kind::kWater.
// Water columns give one Ping for each fan of each head, from the log alone or with a second file. `.wcd` and `.kmwcd`
// are read together with the log beside them, merged by time. From the second file, only water columns and the attitude
// (.wcd) are used, since the rest repeats the log.
// Attitude is that of the motion sensor. Its mounting angles are in the details and are not removed.
// A damaged stretch loses the datagrams in it. Wrong checksums (.all) are only counted, since some recorders write them
// wrong. Errors: only those of ByteWindow.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

/// Datagrams are length, STX, type, body, ETX, checksum. The byte order is that of the recorder, detected from the
/// first datagram. Read are X and D (soundings), P (position of the active system, the reference of the soundings),
/// A and n (attitude of the active sensor), I (water line, lever arms), R (beam width) and k (water column); U (sound
/// speed profile) is only noted in the details. Range: from the sounding and the transducer's position in the
/// installation record. Standard deviation, in X only: quality factor / 2500 of the range. The description says
/// 250 sd / range, but that makes 3 % of the depth, ten times what the same sonars state in .kmall and a hundred times
/// the scatter between beams; other software also uses 2500. A Navigation is at the position reference; its depth is
/// that of the vessel's reference point (heave less water line). Head depth differences of the EM3000D are not applied.
bool looks_like_kongsberg_all(Bytes head);
std::unique_ptr<Source> open_kongsberg_all(ByteWindow input, const InputConfig& config);
std::unique_ptr<Source> open_kongsberg_all_with_water(ByteWindow input, ByteWindow beside, const InputConfig& config);

/// Datagrams have their length at both ends. Structures state their own sizes and may have grown. Read are #MRZ
/// (soundings, with position and heading of the ping), #SPO (position where no ping states one; quality, velocity),
/// #SKM (attitude), #IIP (water line, lever arms) and #MWC (water column); #SVP (sound speed profile) is only noted in
/// the details. A datagram divided into several parts, as sent over the network, is counted and left out. Standard
/// deviation: the vertical uncertainty of the sounding.
bool looks_like_kmall(Bytes head);
std::unique_ptr<Source> open_kmall(ByteWindow input, const InputConfig& config);
std::unique_ptr<Source> open_kmall_with_water(ByteWindow input, ByteWindow beside, const InputConfig& config);

}  // namespace isobath
