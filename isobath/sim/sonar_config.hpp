// SonarConfig: one simulated sonar, from a preset or from single settings. echo_synthesizer.hpp describes the formation
// of echoes, simulated_sonar.hpp the receiver. Each setting states its unit and its effect.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/base/config.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/sim/beam_pattern.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/scan_command.hpp>
#include <string>
#include <vector>

namespace isobath {

/// One stepping beam, all beams at once, or beams that each give one range.
enum class SonarKind : std::uint8_t { kScanning, kFan, kRanges };
enum class BackgroundLaw : std::uint8_t { kNone, kGaussian, kRayleigh, kK };
enum class RangePick : std::uint8_t { kNearest, kStrongest };

struct SonarConfig {
  Place place;
  std::string preset = "none";
  std::string name = "sonar";
  SonarKind kind = SonarKind::kFan;
  bool on = true;

  double frequency = 700e3;           ///< Hz
  int beams = 128;                    ///< number of beams of a fan; a scanning head has one
  Angle sector = Angle::degrees(90);  ///< from the first beam's axis to the last's, or the swept sector
  Angle middle;                       ///< azimuth of the middle of the swept sector, in S
  Angle step = Angle::degrees(3);     ///< step of a scanning head
  Angle width = Angle::degrees(1);    ///< width of a beam: full, two-way, at -3 dB
  Angle height = Angle::degrees(20);
  double range_m = 50;
  int bins = 500;
  double resolution_m = 0;               ///< length of the pulse in water (c/2B for a chirp); 0: one bin
  double interval_s = 0;                 ///< between pings; 0: two-way travel time to the range, plus 5 ms
  double sound_speed = 1500;             ///< m/s that the device assumes
  Eigen::Vector3d position = {0, 0, 0};  ///< p_BS, m
  Angle heading, pitch, roll;            ///< attitude of S in B; roll 90 degrees makes a vertical fan
  SampleType samples = SampleType::kU8;

  PatternKind pattern = PatternKind::kLine, height_pattern = PatternKind::kLine;
  double side_lobe_db = 25;
  int rays = 16;        ///< per beam, over its height
  int rays_across = 1;  ///< per beam of a fan, over its width; a scanning beam has 9 and a skirt

  double source_level_db = 206;  ///< dB re 1 uPa at 1 m
  double saturation_db = 166;    ///< received level after TVG that saturates a sample, dB re 1 uPa
  double tvg_spreading = 30;     ///< dB per decade of range that the receiver compensates
  bool tvg_absorption = true;    ///< whether it compensates absorption
  double span_db = 0;      ///< receivers that compress: samples linear in dB, 0 this far below saturation; 0: amplitude
  double black_level = 0;  ///< counts subtracted from each sample before compression; lower samples read 0
  double ceiling = 0;      ///< largest sample, counts; 0: full scale

  BackgroundLaw noise = BackgroundLaw::kRayleigh;
  double noise_level = 10;               ///< mean, counts
  double noise_sigma = 4;                ///< counts; only for the Gaussian law
  double noise_shape = 2;                ///< shape of the K law; large: Rayleigh
  std::vector<double> noise_by_range;    ///< rows of range (m) and factor
  std::vector<double> noise_by_bearing;  ///< rows of azimuth (deg) and factor
  bool speckle = true;
  bool still = false;                 ///< motionless scene: speckle repeats when the sonar points the same way
  bool correlated = true;             ///< fan: neighbouring beams, bins and pings are correlated
  std::vector<double> reverberation;  ///< rows of range (m) and mean amplitude (counts): diffuse field of many bounces
  bool surface_reverberation = true, bottom_reverberation = true, volume_reverberation = true;
  bool surface_bounce = true, bottom_bounce = true, body_bounce = false, multiple = false;
  double head_reflection_db = -20;                           ///< reflection of the sonar's own housing, for multiples
  double spurious_share = 0;                                 ///< share of pings with one false echo
  double spurious_level = 80;                                ///< counts
  double streak_share = 0, ring_share = 0, burst_share = 0;  ///< shares of pings: one beam, one range, whole image
  double disturbance_level = 60;                             ///< counts
  double dropout_share = 0;                                  ///< share of lost pings
  double blanking_m = 0.5;                                   ///< blanking range: the transmit pulse rings up to here
  double ringing_level = 200;                                ///< counts, at the head

  RangePick pick = RangePick::kNearest;  ///< range sonars: the echo that they report
  double pick_level = 60;                ///< counts: minimum level of that echo
};

/// `preset` is applied first, then all other keys.
std::vector<Field> fields(SonarConfig& config);
std::vector<std::string> sonar_presets();
/// A preset by name; throws Error for an unknown name.
SonarConfig sonar_preset(const std::string& name);
constexpr double kLeastPingInterval = 0.001;  ///< s; below it the time of a run would hardly go on
/// Time from ping to ping, s: as configured, else that of the sound to the full range and back.
double ping_interval_s(const SonarConfig& config);
/// Checks that concern several fields. Throws Error with the place of the sonar in the file.
void check(const SonarConfig& config);

/// The command that makes a sonar look as this configuration says.
ScanCommand settings_of(const SonarConfig& config);
/// The configuration after a command, without its `as_configured`. Throws Error for an invalid configuration (S4-40).
SonarConfig commanded(SonarConfig config, const ScanCommand& command);

inline Pose sensor_pose(const SonarConfig& c) {
  return {Rotation::from_heading_pitch_roll(c.heading, c.pitch, c.roll), c.position};
}

}  // namespace isobath
