// DeadReckoning: the navigator of a simulated vehicle. It turns readings of the vehicle's sensors into Navigation fixes
// (ledger S5-02, S2-47).
//
//   truth    the true pose, covariance 0.
//   drift    the position error that is quoted for a good inertial unit with a Doppler log: 0.5 % of the distance
//            (S5-02). The velocity has an error b, a Gauss-Markov process over the distance d travelled with
//            correlation length L, so that the track stays smooth; per axis
//              var(d) = 2 s^2 L (d - L (1 - exp(-d / L))),  var(1000 m) = (share x 1000 m)^2.
//            Attitude and depth are exact. A GPS fix resets the error to that of the fix.
//   sensors  readings only. Heading: Kalman filter of heading and gyro bias. Roll and pitch: gyro, corrected by the
//            attitude unit with a time constant of 2 s. Position: Kalman filter of (north, east, compass bias, scale
//            error of the DVL, unmeasured velocity); GPS or transponder fixes update it. The unmeasured velocity is the
//            current when the DVL tracks water, and the whole velocity when there is no DVL reading. The filter rejects
//            a fix outside the 99.97 % gate of its covariance; the sixth such fix in a row resets the position to it.
//
// Covariance: of (position in W, rotation vector in B). It is consistent if the errors of the sensors match their
// configuration and the `*_sigma` below: the normalised squared error of north and east is 2.04 (2 expected) over
// 1000 seeds of 160 s, 2.03 with transponder fixes, 2.06 on water track in an unknown current. It does not model a bias
// of roll, pitch, depth or DVL. Cost with the sensors: 0.25 us per reading.
// Non-finite readings are ignored. SI units, radians. One thread; allocates nothing after the first fixes.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/base/random.hpp>
#include <isobath/sim/navigation_sensors.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

enum class NavigatorKind : std::uint8_t { kTruth, kDrift, kSensors };

struct DeadReckoningConfig {
  NavigatorKind kind = NavigatorKind::kSensors;
  double rate_hz = 10;
  double start_sigma = 0;  ///< m: standard deviation of the start position, each axis
  // drift
  double drift_share = 0.005;  ///< standard deviation of each axis after 1000 m, as a share of 1000 m
  double drift_length_m = 100;
  // sensors: assumptions that their configuration does not state
  Angle compass_bias_sigma = Angle::degrees(1);
  double dvl_scale_sigma = 0.003;
  double current_sigma = 0.3;  ///< m/s, each axis
  double current_walk = 0.01;  ///< m/s after one second
  double speed_walk = 0.1;     ///< m/s after one second, when no velocity is measured
};
std::vector<Field> fields(DeadReckoningConfig& config);

class DeadReckoning {
 public:
  /// `data_sheet`: the navigator reads the noise and the rates of the sensors from it, but not their biases.
  DeadReckoning(const DeadReckoningConfig& config, const NavigationSensorsConfig& data_sheet, std::uint64_t seed);

  /// The fixes due since the last call, up to and including `now`. `readings`: those that have arrived since then,
  /// oldest first; a reading older than the last fix counts as made at `now`. The kind `sensors` uses the truth in the
  /// first call only, as the launch position. Valid until the next call.
  const std::vector<Navigation>& advance(Time now, const VehicleState& truth, std::span<const NavReading> readings);

 private:
  enum class Velocity : std::uint8_t { kNone, kThroughWater, kOverGround };
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  void start(Time now, const VehicleState& truth);
  void drift_along(const VehicleState& truth);
  [[nodiscard]] Navigation drifted(Time time, const VehicleState& state) const;

  void propagate(Time to);
  void change_velocity(Velocity next);
  void propagate_attitude(double dt);
  void propagate_position(const Eigen::Vector3d& v_W, double dt);
  void use(const NavReading& reading);
  void use_heading(double heading);
  void use_position(const Eigen::Vector2d& north_east, const Eigen::Matrix2d& covariance);
  [[nodiscard]] Velocity velocity_at(Time time) const;
  [[nodiscard]] Rotation attitude() const;
  [[nodiscard]] Eigen::Vector3d velocity_W() const;
  [[nodiscard]] double velocity_sigma(double speed) const;
  [[nodiscard]] Navigation estimated() const;

  DeadReckoningConfig config_;
  NavigationSensorsConfig sheet_;
  Random random_;
  Ticker ticker_;
  std::vector<Navigation> fixes_;
  std::optional<Time> last_;  ///< time of the last call
  VehicleState last_state_;

  // drift
  Eigen::Vector2d error_ = Eigen::Vector2d::Zero();       ///< m
  Eigen::Vector2d error_rate_ = Eigen::Vector2d::Zero();  ///< m of error per metre travelled
  double rate_sigma_ = 0;
  double reset_variance_ = 0;  ///< m2, at the last reset
  double since_reset_m_ = 0;

  // sensors
  Time time_ = {};                                     ///< time of the estimate
  Eigen::Vector2d heading_ = Eigen::Vector2d::Zero();  ///< heading as the compass reads it, bias of the gyro
  Eigen::Matrix2d heading_covariance_ = Eigen::Matrix2d::Zero();
  double roll_ = 0, pitch_ = 0;
  Vector6 x_ = Vector6::Zero();  ///< north, east, bias of the compass, scale error of the DVL, unmeasured velocity
  Matrix6 P_ = Matrix6::Zero();
  double depth_ = 0, depth_variance_ = 0;
  Eigen::Vector3d w_B_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_B_ = Eigen::Vector3d::Zero();  ///< as the DVL reads it
  bool over_ground_ = true;
  Velocity velocity_ = Velocity::kOverGround;
  std::optional<Time> compass_at_, gyro_at_, dvl_at_;
  bool heading_known_ = false;
  int refused_ = 0;
};

}  // namespace isobath
