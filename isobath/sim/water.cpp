#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/sim/water.hpp>

namespace isobath {
namespace {

/// Column `column` of a profile of rows {depth, ...}, linear between rows, constant beyond them.
double at_depth(const std::vector<double>& rows, std::size_t width, std::size_t column, double depth) {
  const std::size_t count = rows.size() / width;
  if (depth <= rows[0]) return rows[column];
  for (std::size_t i = 1; i < count; ++i) {
    const double below = rows[i * width], above = rows[(i - 1) * width];
    if (depth > below) continue;
    const double share = (depth - above) / (below - above);
    return rows[(i - 1) * width + column] * (1 - share) + rows[i * width + column] * share;
  }
  return rows[(count - 1) * width + column];
}

void check_profile(const std::vector<double>& rows, std::size_t width, const char* key, Place place) {
  place.key += std::string(place.key.empty() ? "" : ".") + key;
  for (std::size_t i = 1; i < rows.size() / width; ++i) {
    if (rows[i * width] <= rows[(i - 1) * width]) {
      throw Error(fmt::format("depth {} does not lie below {}", rows[i * width], rows[(i - 1) * width]), place,
                  "rows by increasing depth");
    }
  }
}

double francois_garrison(double f, double t, double s, double d, double ph) {
  const double kelvin = t + 273;
  const double c = 1412 + 3.21 * t + 1.19 * s + 0.0167 * d;
  const double a1 = 8.86 / c * std::pow(10, 0.78 * ph - 5);
  const double f1 = 2.8 * std::sqrt(s / 35) * std::pow(10, 4 - 1245 / kelvin);
  const double a2 = 21.44 * s / c * (1 + 0.025 * t);
  const double p2 = 1 - 1.37e-4 * d + 6.2e-9 * d * d;
  const double f2 = 8.17 * std::pow(10, 8 - 1990 / kelvin) / (1 + 0.0018 * (s - 35));
  const double a3 = t <= 20 ? 4.937e-4 - 2.59e-5 * t + 9.11e-7 * t * t - 1.50e-8 * t * t * t
                            : 3.964e-4 - 1.146e-5 * t + 1.45e-7 * t * t - 6.5e-10 * t * t * t;
  const double p3 = 1 - 3.83e-5 * d + 4.9e-10 * d * d;
  const double boric = f1 > 0 ? a1 * f1 * f * f / (f1 * f1 + f * f) : 0;
  return boric + a2 * p2 * f2 * f * f / (f2 * f2 + f * f) + a3 * p3 * f * f;
}

double ainslie_mccolm(double f, double t, double s, double d, double ph) {
  const double z = d / 1000;
  const double f1 = 0.78 * std::sqrt(s / 35) * std::exp(t / 26);
  const double f2 = 42 * std::exp(t / 17);
  const double boric = f1 > 0 ? 0.106 * f1 * f * f / (f * f + f1 * f1) * std::exp((ph - 8) / 0.56) : 0;
  return boric + 0.52 * (1 + t / 43) * (s / 35) * f2 * f * f / (f * f + f2 * f2) * std::exp(-z / 6) +
         0.00049 * f * f * std::exp(-(t / 27 + z / 17));
}

}  // namespace

std::vector<Field> fields(WaterConfig& c) {
  using L = AbsorptionLaw;
  return {
      Field::real("temperature_c", &c.temperature_c, {-2, 40}, "degrees C", "Temperature."),
      Field::real("salinity_psu", &c.salinity_psu, {0, 45}, "psu", "Salinity: 0 in fresh water, 35 in the sea."),
      Field::real("ph", &c.ph, {5, 9}, "1", "pH value."),
      Field::real("density", &c.density, {0, 1100}, "kg/m3", "Density; 0: from temperature and salinity."),
      Field::rows("sound_speed", &c.sound_speed, 2, {0, 12000}, "m, m/s",
                  "Profile of depth and speed of sound; empty: Medwin 1975."),
      Field::choice(
          "absorption", &c.absorption,
          {{"none", L::kNone}, {"francois_garrison", L::kFrancoisGarrison}, {"ainslie_mccolm", L::kAinslieMcColm}},
          "Law of absorption."),
      Field::real("wind", &c.wind, {0, 30}, "m/s",
                  "Wind speed at 10 m height; a stronger wind raises the surface reverberation."),
      Field::real("volume_scattering_db", &c.volume_scattering_db, {-150, -20}, "dB re 1/m",
                  "Scattering strength of the water itself: bubbles, plankton, silt."),
      Field::rows("current", &c.current, 3, {-20, 12000}, "m, m/s, m/s",
                  "Profile of depth, current to the north and to the east; empty: still water."),
  };
}

double absorption_db(AbsorptionLaw law, double frequency, double temperature_c, double salinity_psu, double depth,
                     double ph) {
  const double f = frequency / 1000;
  switch (law) {
    case AbsorptionLaw::kNone: return 0;
    case AbsorptionLaw::kFrancoisGarrison: return francois_garrison(f, temperature_c, salinity_psu, depth, ph) / 1000;
    case AbsorptionLaw::kAinslieMcColm: return ainslie_mccolm(f, temperature_c, salinity_psu, depth, ph) / 1000;
  }
  return 0;
}

double medwin_sound_speed(double t, double s, double depth) {
  return 1449.2 + 4.6 * t - 0.055 * t * t + 0.00029 * t * t * t + (1.34 - 0.010 * t) * (s - 35) + 0.016 * depth;
}

Water::Water(WaterConfig config, const Place& place) : config_(std::move(config)) {
  check_profile(config_.sound_speed, 2, "sound_speed", place);
  check_profile(config_.current, 3, "current", place);
  for (std::size_t i = 0; i < config_.sound_speed.size() / 2; ++i) {
    if (config_.sound_speed[2 * i + 1] < 1300 || config_.sound_speed[2 * i + 1] > 1700) {
      Place where = place;
      where.key += std::string(where.key.empty() ? "" : ".") + "sound_speed";
      throw Error("speed of sound out of range", where, "1300 .. 1700 m/s");
    }
  }
  const double fresh = 999.84 - 0.0062 * (config_.temperature_c - 4) * (config_.temperature_c - 4);
  density_ = config_.density > 0 ? config_.density : fresh + 0.78 * config_.salinity_psu;
}

double Water::sound_speed(double depth) const {
  if (config_.sound_speed.empty()) return medwin_sound_speed(config_.temperature_c, config_.salinity_psu, depth);
  return at_depth(config_.sound_speed, 2, 1, depth);
}

double Water::mean_sound_speed(double depth_a, double depth_b) const {
  const std::vector<double>& rows = config_.sound_speed;
  if (rows.size() <= 2) return sound_speed(0.5 * (depth_a + depth_b));
  const double top = std::min(depth_a, depth_b), bottom = std::max(depth_a, depth_b);
  if (bottom - top < 1e-6) return sound_speed(top);
  // Simpson over the slowness of every piece in which the speed is linear: within 1e-6 for a change of 5 %.
  double time = 0, from = top, speed = sound_speed(top);
  const auto go_to = [&](double depth, double there) {
    time += (depth - from) / 6 * (1 / speed + 8 / (speed + there) + 1 / there);
    from = depth;
    speed = there;
  };
  for (std::size_t i = 0; i + 1 < rows.size(); i += 2) {
    if (rows[i] > top && rows[i] < bottom) go_to(rows[i], rows[i + 1]);
  }
  go_to(bottom, sound_speed(bottom));
  return (bottom - top) / time;
}

double Water::absorption_db(double frequency, double depth) const {
  return isobath::absorption_db(config_.absorption, frequency, config_.temperature_c, config_.salinity_psu, depth,
                                config_.ph);
}

Eigen::Vector3d Water::current(double depth) const {
  if (config_.current.empty()) return Eigen::Vector3d::Zero();
  return {at_depth(config_.current, 3, 1, depth), at_depth(config_.current, 3, 2, depth), 0};
}

}  // namespace isobath
