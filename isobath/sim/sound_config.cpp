#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/base/nearest_name.hpp>
#include <isobath/sim/sound_config.hpp>

namespace isobath {
namespace {

constexpr Range kSoundPlaces{-1e5, 1e5};

}  // namespace

std::vector<Field> fields(HydrophonesConfig& c) {
  return {Field::flag("on", &c.on, "Whether the vehicle has a passive array."),
          Field::real("interval_s", &c.interval_s, {0.02, 3600}, "s", "Time from one set of bearings to the next."),
          Field::degrees("bearing_error_deg", &c.bearing_error, {0.01, 90},
                         "Standard deviation of a bearing, bias included."),
          Field::real("bias_share", &c.bias_share, {0, 1}, "1",
                      "Share of that deviation which is the same in all bearings of a run."),
          Field::degrees("elevation_error_deg", &c.elevation_error, {0, 90},
                         "Standard deviation of an elevation; 0: the array does not resolve elevation."),
          Field::real("low_hz", &c.low_hz, {0.1, 1e6}, "Hz", "Lowest frequency that the array hears."),
          Field::real("high_hz", &c.high_hz, {0.1, 1e6}, "Hz", "Highest frequency that it hears."),
          Field::real("resolution_hz", &c.resolution_hz, {1e-3, 1e4}, "Hz", "Width of a frequency cell."),
          Field::real("noise_db", &c.noise_db, {0, 200}, "dB", "Noise of sea and vehicle, re 1 uPa2/Hz."),
          Field::real("gain_db", &c.gain_db, {0, 60}, "dB", "Gain of the array against that noise."),
          Field::real("threshold_db", &c.threshold_db, {-20, 60}, "dB",
                      "Signal to noise ratio in a cell from which on a sound is heard."),
          Field::real("fluctuation_db", &c.fluctuation_db, {0, 20}, "dB",
                      "Standard deviation of the signal to noise ratio from one interval to the next."),
          Field::numbers("position", c.position.data(), 3, {-100, 100}, "m",
                         "Position of the array on the vehicle: forward, starboard, down.")};
}

std::vector<Field> fields(SoundConfig& c) {
  return {Field::text("name", &c.name, "Name in reports."),
          Field::text("body", &c.body, "Body of the scene that the sound comes from; empty: `position`."),
          Field::numbers("position", c.position.data(), 3, kSoundPlaces, "m", "Without a body: north, east, depth."),
          Field::real("frequency_hz", &c.frequency_hz, {0.1, 1e6}, "Hz", "Frequency of its line."),
          Field::real("source_level_db", &c.source_level_db, {0, 250}, "dB", "Level of the line, re 1 uPa at 1 m.")};
}

void check(const HydrophonesConfig& config, const std::vector<SoundConfig>& sounds,
           const std::vector<std::string>& bodies, const Place& scene) {
  for (const SoundConfig& sound : sounds) {
    if (sound.body.empty() || std::find(bodies.begin(), bodies.end(), sound.body) != bodies.end()) continue;
    Place place = sound.place;
    place.key += (place.key.empty() ? "" : ".") + std::string("body");
    throw Error("unknown body " + sound.body, place, fmt::format("{}", fmt::join(bodies, ", ")),
                did_you_mean(sound.body, bodies));
  }
  if (!config.on || config.low_hz <= config.high_hz) return;
  Place place = scene;
  place.key = "hydrophones.low_hz";
  throw Error("is above high_hz", place, "at most high_hz");
}

}  // namespace isobath
