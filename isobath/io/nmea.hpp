// NMEA 0183 depth tracks: the sentences of a GPS, a compass and an echo sounder as they stood on one wire, as text.
//
// Framing: "$", talker (2) and type (3), fields, "*", checksum; lines end in CR, LF or CR LF, up to 256 characters; the
// last "$" of a line begins its sentence. Sentences whose checksum is wrong or absent are refused and counted; "!"
// (AIS) and sentences that say nothing here are counted in the details; other text is damage. An empty field is no
// value.
//
// Time: RMC (time and date), ZDA, and GGA, GLL, GNS with the date of the last of these, a day on where their time falls
// back by half a day. The clock of the log is the latest such time and does not run back, unless 20 positions in a row
// are over a minute older. Every other sentence happens at the clock, that is, at the last fix before it: late by up to
// the interval between fixes. A log whose first 64 KiB have no date counts days from its start (DayClock); sentences
// before the first time are refused.
//
// A Navigation comes from the first RMC, GGA, GLL or GNS of each new time that is valid (status A; quality not none,
// manual or simulated); more of the same time are repeats, and those older than the clock are refused. Heading: HDT,
// THS or VHW (true); else HDG (with its deviation and variation) or HDM, both magnetic, with
// InputConfig::survey.declination; else the course of RMC or VTG while the speed is over 0.5 m/s, and the last one
// below it. A heading older than 5 s gives way to the next kind. Roll and pitch are 0. Velocity: speed and course.
// Position accuracy: GST, else position_sigma_m.
//
// A RangeReading comes from one kind of depth sentence of one talker, the first that holds a depth: DPT, DBT (metres)
// or DBS; others are counted. DPT's positive offset is the depth of the transducer, unless
// InputConfig::survey.transducer_depth_m is set; DBS less that depth is the range. A depth of 0 or none is "no bottom":
// counted, and no reading (ledger S1-64).  The beam is not known: 7
// degrees, as of a common 200 kHz survey transducer, unless InputConfig::beam_width says otherwise.
//
// Throws nothing. Checked on 22 minutes of a sailing boat (OpenCPN, Hakefjord.log): 7528 DPT give 7528 readings. That
// file holds the same recording four times over, so its times step back three times; after 20 positions they are
// followed.
#pragma once

#include <isobath/io/byte_window.hpp>
#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <memory>

namespace isobath {

/// Text of which most of the first lines are sentences with a right checksum.
bool looks_like_nmea(Bytes head);
std::unique_ptr<Source> open_nmea(ByteWindow input, const InputConfig& config);

/// The words of a sentence, without "$" and checksum: "GPRMC", "123519.00", ...
struct NmeaSentence {
  enum class State : std::uint8_t { kNone, kNoChecksum, kWrongChecksum, kOther, kGood };
  State state = State::kNone;  ///< kOther: well-formed, but encapsulated ("!")
  std::string_view body;       ///< between "$" and "*"
};
NmeaSentence sentence_of(std::string_view line);

}  // namespace isobath
