// Water columns of Kongsberg EM echo sounders (#MWC of .kmall and .kmwcd, k of .all and .wcd), as pings of a vertical
// fan athwart the vehicle. Descriptions: Kongsberg 410224 and 160692.
//
// Frames. x_S points down, y_S to starboard. The azimuth of a beam is its angle off the vertical, positive to starboard
// (the records count to port). The recorder has removed the roll from these angles, so X_BS holds the mounting alone,
// and SurveyTrack compensates it for the roll at the time of the ping. The fan lies in the plane of the transmit array:
// the array's heading turns it, and the array's pitch and the tilt of the transmit sectors, averaged over the beams,
// tilt it forward, or the other way for an array that is mounted backwards. Differences of tilt between sectors are
// added to the beam height.
// Measured: without a correction for ray bending, the detected range of a beam is within 0.05 m of the sonar's own
// sounding across the track (harbour, 8 m deep). The tilt is within 0.1 degrees of that of the soundings if the array
// looks forward, and up to 0.6 degrees off in EM 2042 recordings with a backward array.
//
// Ranges: sample i is at i times sound speed over twice the sample rate, in the middle of its bin. Beams that begin and
// end at different samples share one window; Ping::sampled states which bins each beam has. To let pings of one setting
// share fan and window, the length of a bin is kept while it differs by less than kSameBin, a fan while no beam moves
// by kSameAngle, and the number of bins is rounded up to a multiple of kBinStep.
//
// Intensities: the record's half decibels as amplitude, 10^(dB / 20); full scale is the largest value that the record
// can state. The time-varying gain (TVG) that the sonar has applied is not removed.
#pragma once

#include <array>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/sonar/ping.hpp>
#include <string>
#include <vector>

namespace isobath {

/// Width of a beam along and across the track, where no record states it.
constexpr Angle kWaterBeam = Angle::degrees(1.5);

/// "256 beams, half decibels, with a gain of 30 log r + 30 dB"
std::string water_setting(int gain, int offset_db, std::size_t beams);

/// A beam as recorded.
struct WaterBeam {
  double to_port_deg;  ///< off the vertical
  std::size_t first;   ///< number of its first sample
  Bytes samples;       ///< half decibels, signed
  double tilt_deg;     ///< tilt of its transmit sector, forward
};

/// Position and orientation of a transducer, from the installation record.
struct WaterMount {
  Eigen::Vector3d p_BS = Eigen::Vector3d::Zero();
  double heading_deg = 0, pitch_deg = 0;  ///< orientation of the transmit array
};

struct WaterRecord {
  Time time;
  double sample_hz = 0;
  double sound_speed = 0;  ///< m/s
  WaterMount mount;
  Angle width, height;  ///< of a beam, across and along the track
  std::vector<WaterBeam> beams;
};

/// Why a record gives no ping.
enum class WaterFault : std::uint8_t { kNoSamples, kBadRate, kBadSoundSpeed, kBadSizes, kBadBeams };
const char* to_text(WaterFault fault);

/// Makes pings from records. A sonar may alternate between several fans and windows. One thread at a time.
class WaterPings {
 public:
  static constexpr double kSameBin = 5e-4;  ///< share of its length
  static constexpr Angle kSameAngle = Angle::degrees(0.05);
  static constexpr int kBinStep = 128;

  /// A ping that passes check(). X_BS holds for a vehicle without roll.
  Result<Ping, WaterFault> ping(const WaterRecord& record);

 private:
  static constexpr std::size_t kKept = 16;  ///< fans and bin lengths that are kept; more than a survey uses
  void take_samples(const WaterRecord& record, std::size_t first, Ping& ping);
  std::shared_ptr<const BeamFan> fan_of(const WaterRecord& record, Angle height);
  double bin_of(double exact_m);

  std::vector<std::shared_ptr<const BeamFan>> fans_;
  std::vector<double> bins_m_;
  SampleArena arena_;
};

}  // namespace isobath
