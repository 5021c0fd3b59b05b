// NmeaDecoder: converts NMEA 0183 sentences to events, for logs (nmea.hpp) and for live links.
//
// A sentence is "$", talker (2) and type (3), fields, "*", checksum, in up to 256 characters; the last "$" of a line
// begins it. Sentences with a wrong or missing checksum are refused and counted. "!" (AIS) and unused sentences are
// counted in the details. An empty field has no value.
//
// Times of a log: RMC (time and date) and ZDA; GGA, GLL and GNS use the last of these dates, moved by one day where the
// time of day has jumped by over half a day. The clock of the log is the latest such time. It does not run back, unless
// over 20 positions in a row are more than a minute older. Every other sentence gets the time of the clock, which is
// that of the last fix before it: late by up to the interval between fixes. Without dates, days are counted from the
// start (DayClock). Depths before the first time are refused. Times of a live link (Times::kHost): each event has the
// time of its arrival; the detail "clock" states how far the times of day in the sentences are from the host's.
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
// Throws nothing. One thread at a time.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>
#include <string_view>

namespace isobath {

/// The text of a sentence between "$" and the checksum, such as "GPRMC,123519.00,...".
struct NmeaSentence {
  enum class State : std::uint8_t { kNone, kNoChecksum, kWrongChecksum, kOther, kGood };
  State state = State::kNone;  ///< kOther: well-formed, but encapsulated ("!")
  std::string_view body;       ///< between "$" and "*"
};
NmeaSentence sentence_of(std::string_view line);
/// Whether the sentence is a good RMC or ZDA with a date.
bool states_date(const NmeaSentence& sentence);
/// "$", the body, "*", its checksum, CR LF.
std::string nmea_line(std::string_view body);

class NmeaDecoder {
 public:
  enum class Times : std::uint8_t {
    kDated,    ///< of the sentences, with the dates of RMC and ZDA
    kUndated,  ///< of the sentences, from the day of the first
    kHost      ///< of arrival
  };
  /// `report` must outlive this object.
  NmeaDecoder(const InputConfig& config, SourceReport& report, Times times);
  NmeaDecoder(const NmeaDecoder&) = delete;
  NmeaDecoder& operator=(const NmeaDecoder&) = delete;
  ~NmeaDecoder();

  /// `arrival`: only for Times::kHost. A sentence of state kNone gives nothing; the caller counts it as damage.
  std::optional<Event> event(const NmeaSentence& sentence, Time arrival = {});
  /// States in the report how many sentences were not used.
  void count_unused();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
