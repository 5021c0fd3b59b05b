// NavigationSensors: simulated readings of a vehicle's compass, attitude unit, gyro, velocity log (DVL), pressure
// gauge, GPS and long-baseline transponders, made from the truth (ledger S5-02, S2-47, S1-10, S6-22).
//
// Errors: reading = truth + bias + white noise, and for each sensor:
//   compass  deviation A + B sin psi + C cos psi + D sin 2 psi + E cos 2 psi, added to the true heading psi
//   gyro     bias with a random walk; the rotation of the Earth is left out
//   DVL      velocity over ground with a scale error, only between two altitudes; if wanted, velocity through the water
//            when the bottom is out of reach
//   depth    rounded to steps
//   GPS      only near the surface, and only some time after surfacing
//   LBL      ranges by travel time under an assumed speed of sound, some of them outliers by a longer path; at least
//            three ranges give a least-squares fix in the plane (the depth counts as exact), fewer give none
// Each sensor has its own clock (reading n is due n / rate after the start, to the nanosecond, without drift) and its
// own stream of random numbers, which does not depend on the settings of other sensors. Lever arms between B and a
// sensor are left out.
// Units: SI, radians; frames W and B. One thread. Allocates nothing after the first fixes. Cost: see DeadReckoning.
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/base/time.hpp>
#include <isobath/geometry/trilateration.hpp>
#include <isobath/vehicle/vehicle_state.hpp>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace isobath {

struct CompassReading {
  Angle heading;
};
struct AttitudeReading {
  Angle roll, pitch;
};
struct GyroReading {
  Eigen::Vector3d w_B = Eigen::Vector3d::Zero();  ///< rad/s
};
struct VelocityReading {
  Eigen::Vector3d v_B = Eigen::Vector3d::Zero();  ///< m/s
  bool over_ground = true;                        ///< false: through the water
};
struct DepthReading {
  double depth = 0;  ///< m
};
struct GpsReading {
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();  ///< m
  double sigma = 0;  ///< standard deviation along each axis, as the device states it
};
struct LblReading {
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();  ///< m
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< m2, from the geometry and the noise of a range
  double residual = 0;  ///< m; its expected square is the variance of a range, so an outlier shows up here
  int ranges = 0;
};

struct NavReading {
  Time time;
  std::string source;  ///< "compass", "ahrs", "gyro", "dvl", "depth", "gps" or "lbl"
  std::variant<CompassReading, AttitudeReading, GyroReading, VelocityReading, DepthReading, GpsReading, LblReading>
      value;
};

struct CompassConfig {
  bool on = true;
  double rate_hz = 10;
  Angle bias;
  Angle noise = Angle::degrees(0.5);
  double dropout = 0;  ///< probability that a reading is lost; the same for all sensors
  std::array<double, 5> deviation_deg = {0, 0, 0, 0, 0};
};
struct AttitudeConfig {
  bool on = true;
  double rate_hz = 10;
  Angle roll_bias, pitch_bias;
  Angle noise = Angle::degrees(0.2);
  double dropout = 0;
};
struct GyroConfig {
  bool on = true;
  double rate_hz = 25;
  std::array<double, 3> bias = {0, 0, 0};  ///< rad/s
  double bias_walk = 1e-6;                 ///< rad/s after one second
  double noise = 0.001;                    ///< rad/s
  double dropout = 0;
};
struct DvlConfig {
  bool on = true;
  double rate_hz = 5;
  double scale_error = 0;                  ///< 0.01: speeds read 1 % too high
  std::array<double, 3> bias = {0, 0, 0};  ///< m/s
  double noise = 0.01;                     ///< m/s
  double min_altitude_m = 0.5;
  double max_altitude_m = 80;
  bool water_track = false;
  double dropout = 0;
};
struct DepthConfig {
  bool on = true;
  double rate_hz = 5;
  double bias = 0;      ///< m
  double noise = 0.02;  ///< m
  double step = 0.01;   ///< m; 0: not rounded
  double dropout = 0;
};
struct GpsConfig {
  bool on = true;
  double rate_hz = 1;
  std::array<double, 2> bias = {0, 0};  ///< north, east, m
  double noise = 2;                     ///< m, each axis
  double max_depth_m = 0.3;
  double first_fix_s = 5;
  double dropout = 0;
};
struct LblConfig {
  bool on = false;
  double rate_hz = 1 / 0.6;          ///< S2-47
  std::vector<double> transponders;  ///< north, east, depth of each transponder
  double noise = 1;                  ///< m, standard deviation of a range
  double outlier_share = 0.01;       ///< share of ranges with an outlier
  double outlier_m = 20;             ///< largest excess of an outlier
  double max_range_m = 1500;
  double sound_speed = 1500;  ///< m/s that the device assumes
  double dropout = 0;         ///< probability that a range is lost
};
struct NavigationSensorsConfig {
  CompassConfig compass;
  AttitudeConfig ahrs;
  GyroConfig gyro;
  DvlConfig dvl;
  DepthConfig depth;
  GpsConfig gps;
  LblConfig lbl;
};

