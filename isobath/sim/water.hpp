// Water: the acoustic properties of the water between sonar and target, and its current.
//
// Absorption: Francois and Garrison 1982 (JASA 72, 1879: 0.4 to 1000 kHz, -2 to 22 degrees C, 30 to 35 psu, used down
// to 0) or Ainslie and McColm 1998 (JASA 103, 1671: the same within 10 %). Speed of sound: a measured profile, or
// Medwin 1975 from temperature, salinity and depth. Paths are straight; the travel time follows from the mean slowness
// between both depths, so a profile shifts ranges but bends no ray (below 0.1 m at 100 m in a 10 m/s thermocline).
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <vector>

namespace isobath {

enum class AbsorptionLaw : std::uint8_t { kNone, kFrancoisGarrison, kAinslieMcColm };

struct WaterConfig {
  double temperature_c = 15;
  double salinity_psu = 0;  ///< 0: fresh water; 35: sea water
  double ph = 8;
  double density = 0;               ///< kg/m3; 0: from temperature and salinity (linear, within 0.1 %)
  std::vector<double> sound_speed;  ///< rows of depth (m), speed (m/s); empty: Medwin
  AbsorptionLaw absorption = AbsorptionLaw::kAinslieMcColm;
  double wind = 2;                    ///< m/s at 10 m height: the sea state of surface reverberation
  double volume_scattering_db = -90;  ///< S_v, dB re 1/m: bubbles, plankton, silt
  std::vector<double> current;        ///< rows of depth (m), north, east (m/s); empty: still water
};
std::vector<Field> fields(WaterConfig& config);

/// One-way absorption, dB/m. Frequency in Hz, temperature in degrees C, salinity in psu, depth in m.
double absorption_db(AbsorptionLaw law, double frequency, double temperature_c, double salinity_psu, double depth,
                     double ph);
/// Medwin 1975, m/s, for 0 to 30 degrees C, 0 to 40 psu, 0 to 1000 m. It agrees with Chen and Millero 1977 (UNESCO) at
/// the surface within 0.3 m/s in sea water (25 to 40 psu) and 0.8 m/s in fresh water.
double medwin_sound_speed(double temperature_c, double salinity_psu, double depth);

class Water {
 public:
  /// Throws Error if the depths of a profile do not increase, or a speed of sound is out of range.
  explicit Water(WaterConfig config, const Place& place = {});

  [[nodiscard]] const WaterConfig& config() const { return config_; }
  [[nodiscard]] double density() const { return density_; }
  [[nodiscard]] double sound_speed(double depth) const;
  /// Mean speed on the straight path between two depths: path length over travel time.
  [[nodiscard]] double mean_sound_speed(double depth_a, double depth_b) const;
  /// One-way absorption at a depth, dB/m.
  [[nodiscard]] double absorption_db(double frequency, double depth) const;
  /// Velocity of the water in W: north, east, down, m/s.
  [[nodiscard]] Eigen::Vector3d current(double depth) const;

 private:
  WaterConfig config_;
  double density_ = 1000;
};

}  // namespace isobath
