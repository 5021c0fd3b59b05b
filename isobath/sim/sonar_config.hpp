// SonarConfig: one simulated sonar, from a preset or number by number. Echo formation is in echo_former.hpp, what
// happens to the echoes in the receiver in simulated_sonar.hpp; each setting names its unit and its effect.
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

/// How the sonar looks: one stepping beam, all beams at once, or beams that each give one range.
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
  int beams = 128;                    ///< of a fan; a scanning head has one
  Angle sector = Angle::degrees(90);  ///< from the first beam's axis to the last's, or the swept sector
  Angle step = Angle::degrees(3);     ///< of a scanning head
  Angle width = Angle::degrees(1);    ///< of a beam, full, two-way -3 dB
  Angle height = Angle::degrees(20);
  double range_m = 50;
  int bins = 500;
  double resolution_m = 0;               ///< length of the pulse in water, c/2B of a chirp; 0: one bin
  double interval_s = 0;                 ///< between pings; 0: twice the travel time to the range, and 5 ms
  double sound_speed = 1500;             ///< m/s that the device assumes
  Eigen::Vector3d position = {0, 0, 0};  ///< p_BS, m
  Angle heading, pitch, roll;            ///< of S in B; roll 90 degrees stands a fan upright
  SampleType samples = SampleType::kU8;

  PatternKind pattern = PatternKind::kLine, height_pattern = PatternKind::kLine;
  double side_lobe_db = 25;
  int rays = 16;        ///< a beam, over its height
  int rays_across = 1;  ///< a beam of a fan, over its width; a scanning beam has 9 and a skirt

  double source_level_db = 206;  ///< dB re 1 uPa at 1 m
  double saturation_db = 166;    ///< received level after TVG that saturates a sample, dB re 1 uPa
  double tvg_spreading = 30;     ///< dB a decade of range that the receiver makes good
  bool tvg_absorption = true;    ///< whether it makes good absorption
  double span_db = 0;      ///< receivers that compress: samples linear in dB, 0 so far below saturation; 0: amplitude
  double black_level = 0;  ///< counts taken off every sample before that; what is below reads 0
  double ceiling = 0;      ///< largest sample, counts; 0: full scale

  BackgroundLaw noise = BackgroundLaw::kRayleigh;
  double noise_level = 10;               ///< mean, counts
  double noise_sigma = 4;                ///< counts, Gaussian law alone
  double noise_shape = 2;                ///< of the K law; large: Rayleigh
  std::vector<double> noise_by_range;    ///< rows of range (m) and factor
  std::vector<double> noise_by_bearing;  ///< rows of azimuth (deg) and factor
  bool speckle = true;
  bool still = false;                 ///< speckle is the same whenever the sonar looks the same way: nothing moves
  bool correlated = true;             ///< of a fan: neighbouring beams, bins and pings fluctuate together
  std::vector<double> reverberation;  ///< rows of range (m) and mean amplitude (counts): what many bounces leave
  bool surface_reverberation = true, bottom_reverberation = true, volume_reverberation = true;
  bool surface_bounce = true, bottom_bounce = true, body_bounce = false, multiple = false;
  double head_reflection_db = -20;                           ///< of the sonar's own housing, for multiples
  double spurious_share = 0;                                 ///< of pings with one echo of nothing
  double spurious_level = 80;                                ///< counts
  double streak_share = 0, ring_share = 0, burst_share = 0;  ///< of pings: one beam, one range, the whole image
  double disturbance_level = 60;                             ///< counts
  double dropout_share = 0;                                  ///< of pings that never come
  double blind_m = 0.5;                                      ///< the transmission rings up to here
  double ringing_level = 200;                                ///< counts, at the head

  RangePick pick = RangePick::kNearest;  ///< sonars that give ranges
  double pick_level = 60;                ///< counts
};

/// `preset` acts first, then every other key.
std::vector<Field> fields(SonarConfig& config);
std::vector<std::string> sonar_presets();
/// By name; throws Error for one that is not listed.
SonarConfig sonar_preset(const std::string& name);
/// What single fields cannot say: a fan of no beams, a beam wider than ... Throws Error with the place of the sonar.
void check(const SonarConfig& config);

/// As it looks after a command. Throws Error where no such sonar could be (S4-40).
SonarConfig commanded(SonarConfig config, const ScanCommand& command);

inline Pose sensor_pose(const SonarConfig& c) {
  return {Rotation::from_heading_pitch_roll(c.heading, c.pitch, c.roll), c.position};
}

}  // namespace isobath
