#include <cmath>
#include <isobath/sim/sonar_config.hpp>
#include <map>

namespace isobath {
namespace {

// Scanning heads ----------------------------------------------------------------------------------------------------

// Ganesan 2015, 1.2 and 4.1 (S6-01): Tritech Micron, chirp 650 to 750 kHz, 3 x 35 degrees, 90 degree sector, 44 bins to
// 50 m, 9 of them in the ringing; Gaussian background (S6-D01). Source level after the data sheet of its class.
SonarConfig micron() {
  SonarConfig c;
  c.kind = SonarKind::kScanning;
  c.frequency = 700e3;
  c.sector = Angle::degrees(90);
  c.step = Angle::degrees(3);
  c.width = Angle::degrees(3);
  c.height = Angle::degrees(35);
  c.range_m = 50;
  c.bins = 44;
  c.interval_s = 0.1;
  c.source_level_db = 206;
  c.saturation_db = 185;
  c.tvg_spreading = 30;
  c.noise = BackgroundLaw::kGaussian;
  c.noise_level = 40;
  c.noise_sigma = 12;
  c.spurious_share = 0.02;
  c.blanking_m = 9 * 50.0 / 44;
  c.ringing_level = 220;
  return c;
}

// Blue Robotics Ping360 data sheet: 750 kHz, 2 x 25 degrees, whole turn in steps of 0.9 degrees.
SonarConfig ping360() {
  SonarConfig c = micron();
  c.frequency = 750e3;
  c.sector = Angle::degrees(360);
  c.step = Angle::degrees(0.9);
  c.width = Angle::degrees(2);
  c.height = Angle::degrees(25);
  c.range_m = 20;
  c.bins = 500;
  c.resolution_m = 0.08;
  c.interval_s = 0.035;
  c.noise = BackgroundLaw::kRayleigh;
  c.noise_level = 12;
  c.blanking_m = 0.75;
  return c;
}

// Fans --------------------------------------------------------------------------------------------------------------

// Blueprint Subsea Oculus M1200d data sheet, low frequency: 1.2 MHz, 130 degrees, 512 beams, 0.6 degrees, 20 degrees.
SonarConfig oculus_m1200d() {
  SonarConfig c;
  c.frequency = 1.2e6;
  c.beams = 512;
  c.sector = Angle::degrees(130);
  c.width = Angle::degrees(0.6);
  c.height = Angle::degrees(20);
  c.range_m = 40;
  c.bins = 500;
  c.interval_s = 0.1;
  c.saturation_db = 166;
  return c;
}
SonarConfig oculus_m1200d_high() {
  SonarConfig c = oculus_m1200d();
  c.frequency = 2.1e6;
  c.sector = Angle::degrees(60);
  c.width = Angle::degrees(0.4);
  c.height = Angle::degrees(12);
  c.range_m = 10;
  return c;
}

// Blueprint Subsea Oculus M750d data sheet, low frequency: 750 kHz, 130 degrees, 512 beams, 1 degree, 20 degrees. The
// maximum range is 120 m, at 6 pings per second by travel time; here 60 m at 10 per second. Levels as for the M1200d.
SonarConfig oculus_m750d() {
  SonarConfig c = oculus_m1200d();
  c.frequency = 750e3;
  c.width = Angle::degrees(1);
  c.range_m = 60;
  return c;
}

// Horner et al. c. 2009, 2.2 and 3 (S5-03 to S5-08): 450 kHz, 1 degree, 2 inches; 15 degrees across the image plane,
// which is a top hat (S5-05). The vertical head looks 5 degrees down.
SonarConfig p450_horizontal() {
  SonarConfig c;
  c.frequency = 450e3;
  c.beams = 181;
  c.sector = Angle::degrees(90);
  c.width = Angle::degrees(1);
  c.height = Angle::degrees(15);
  c.height_pattern = PatternKind::kIdeal;
  c.range_m = 90;
  c.bins = 900;
  c.resolution_m = 0.0508;
  c.interval_s = 0.5;
  c.source_level_db = 210;
  c.saturation_db = 172;
  c.noise_level = 8;
  c.noise_by_bearing = {-45, 1.4, -23, 0.9, -22, 1.2, 0, 0.8, 1, 1.1, 22, 0.8, 23, 1.2, 45, 1.3};  // four staves
  return c;
}
SonarConfig p450_vertical() {
  SonarConfig c = p450_horizontal();
  c.beams = 93;
  c.sector = Angle::degrees(46);
  c.pitch = Angle::degrees(-5);
  c.roll = Angle::degrees(90);
  c.noise_by_bearing = {-23, 1.3, -1, 0.9, 1, 1.2, 23, 1.2};  // two staves
  return c;
}

// Sound Metrics DIDSON data sheet, high frequency: 1.8 MHz, 96 beams of 0.3 degrees over 28.8 degrees, 14 degrees tall.
SonarConfig didson() {
  SonarConfig c;
  c.frequency = 1.8e6;
  c.beams = 96;
  c.sector = Angle::degrees(28.5);
  c.width = Angle::degrees(0.4);
  c.height = Angle::degrees(14);
  c.range_m = 11.25;
  c.bins = 640;
  c.interval_s = 0.2;
  c.noise_level = 8;
  return c;
}

// Ranges ------------------------------------------------------------------------------------------------------------

// Blue Robotics Ping data sheet: 115 kHz, 30 degrees; points down.
SonarConfig altimeter() {
  SonarConfig c;
  c.kind = SonarKind::kRanges;
  c.frequency = 115e3;
  c.beams = 1;
  c.sector = Angle{};
  c.width = c.height = Angle::degrees(30);
  c.pitch = Angle::degrees(-90);
  c.range_m = 100;
  c.bins = 1000;
  c.interval_s = 0.2;
  c.source_level_db = 200;
  c.saturation_db = 140;
  c.pick = RangePick::kStrongest;
  return c;
}

// Oskard, Hong, Shaffer 1990 (S1-56): a narrow cone of about 10 degrees that points ahead, one reading per 0.6 s. One
// transducer transmits and receives. The receiver compensates both ways, so that a sample states the target strength:
// -15 dB saturates, pick_level is -28 dB. Suite ranges-low depends on it: with saturation at -20 to -5 dB none of 40
// runs collided, at 0 and at 6 dB 4, at 12 dB 8 (seeds from 1, currents up to 0.25 m/s); of 300 runs (from 50001, up to
// 0.5 m/s) 1 at -10 dB, none at -15 dB.
SonarConfig obstacle_cone() {
  SonarConfig c = altimeter();
  c.frequency = 200e3;
  c.pattern = c.height_pattern = PatternKind::kPiston;
  c.width = c.height = Angle::degrees(10);
  c.tvg_spreading = 40;
  c.saturation_db = 185;
  c.pitch = Angle{};
  c.range_m = 60;
  c.bins = 600;
  c.interval_s = 0.6;
  c.pick = RangePick::kNearest;
  return c;
}

// R2Sonic 2022 class: 400 kHz, 256 beams of 1 x 1 degrees over 120 degrees, across track, pointing down.
SonarConfig multibeam_echo_sounder() {
  SonarConfig c = altimeter();
  c.frequency = 400e3;
  c.beams = 256;
  c.sector = Angle::degrees(120);
  c.width = c.height = Angle::degrees(1);
  c.pitch = Angle::degrees(-90);  // azimuth 0 points down, the first beam to port
  c.range_m = 100;
  c.bins = 2000;
  c.rays = 4;
  c.source_level_db = 220;
  c.saturation_db = 158;
  c.interval_s = 0.25;
  return c;
}

const std::map<std::string, SonarConfig (*)()>& presets() {
  static const std::map<std::string, SonarConfig (*)()> kPresets{
      {"none", [] { return SonarConfig{}; }},
      {"micron", micron},
      {"ping360", ping360},
      {"oculus_m750d", oculus_m750d},
      {"oculus_m1200d", oculus_m1200d},
      {"oculus_m1200d_high", oculus_m1200d_high},
      {"p450_horizontal", p450_horizontal},
      {"p450_vertical", p450_vertical},
      {"didson", didson},
      {"altimeter", altimeter},
      {"obstacle_cone", obstacle_cone},
      {"multibeam_echo_sounder", multibeam_echo_sounder},
  };
  return kPresets;
}

}  // namespace

std::vector<std::string> sonar_presets() {
  std::vector<std::string> names;
  for (const auto& [name, make] : presets()) names.push_back(name);
  return names;
}

SonarConfig sonar_preset(const std::string& name) {
  const auto found = presets().find(name);
  if (found == presets().end()) throw Error("unknown preset: " + name);
  SonarConfig config = found->second();
  config.preset = name;
  return config;
}

std::vector<Field> fields(SonarConfig& c) {
  // One entry per setting.
  using P = PatternKind;
  const auto apply = [&c] {
    SonarConfig preset = sonar_preset(c.preset);
    preset.place = c.place;
    preset.name = c.name;
    c = std::move(preset);
  };
  const std::vector<std::pair<std::string, P>> patterns{
      {"line", P::kLine}, {"piston", P::kPiston}, {"gaussian", P::kGaussian}, {"ideal", P::kIdeal}};
  return {
      Field::named("preset", &c.preset, sonar_presets(), apply,
                   "Device to start from; the other keys override its settings."),
      Field::text("name", &c.name, "Name of the sonar in logs."),
      Field::choice("kind", &c.kind,
                    {{"scanning", SonarKind::kScanning}, {"fan", SonarKind::kFan}, {"ranges", SonarKind::kRanges}},
                    "One stepping beam, all beams at once, or beams that each give one range."),
      Field::flag("on", &c.on, "Whether the sonar pings."),
      Field::real("frequency", &c.frequency, {1e3, 5e6}, "Hz", "Centre frequency."),
      Field::integer("beams", &c.beams, {1, 4096}, "", "Beams of a fan."),
      Field::degrees("sector_deg", &c.sector, {0, 360},
                     "Angle from the first beam's axis to the last's, or the swept sector."),
      Field::degrees("middle_deg", &c.middle, {-180, 180}, "Azimuth of the middle of the sector of a scanning head."),
      Field::degrees("step_deg", &c.step, {0.05, 30}, "Step of a scanning head."),
      Field::degrees("width_deg", &c.width, {0.05, 120}, "Width of a beam in azimuth: full, two-way, at -3 dB."),
      Field::degrees("height_deg", &c.height, {0.05, 120}, "Height of a beam in elevation: full, two-way, at -3 dB."),
      Field::real("range_m", &c.range_m, {0.1, 2000}, "m", "Maximum range."),
      Field::integer("bins", &c.bins, {1, 20000}, "", "Number of range bins."),
      Field::real("resolution_m", &c.resolution_m, {0, 100}, "m", "Length of the pulse in water, c/2B; 0: one bin."),
      Field::real("interval_s", &c.interval_s, {0, 60}, "s",
                  "Time between pings; 0: two-way travel time to the range plus 5 ms."),
      Field::real("sound_speed", &c.sound_speed, {1300, 1700}, "m/s", "Speed of sound that the device assumes."),
      Field::numbers("position", c.position.data(), 3, {-100, 100}, "m",
                     "Position of the sonar in the body: forward, starboard, down."),
      Field::degrees("heading_deg", &c.heading, {-360, 360}, "Heading of the sonar in the body, to starboard."),
      Field::degrees("pitch_deg", &c.pitch, {-90, 90}, "Pitch of the sonar in the body, upwards; -90 points down."),
      Field::degrees("roll_deg", &c.roll, {-180, 180}, "Roll of the sonar in the body; 90 makes a vertical fan."),
      Field::choice("samples", &c.samples,
                    {{"u8", SampleType::kU8}, {"u16", SampleType::kU16}, {"f32", SampleType::kF32}},
                    "Data type of the samples."),
      Field::choice("pattern", &c.pattern, patterns, "Beam pattern in azimuth."),
      Field::choice("height_pattern", &c.height_pattern, patterns, "Beam pattern in elevation."),
      Field::real("side_lobe_db", &c.side_lobe_db, {13.3, 60}, "dB",
                  "Level of the first side lobe below the axis, two-way."),
      Field::integer("rays", &c.rays, {1, 512}, "", "Rays over the height of a beam."),
      Field::integer("rays_across", &c.rays_across, {1, 16}, "", "Rays over the width of a fan's beam."),
      Field::real("source_level_db", &c.source_level_db, {100, 260}, "dB re 1 uPa at 1 m", "Source level."),
      Field::real("saturation_db", &c.saturation_db, {0, 260}, "dB re 1 uPa",
                  "Level after TVG that saturates a sample."),
      Field::real("tvg_spreading", &c.tvg_spreading, {0, 60}, "dB a decade",
                  "Spreading that the receiver compensates, per decade of range."),
      Field::flag("tvg_absorption", &c.tvg_absorption, "Whether the receiver compensates absorption."),
      Field::real("span_db", &c.span_db, {0, 200}, "dB",
                  "Receivers that compress: samples are linear in dB and 0 at this span below saturation; 0: linear "
                  "amplitude."),
      Field::real("black_level", &c.black_level, {0, 1e6}, "counts",
                  "Subtracted from each sample before compression; lower samples read 0."),
      Field::real("ceiling", &c.ceiling, {0, 1e6}, "counts", "Largest sample; 0: full scale."),
      Field::choice("noise", &c.noise,
                    {{"none", BackgroundLaw::kNone},
                     {"gaussian", BackgroundLaw::kGaussian},
                     {"rayleigh", BackgroundLaw::kRayleigh},
                     {"k", BackgroundLaw::kK}},
                    "Distribution of the background."),
      Field::real("noise_level", &c.noise_level, {0, 1e6}, "counts", "Mean of the background."),
      Field::real("noise_sigma", &c.noise_sigma, {0, 1e6}, "counts", "Spread of a Gaussian background."),
      Field::real("noise_shape", &c.noise_shape, {0.05, 1000}, "1", "Shape of a K background; small: spiky."),
      Field::rows("noise_by_range", &c.noise_by_range, 2, {0, 1e6}, "m, 1", "Factor on the background by range."),
      Field::rows("noise_by_bearing", &c.noise_by_bearing, 2, {-360, 1e6}, "deg, 1",
                  "Factor on the background by azimuth."),
      Field::flag("speckle", &c.speckle, "Whether echoes of rough surfaces fluctuate."),
      Field::flag("still", &c.still,
                  "A motionless scene: speckle repeats when the sonar points in the same direction."),
      Field::flag("correlated", &c.correlated,
                  "Samples of a fan are correlated as far as beams overlap and pings share the same water; false: "
                  "independent."),
      Field::rows(
          "reverberation", &c.reverberation, 2, {0, 1e6}, "m, counts",
          "Diffuse field of many bounces in a basin: mean amplitude by range, in addition to the traced paths."),
      Field::flag("surface_reverberation", &c.surface_reverberation, "Echoes of the rough sea surface."),
      Field::flag("bottom_reverberation", &c.bottom_reverberation, "Echoes of the bottom."),
      Field::flag("volume_reverberation", &c.volume_reverberation, "Echoes of the water itself."),
      Field::flag("surface_bounce", &c.surface_bounce, "Paths with one or two bounces off the surface."),
      Field::flag("bottom_bounce", &c.bottom_bounce, "Paths with one or two bounces off the bottom."),
      Field::flag("body_bounce", &c.body_bounce, "Paths with a bounce off another body."),
      Field::flag("multiple", &c.multiple,
                  "Multiples: echoes that travel twice between a wall and the sonar's housing."),
      Field::real("head_reflection_db", &c.head_reflection_db, {-80, 0}, "dB",
                  "Reflection of the sonar's housing, for multiples."),
      Field::real("spurious_share", &c.spurious_share, {0, 1}, "1", "Share of pings with one false echo."),
      Field::real("spurious_level", &c.spurious_level, {0, 1e6}, "counts", "Level of a false echo."),
      Field::real("streak_share", &c.streak_share, {0, 1}, "1", "Share of pings with a streak along one beam."),
      Field::real("ring_share", &c.ring_share, {0, 1}, "1", "Share of pings with a ring: one range, all beams."),
      Field::real("burst_share", &c.burst_share, {0, 1}, "1",
                  "Share of pings with a burst of another sonar over all beams."),
      Field::real("disturbance_level", &c.disturbance_level, {0, 1e6}, "counts", "Level of streaks, rings and bursts."),
      Field::real("dropout_share", &c.dropout_share, {0, 1}, "1", "Share of pings that are lost."),
      Field::real("blanking_m", &c.blanking_m, {0, 1000}, "m", "Blanking range: the transmit pulse rings up to here.")
          .was("blind_m"),
      Field::real("ringing_level", &c.ringing_level, {0, 1e6}, "counts", "Level of the ringing at the head."),
      Field::choice("pick", &c.pick, {{"nearest", RangePick::kNearest}, {"strongest", RangePick::kStrongest}},
                    "Which echo a range sonar reports."),
      Field::real("pick_level", &c.pick_level, {0, 1e6}, "counts", "Minimum level of that echo."),
  };
}

double ping_interval_s(const SonarConfig& c) {
  return c.interval_s > 0 ? c.interval_s : 2 * c.range_m / c.sound_speed + 0.005;
}

void check(const SonarConfig& c) {
  const auto refuse = [&c](const char* key, const char* problem, const char* allowed) {
    Place place = c.place;
    place.key = std::string("sonar.") + key;
    throw Error(problem, place, allowed);
  };
  if (c.kind != SonarKind::kScanning && c.beams > 1 && c.sector.radians() <= 0) {
    refuse("sector_deg", "several beams have the same direction", "more than 0 deg, or one beam");
  }
  if (c.kind == SonarKind::kFan && c.sector.degrees() > 359.9)
    refuse("sector_deg", "a fan cannot span a full turn", "below 360 deg");
  const auto check_profile = [&refuse](const char* key, const std::vector<double>& rows) {
    if (rows.size() == 2) refuse(key, "the profile has one row", "none, or two rows and more");
    for (std::size_t i = 2; i < rows.size(); i += 2) {
      if (rows[i] <= rows[i - 2]) refuse(key, "the rows are not in order", "rows by increasing range or azimuth");
    }
  };
  check_profile("noise_by_range", c.noise_by_range);
  check_profile("noise_by_bearing", c.noise_by_bearing);
  check_profile("reverberation", c.reverberation);
  if (c.blanking_m >= c.range_m) refuse("blanking_m", "the sonar is blind over its whole range", "below range_m");
  if (c.interval_s > 0 && c.interval_s < kLeastPingInterval)
    refuse("interval_s", "is too short", "0, or 0.001 .. 60 s");
  if (c.name.empty()) refuse("name", "is empty", "a text");
}

ScanCommand settings_of(const SonarConfig& c) {
  return {.heading = c.heading,
          .pitch = c.pitch,
          .roll = c.roll,
          .middle = c.middle,
          .sector = c.sector,
          .step = c.step,
          .width = c.width,
          .range_m = c.range_m,
          .beams = c.beams};
}

SonarConfig commanded(SonarConfig config, const ScanCommand& command) {
  const auto refuse = [&config](const char* key, const char* problem, const char* allowed) {
    Place place = config.place;
    place.key = std::string("sonar.") + key;
    throw Error(problem, place, allowed);
  };
  config.heading = command.heading.value_or(config.heading);
  config.pitch = command.pitch.value_or(config.pitch);
  config.roll = command.roll.value_or(config.roll);
  config.sector = command.sector.value_or(config.sector);
  config.middle = command.middle.value_or(config.middle);
  config.step = command.step.value_or(config.step);
  config.width = command.width.value_or(config.width);
  config.range_m = command.range_m.value_or(config.range_m);
  config.beams = command.beams.value_or(config.beams);
  if (!(config.sector.degrees() >= 0 && config.sector.degrees() <= 360))
    refuse("sector_deg", "no sector", "0 to 360 deg");
  if (!(config.step.degrees() > 0 && config.step.degrees() <= 180))
    refuse("step_deg", "no step", "above 0, to 180 deg");
  if (!(config.width.degrees() > 0 && config.width.degrees() < 180))
    refuse("width_deg", "no beam", "above 0, below 180 deg");
  if (!(config.range_m > 0 && std::isfinite(config.range_m))) refuse("range_m", "no range", "above 0 m");
  if (config.beams < 1) refuse("beams", "no beam", "at least 1");
  check(config);
  return config;
}

}  // namespace isobath
