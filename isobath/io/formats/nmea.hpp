// NMEA 0183 depth tracks: the sentences of a GPS, a compass and an echo sounder on one wire, recorded as text.
//
// Framing: "$", talker (2) and type (3), fields, "*", checksum. Lines end in CR, LF or CR LF and have up to 256
// characters; the last "$" of a line begins its sentence. Sentences with a wrong or missing checksum are refused and
// counted. "!" (AIS) and unused sentences are counted in the details. Other text is damage. An empty field has no
// value.
//
// Time: RMC (time and date) and ZDA; GGA, GLL and GNS use the last of these dates, moved by one day where the time of
// day has jumped by over half a day. The clock of the log is the latest such time. It does not run back, unless over 20
// positions in a row are more than a minute older. Every other sentence gets the time of the clock, which is that of
// the last fix before it: late by up to the interval between fixes. If the first 64 KiB of a log have no date, days are
// counted from its start (DayClock). Depths before the first time are refused.
//
// A Navigation comes from the first valid RMC, GGA, GLL or GNS of each new time (status A; quality not none, manual or
// simulated). More of the same time are counted as repeats, and those older than the clock are refused. Heading: HDT,
// THS or VHW (true); else HDG (with its deviation and variation) or HDM, both magnetic, with
// InputConfig::survey.declination; else the course of RMC or VTG while the speed is over 0.5 m/s, and the last such
// course at lower speeds. A heading older than 5 s gives way to the next kind. Roll and pitch are 0. Velocity: speed
// and course. Position accuracy: GST, else position_sigma_m.
//
// A RangeReading comes from one kind of depth sentence of one talker, the first that holds a depth: DPT, DBT (metres)
// or DBS. Others are counted. A positive offset in DPT is the depth of the transducer, unless
// InputConfig::survey.transducer_depth_m is set. The range of a DBS is its depth less the transducer depth. A depth of
// 0 or an empty depth means "no bottom": it is counted and gives no reading (ledger S1-64). The beam is not known: its
// width is 7 degrees, as of a common 200 kHz survey transducer, unless InputConfig::beam_width sets it.
//
// Throws nothing. Checked on 22 minutes of a sailing boat (OpenCPN, Hakefjord.log): 7528 DPT give 7528 readings. That
// file holds the same recording four times over, so its times step back three times; after 20 positions the clock
// follows.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

/// Whether most of the first lines are sentences with a right checksum.
bool looks_like_nmea(Bytes head);
std::unique_ptr<Source> open_nmea(ByteWindow input, const InputConfig& config);

/// The text of a sentence between "$" and the checksum, such as "GPRMC,123519.00,...".
struct NmeaSentence {
  enum class State : std::uint8_t { kNone, kNoChecksum, kWrongChecksum, kOther, kGood };
  State state = State::kNone;  ///< kOther: well-formed, but encapsulated ("!")
  std::string_view body;       ///< between "$" and "*"
};
NmeaSentence sentence_of(std::string_view line);

}  // namespace isobath
