// Small scenes for tests of the simulator.
#pragma once

#include <cmath>
#include <isobath/sim/echo_synthesizer.hpp>
#include <isobath/sim/scene.hpp>
#include <isobath/sim/simulated_sonar.hpp>
#include <memory>
#include <numbers>
#include <string>

namespace isobath::test {

inline constexpr double kDegree = std::numbers::pi / 180;

/// A scene in pure, still, silent water, and what stands in it.
struct Tank {
  Scene scene;
  std::unique_ptr<World> world;
  std::unique_ptr<Water> water;

  explicit Tank(const std::string& toml) : scene(parse_scene("[scene]\n" + toml, "tank.toml")) {
    world = std::make_unique<World>(scene);
    water = std::make_unique<Water>(scene.water);
  }
};

/// One beam without noise, reverberation or bounces: what is left is the sonar equation.
inline SonarConfig clean_beam(double width_deg, double height_deg) {
  SonarConfig c;
  c.beams = 1;
  c.sector = Angle{};
  c.width = Angle::degrees(width_deg);
  c.height = Angle::degrees(height_deg);
  c.pattern = c.height_pattern = PatternKind::kIdeal;
  c.range_m = 60;
  c.bins = 600;
  c.noise = BackgroundLaw::kNone;
  c.speckle = c.surface_reverberation = c.bottom_reverberation = c.volume_reverberation = false;
  c.surface_bounce = c.bottom_bounce = false;
  return c;
}

inline double total(const std::vector<float>& powers) {
  double sum = 0;
  for (const float p : powers) sum += static_cast<double>(p);
  return sum;
}
inline double total(const EchoImage& image) { return total(image.rough) + total(image.steady); }
inline double db(double power) { return 10 * std::log10(power); }

/// Of all that is heard, weighted by its power, m.
inline double mean_range(const EchoImage& image, double bin_m) {
  double sum = 0;
  for (int k = 0; k < image.bins; ++k) {
    const auto i = static_cast<std::size_t>(k);
    sum += (k + 0.5) * bin_m * static_cast<double>(image.rough[i] + image.steady[i]);
  }
  return sum / total(image);
}

inline int strongest_bin(const EchoImage& image, int beam = 0) {
  int best = 0;
  const auto at = [&](int k) {
    const std::size_t i =
        static_cast<std::size_t>(beam) * static_cast<std::size_t>(image.bins) + static_cast<std::size_t>(k);
    return image.rough[i] + image.steady[i];
  };
  for (int k = 1; k < image.bins; ++k) {
    if (at(k) > at(best)) best = k;
  }
  return best;
}

inline Pose at_depth(double z, double heading_deg = 0, double pitch_deg = 0) {
  return {Rotation::from_heading_pitch_roll(Angle::degrees(heading_deg), Angle::degrees(pitch_deg), {}), {0, 0, z}};
}

}  // namespace isobath::test