std::vector<Field> fields(CompassConfig& config);
std::vector<Field> fields(AttitudeConfig& config);
std::vector<Field> fields(GyroConfig& config);
std::vector<Field> fields(DvlConfig& config);
std::vector<Field> fields(DepthConfig& config);
std::vector<Field> fields(GpsConfig& config);
std::vector<Field> fields(LblConfig& config);
/// [compass], [ahrs], [gyro], [dvl], [depth], [gps], [lbl].
std::vector<Section> sections(NavigationSensorsConfig& config);

/// The surroundings of the sensors.
struct NavigationScene {
  std::optional<double> altitude_m;                     ///< height of B above the bottom; empty: no bottom in reach
  double sound_speed = 1500;                            ///< m/s
  Eigen::Vector3d current_W = Eigen::Vector3d::Zero();  ///< velocity of the water over ground, m/s
};

/// Regular times on the logical clock: number n is due n / rate after the start, rounded to the nanosecond.
class Ticker {
 public:
  Ticker() = default;
  Ticker(Time start, double rate_hz) : start_(start), rate_hz_(rate_hz) {}
  [[nodiscard]] Time due() const;
  void advance() { ++ticks_; }

 private:
  Time start_ = {};
  double rate_hz_ = 1;
  std::int64_t ticks_ = 0;
};

class NavigationSensors {
 public:
  NavigationSensors(const NavigationSensorsConfig& config, std::uint64_t seed);

  /// The readings due since the last call, up to and including `now`, in order of time. The first call starts all
  /// clocks. The truth is interpolated between two calls. Valid until the next call.
  const std::vector<NavReading>& advance(Time now, const VehicleState& truth, const NavigationScene& scene);
  /// Number of LBL rounds without a fix so far.
  [[nodiscard]] int lbl_refusals() const { return lbl_refusals_; }

 private:
  struct Sensor {
    const char* source;
    bool on;
    double rate_hz;
    double dropout;
    Random random;
    Ticker ticker = {};
  };
  void measure(Sensor& sensor, int index, Time time, const VehicleState& state, const NavigationScene& scene);
  std::optional<VelocityReading> measure_velocity(Random& random, const VehicleState& state,
                                                  const NavigationScene& scene) const;
  std::optional<LblReading> measure_lbl(Random& random, const VehicleState& state, const NavigationScene& scene);

  NavigationSensorsConfig config_;
  std::vector<Sensor> sensors_;
  Eigen::Vector3d gyro_bias_;
  std::vector<NavReading> readings_;
  std::vector<TransponderRange> ranges_;
  std::optional<Time> last_;
  VehicleState last_state_;
  std::optional<Time> surfaced_;  ///< time of surfacing
  int lbl_refusals_ = 0;
};

}  // namespace isobath
