// The water columns of Kongsberg EM echo sounders (#MWC of .kmall and .kmwcd, k of .all and .wcd), as pings of a fan
// that stands upright athwart the vehicle. Descriptions: Kongsberg 410224 and 160692.
//
// Frames. x_S points down, y_S to starboard; the azimuth of a beam is its angle off the vertical to starboard (the
// records count to port). The records give these angles with the roll taken out, so that X_BS holds the mounting alone
// and SurveyTrack takes the roll of the ping's time out of it. The fan's plane is that of the transmit array: turned by
// its heading, tilted forward by its pitch and by the tilt of its transmit sectors, the mean over the beams; an array
// that is mounted backwards tilts the other way. What the sectors differ by counts as height of the beams.
// Measured: without rays being bent a beam's detected range lands within 0.05 m of the sonar's own sounding across the
// track (harbour, 8 m deep) and the tilt within 0.1 degrees of that of the soundings where the array looks ahead;
// of EM 2042 recordings with a backward one up to 0.6 degrees off.
//
// Ranges: sample i is at i times sound speed over twice the sample rate, and in the middle of its bin. Beams that begin
// and end at different samples share one window; Ping::sampled says which bins are whose. So that pings of one setting
// share fan and window, the length of a bin is kept while it differs by less than kSameBin, a fan while no beam moves
// by kSameAngle, and the number of bins is a multiple of kBinStep.
//
// Intensities: the record's half decibels as amplitude, 10^(dB / 20), full scale at the largest that it can say. The
// gain that the sonar has applied (TVG) is left in.
#pragma once

#include <array>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes.hpp>
#include <isobath/io/sample_arena.hpp>
#include <isobath/sonar/ping.hpp>
#include <string>
#include <vector>

namespace isobath {

/// Of a beam along the track and across it, where no record states one.
constexpr Angle kWaterBeam = Angle::degrees(1.5);

/// "256 beams, half decibels, with a gain of 30 log r + 30 dB"
std::string water_setting(int gain, int offset_db, std::size_t beams);

/// A beam as its record has it.
struct WaterBeam {
  double to_port_deg;  ///< off the vertical
  std::size_t first;   ///< number of its first sample
  Bytes samples;       ///< half decibels, signed
  double tilt_deg;     ///< of its transmit sector, forward
};

/// Where a transducer is and how it is turned, of the installation record.
struct WaterMount {
  Eigen::Vector3d p_BS = Eigen::Vector3d::Zero();
  double heading_deg = 0, pitch_deg = 0;  ///< of the transmit array
};

struct WaterRecord {
  Time time;
  double sample_hz = 0;
  double sound_speed = 0;  ///< m/s
  WaterMount mount;
  Angle width, height;  ///< of a beam across and along
  std::vector<WaterBeam> beams;
};

/// Why a record gives no ping.
enum class WaterFault : std::uint8_t { kNoSamples, kBadRate, kBadSoundSpeed, kBadSizes, kBadBeams };
const char* to_text(WaterFault fault);

/// Makes pings of records. One sonar may have several fans and windows in turn. Not for several threads.
class WaterPings {
 public:
  static constexpr double kSameBin = 5e-4;  ///< of its length
  static constexpr Angle kSameAngle = Angle::degrees(0.05);
  static constexpr int kBinStep = 128;

  /// A ping that passes check. X_BS is that of a vehicle without roll.
  Result<Ping, WaterFault> ping(const WaterRecord& record);

 private:
  static constexpr std::size_t kKept = 16;  ///< of fans and of lengths: more settings than a survey turns between
  void take_samples(const WaterRecord& record, std::size_t first, Ping& ping);
  std::shared_ptr<const BeamFan> fan_of(const WaterRecord& record, Angle height);
  double bin_of(double exact_m);

  std::vector<std::shared_ptr<const BeamFan>> fans_;
  std::vector<double> bins_m_;
  SampleArena arena_;
};

}  // namespace isobath
