#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <isobath/sim/dead_reckoning.hpp>

namespace isobath {
namespace {

constexpr double kDriftAtM = 1000;   // the distance at which S5-02 states the drift
constexpr double kAttitudeTime = 2;  // s, with which roll and pitch follow the attitude unit
constexpr double kFixGate = 16;      // chi-square, 2 degrees of freedom: 99.97 %
constexpr int kRefusedInARow = 5;
constexpr double kResidualGate = 4;      // standard deviations of a range
constexpr double kGyroBiasSigma = 0.01;  // rad/s, before the compass has corrected it
constexpr double kUnmeasuredTurn = 0.2;  // rad/s, without a gyro

double wrap(double angle) { return Angle::radians(angle).wrapped().radians(); }

/// Whether the last reading of a sensor with this rate is recent; false: the sensor is silent.
bool fresh(const std::optional<Time>& at, Time now, double rate_hz) {
  return at && to_seconds(now - *at) <= std::max(1.0, 3 / rate_hz);
}

/// Variance of one axis after d metres, for an error rate of unit variance.
double drift_variance(double d, double length) {
  if (length <= 0) return d;
  return 2 * length * (d - length * -std::expm1(-d / length));
}

/// Rates of roll, pitch and heading.
Eigen::Vector3d euler_rates(const Eigen::Vector3d& w_B, double roll, double pitch) {
  const double s = std::sin(roll), c = std::cos(roll);
  const double turn = (w_B.y() * s + w_B.z() * c) / std::max(0.1, std::cos(pitch));
  return {w_B.x() + turn * std::sin(pitch), w_B.y() * c - w_B.z() * s, turn};
}

bool finite(const NavReading& reading) {
  struct Check {
    bool operator()(const CompassReading& r) const { return std::isfinite(r.heading.radians()); }
    bool operator()(const AttitudeReading& r) const {
      return std::isfinite(r.roll.radians()) && std::isfinite(r.pitch.radians());
    }
    bool operator()(const GyroReading& r) const { return r.w_B.allFinite(); }
    bool operator()(const VelocityReading& r) const { return r.v_B.allFinite(); }
    bool operator()(const DepthReading& r) const { return std::isfinite(r.depth); }
    bool operator()(const GpsReading& r) const { return r.north_east.allFinite(); }
    bool operator()(const LblReading& r) const { return r.north_east.allFinite() && r.covariance.allFinite(); }
  };
  return std::visit(Check{}, reading.value);
}

VehicleState between(const VehicleState& a, const VehicleState& b, double share) {
  if (share >= 1) return b;
  return {interpolate(a.X_WB, b.X_WB, share), a.v_B + (b.v_B - a.v_B) * share, a.w_B + (b.w_B - a.w_B) * share};
}

}  // namespace

std::vector<Field> fields(DeadReckoningConfig& c) {
  return {
      Field::choice(
          "kind", &c.kind,
          {{"truth", NavigatorKind::kTruth}, {"drift", NavigatorKind::kDrift}, {"sensors", NavigatorKind::kSensors}},
          "How the vehicle estimates its pose: from the truth, from the truth with a drift, or from its sensors."),
      Field::real("rate_hz", &c.rate_hz, {0.01, 1000}, "Hz", "Fixes per second."),
      Field::real("start_sigma", &c.start_sigma, {0, 1e4}, "m", "Standard deviation of the start position."),
      Field::real("drift_share", &c.drift_share, {0, 1}, "1",
                  "drift: standard deviation after 1000 m of travel, as a share of 1000 m."),
      Field::real("drift_length_m", &c.drift_length_m, {0, 1e5}, "m",
                  "drift: correlation length of the velocity error along the track."),
      Field::degrees("compass_bias_sigma_deg", &c.compass_bias_sigma, {0, 90},
                     "sensors: assumed standard deviation of the compass bias."),
      Field::real("dvl_scale_sigma", &c.dvl_scale_sigma, {0, 0.5}, "1",
                  "sensors: assumed standard deviation of the DVL's scale error."),
      Field::real("current_sigma", &c.current_sigma, {0, 5}, "m/s",
                  "sensors: assumed standard deviation of the current, each axis."),
      Field::real("current_walk", &c.current_walk, {0, 1}, "m/s/sqrt(s)",
                  "sensors: assumed random walk of the current: standard deviation after one second."),
      Field::real("speed_walk", &c.speed_walk, {0, 10}, "m/s/sqrt(s)",
                  "sensors: assumed random walk of the velocity while no sensor measures it: standard deviation after "
                  "one second."),
  };
}

DeadReckoning::DeadReckoning(const DeadReckoningConfig& config, const NavigationSensorsConfig& data_sheet,
                             std::uint64_t seed)
    : config_(config), sheet_(data_sheet), random_(seed) {
  rate_sigma_ = config.drift_share * kDriftAtM / std::sqrt(drift_variance(kDriftAtM, config.drift_length_m));
}

void DeadReckoning::start(Time now, const VehicleState& truth) {
  ticker_ = Ticker(now, config_.rate_hz);
  last_ = now;
  last_state_ = truth;
  time_ = now;
  const auto draw = [&](double sigma) { return sigma * random_.normal(); };
  error_.x() = draw(config_.start_sigma);
  error_.y() = draw(config_.start_sigma);
  reset_variance_ = config_.start_sigma * config_.start_sigma;
  error_rate_.x() = draw(rate_sigma_);
  error_rate_.y() = draw(rate_sigma_);

  const Rotation& R_WB = truth.X_WB.rotation;
  const double bias_sigma = config_.compass_bias_sigma.radians();
  heading_.x() = R_WB.heading().radians() + draw(bias_sigma);
  heading_covariance_ = Eigen::Vector2d(0, kGyroBiasSigma * kGyroBiasSigma).asDiagonal();
  roll_ = R_WB.roll().radians();
  pitch_ = R_WB.pitch().radians();
  x_.head<2>() = truth.X_WB.translation.head<2>() + error_;
  const double speed_variance = config_.current_sigma * config_.current_sigma;
  P_.diagonal() << reset_variance_, reset_variance_, bias_sigma * bias_sigma,
      config_.dvl_scale_sigma * config_.dvl_scale_sigma, speed_variance, speed_variance;
  depth_ = truth.X_WB.translation.z();
  v_B_ = truth.v_B;
  dvl_at_ = now;
}

const std::vector<Navigation>& DeadReckoning::advance(Time now, const VehicleState& truth,
                                                      std::span<const NavReading> readings) {
  fixes_.clear();
  if (!last_) start(now, truth);
  const double span = to_seconds(now - *last_);
  const auto truth_at = [&](Time time) {
    return between(last_state_, truth, span > 0 ? to_seconds(time - *last_) / span : 1);
  };
  const auto fixes_before = [&](Time limit, bool inclusive) {
    for (; ticker_.due() < limit || (inclusive && ticker_.due() == limit); ticker_.advance()) {
      const Time time = ticker_.due();
      if (config_.kind == NavigatorKind::kSensors) {
        propagate(time);
        fixes_.push_back(estimated());
      } else {
        fixes_.push_back(drifted(time, truth_at(time)));
      }
    }
  };
  if (config_.kind == NavigatorKind::kDrift) drift_along(truth);
  for (const NavReading& reading : readings) {
    if (!finite(reading)) continue;
    if (config_.kind == NavigatorKind::kSensors) {
      fixes_before(std::min(reading.time, now), false);
      propagate(std::min(reading.time, now));
      use(reading);
    } else if (const auto* gps = std::get_if<GpsReading>(&reading.value)) {
      fixes_before(std::min(reading.time, now), false);
      error_ = gps->north_east - truth_at(reading.time).X_WB.translation.head<2>();
      reset_variance_ = gps->sigma * gps->sigma;
      since_reset_m_ = 0;
    }
  }
  fixes_before(now, true);
  if (now > *last_) {
    last_ = now;
    last_state_ = truth;
  }
  return fixes_;
}

void DeadReckoning::drift_along(const VehicleState& truth) {
  const double ds = (truth.X_WB.translation - last_state_.X_WB.translation).norm();
  if (ds <= 0) return;
  Eigen::Vector2d noise;
  noise.x() = random_.normal();
  noise.y() = random_.normal();
  const double L = config_.drift_length_m;
  since_reset_m_ += ds;
  if (L <= 0) {
    error_ += noise * (rate_sigma_ * std::sqrt(ds));
    error_rate_ = noise * (rate_sigma_ / std::sqrt(ds));
    return;
  }
  const double kept = std::exp(-ds / L);
  const Eigen::Vector2d before = error_rate_;
  error_rate_ = before * kept + noise * (rate_sigma_ * std::sqrt(-std::expm1(-2 * ds / L)));
  error_ += (before + error_rate_) * (ds / 2);
}

Navigation DeadReckoning::drifted(Time time, const VehicleState& state) const {
  Navigation fix{time, state.X_WB, state.X_WB.rotation * state.v_B, Matrix6(Matrix6::Zero())};
  if (config_.kind == NavigatorKind::kTruth) return fix;
  fix.X_WB.translation.head<2>() += error_;
  fix.v_WB->head<2>() += error_rate_ * state.v_B.norm();
  const double grown = rate_sigma_ * rate_sigma_ * drift_variance(since_reset_m_, config_.drift_length_m);
  fix.covariance->diagonal().head<2>().setConstant(reset_variance_ + grown);
  return fix;
}

DeadReckoning::Velocity DeadReckoning::velocity_at(Time time) const {
  if (!fresh(dvl_at_, time, sheet_.dvl.rate_hz)) return Velocity::kNone;
  return over_ground_ ? Velocity::kOverGround : Velocity::kThroughWater;
}

Rotation DeadReckoning::attitude() const {
  return Rotation::from_heading_pitch_roll(Angle::radians(heading_.x() - x_[2]), Angle::radians(pitch_),
                                           Angle::radians(roll_));
}

/// The measured velocity; states 4 and 5 add the unmeasured one.
Eigen::Vector3d DeadReckoning::velocity_W() const {
  if (velocity_ == Velocity::kNone) return Eigen::Vector3d::Zero();
  return attitude() * (v_B_ / (1 + x_[3]));
}

/// Changes the meaning of the unmeasured velocity: the whole velocity, the current, or nothing.
void DeadReckoning::change_velocity(Velocity next) {
  Matrix6 T = Matrix6::Identity();
  T.bottomRows<2>().setZero();
  Eigen::Vector2d unmeasured = Eigen::Vector2d::Zero();
  double sigma = config_.current_sigma;
  if (next == Velocity::kNone) {  // keeps its value and its errors
    const Eigen::Vector2d v = velocity_W().head<2>();
    T.block<2, 1>(4, 2) = Eigen::Vector2d(v.y(), -v.x());
    T.block<2, 1>(4, 3) = -v / (1 + x_[3]);
    unmeasured = v;
    if (velocity_ == Velocity::kThroughWater) {
      T.bottomRightCorner<2, 2>().setIdentity();
      unmeasured += x_.tail<2>();
    }
    sigma = config_.speed_walk;
  }
  P_ = (T * P_ * T.transpose()).eval();
  P_(4, 4) += sigma * sigma;
  P_(5, 5) += sigma * sigma;
  x_.tail<2>() = unmeasured;
  velocity_ = next;
}

void DeadReckoning::propagate(Time to) {
  const double dt = to_seconds(to - time_);
  if (dt <= 0) return;
  if (const Velocity now = velocity_at(to); now != velocity_) change_velocity(now);
  const double heading_variance = heading_covariance_(0, 0);
  const Eigen::Vector3d before = velocity_W();
  propagate_attitude(dt);
  propagate_position((before + velocity_W()) / 2, dt);
  const bool compass = fresh(compass_at_, to, sheet_.compass.rate_hz);
  if (!compass) P_(2, 2) += heading_covariance_(0, 0) - heading_variance;
  time_ = to;
}

void DeadReckoning::propagate_attitude(double dt) {
  const bool gyro = fresh(gyro_at_, time_, sheet_.gyro.rate_hz);
  const Eigen::Vector3d rates = euler_rates(gyro ? w_B_ : Eigen::Vector3d(0, 0, 0), roll_, pitch_);
  roll_ = wrap(roll_ + rates.x() * dt);
  pitch_ += rates.y() * dt;
  heading_.x() = wrap(heading_.x() + (rates.z() - (gyro ? heading_.y() : 0)) * dt);
  Eigen::Matrix2d F = Eigen::Matrix2d::Identity();
  F(0, 1) = gyro ? -dt : 0;
  Eigen::Matrix2d& P = heading_covariance_;
  P = F * P * F.transpose();
  const GyroConfig& g = sheet_.gyro;
  P(0, 0) += (gyro ? g.noise * g.noise / g.rate_hz : kUnmeasuredTurn * kUnmeasuredTurn) * dt;
  P(1, 1) += g.bias_walk * g.bias_walk * dt;
}

void DeadReckoning::propagate_position(const Eigen::Vector3d& v_W, double dt) {
  const Eigen::Vector2d across(-v_W.y(), v_W.x());
  Matrix6 F = Matrix6::Identity();
  F.block<2, 1>(0, 2) = -across * dt;
  F.block<2, 1>(0, 3) = -v_W.head<2>() * (dt / (1 + x_[3]));
  if (velocity_ != Velocity::kOverGround) F.block<2, 2>(0, 4) = Eigen::Matrix2d::Identity() * dt;
  x_.head<2>() += v_W.head<2>() * dt;
  if (velocity_ != Velocity::kOverGround) x_.head<2>() += x_.tail<2>() * dt;
  P_ = (F * P_ * F.transpose()).eval();
  // White noise sampled at rate f acts on the integral as spectral density sigma^2 / f, whatever filter lies between.
  const double dvl = velocity_ == Velocity::kNone ? 0 : sheet_.dvl.noise * sheet_.dvl.noise / sheet_.dvl.rate_hz;
  const double compass = sheet_.compass.noise.radians() * sheet_.compass.noise.radians() / sheet_.compass.rate_hz;
  P_.topLeftCorner<2, 2>() += Eigen::Matrix2d::Identity() * (dvl * dt) + across * across.transpose() * (compass * dt);
  const double walk = velocity_ == Velocity::kNone ? config_.speed_walk : config_.current_walk;
  P_(4, 4) += walk * walk * dt;
  P_(5, 5) += walk * walk * dt;
  depth_ += v_W.z() * dt;
  constexpr double kDepthWalk = 0.02, kDepthWalkBlind = 0.3;  // m / sqrt(s)
  const double depth_walk = velocity_ == Velocity::kNone ? kDepthWalkBlind : kDepthWalk;
  depth_variance_ += (dvl + depth_walk * depth_walk) * dt;
}

void DeadReckoning::use(const NavReading& reading) {
  if (const auto* compass = std::get_if<CompassReading>(&reading.value)) {
    use_heading(compass->heading.radians());
  } else if (const auto* ahrs = std::get_if<AttitudeReading>(&reading.value)) {
    const bool gyro = fresh(gyro_at_, time_, sheet_.gyro.rate_hz);
    const double gain = gyro ? 1 / (1 + kAttitudeTime * sheet_.ahrs.rate_hz) : 1;
    roll_ = wrap(roll_ + gain * wrap(ahrs->roll.radians() - roll_));
    pitch_ += gain * (ahrs->pitch.radians() - pitch_);
  } else if (const auto* gyro = std::get_if<GyroReading>(&reading.value)) {
    // The old rate was held until now; the mean of the old and the new rate is more accurate.
    if (fresh(gyro_at_, time_, sheet_.gyro.rate_hz)) {
      const Eigen::Vector3d missed = (euler_rates(gyro->w_B, roll_, pitch_) - euler_rates(w_B_, roll_, pitch_)) *
                                     (to_seconds(time_ - *gyro_at_) / 2);
      roll_ = wrap(roll_ + missed.x());
      pitch_ += missed.y();
      heading_.x() = wrap(heading_.x() + missed.z());
    }
    w_B_ = gyro->w_B;
    gyro_at_ = time_;
  } else if (const auto* velocity = std::get_if<VelocityReading>(&reading.value)) {
    if (velocity_ != Velocity::kNone && over_ground_ == velocity->over_ground) {  // the same for the velocity
      const Eigen::Vector3d missed = attitude() * (velocity->v_B - v_B_) * (to_seconds(time_ - *dvl_at_) / 2);
      x_.head<2>() += missed.head<2>();
      depth_ += missed.z();
    }
    v_B_ = velocity->v_B;
    over_ground_ = velocity->over_ground;
    dvl_at_ = time_;
  } else if (const auto* depth = std::get_if<DepthReading>(&reading.value)) {
    const DepthConfig& d = sheet_.depth;
    const double variance = d.noise * d.noise + d.step * d.step / 12;
    const double gain = depth_variance_ > 0 ? depth_variance_ / (depth_variance_ + variance) : 0;
    depth_ += gain * (depth->depth - depth_);
    depth_variance_ *= 1 - gain;
  } else if (const auto* gps = std::get_if<GpsReading>(&reading.value)) {
    use_position(gps->north_east, Eigen::Matrix2d::Identity() * (gps->sigma * gps->sigma));
  } else if (const auto* lbl = std::get_if<LblReading>(&reading.value)) {
    if (lbl->residual <= kResidualGate * sheet_.lbl.noise) use_position(lbl->north_east, lbl->covariance);
  }
}

void DeadReckoning::use_heading(double heading) {
  const double variance = std::max(1e-10, sheet_.compass.noise.radians() * sheet_.compass.noise.radians());
  Eigen::Matrix2d& P = heading_covariance_;
  if (!heading_known_) {
    heading_.x() = heading;
    P(0, 0) = variance;
    P(0, 1) = P(1, 0) = 0;
    heading_known_ = true;
  } else {
    if (!fresh(compass_at_, time_, sheet_.compass.rate_hz)) {  // the compass is back: start anew
      P_.row(2).setZero();
      P_.col(2).setZero();
      P_(2, 2) = config_.compass_bias_sigma.radians() * config_.compass_bias_sigma.radians();
    }
    const Eigen::Vector2d gain = P.col(0) / (P(0, 0) + variance);
    heading_ += gain * wrap(heading - heading_.x());
    heading_.x() = wrap(heading_.x());
    P = (P - gain * P.row(0)).eval();
  }
  compass_at_ = time_;
}

void DeadReckoning::use_position(const Eigen::Vector2d& north_east, const Eigen::Matrix2d& covariance) {
  const Eigen::Vector2d innovation = north_east - x_.head<2>();
  const Eigen::Matrix2d S = P_.topLeftCorner<2, 2>() + covariance;
  if (!(S.determinant() > 0)) return;
  const Eigen::Matrix2d S_inverse = S.inverse();
  if (innovation.dot(S_inverse * innovation) > kFixGate && ++refused_ <= kRefusedInARow) return;
  if (refused_ > kRefusedInARow) {  // the estimate is wrong, not the fixes
    x_.head<2>() = north_east;
    P_.topRows<2>().setZero();
    P_.leftCols<2>().setZero();
    P_.topLeftCorner<2, 2>() = covariance;
  } else {
    const Eigen::Matrix<double, 6, 2> gain = P_.leftCols<2>() * S_inverse;
    Matrix6 A = Matrix6::Identity();
    A.leftCols<2>() -= gain;
    x_ += gain * innovation;
    P_ = (A * P_ * A.transpose() + gain * covariance * gain.transpose()).eval();
  }
  refused_ = 0;
}

double DeadReckoning::velocity_sigma(double speed) const {
  const double noise = velocity_ == Velocity::kNone ? 0 : sheet_.dvl.noise;
  const double scale = velocity_ == Velocity::kNone ? 0 : speed * std::sqrt(P_(3, 3));
  const double unmeasured = velocity_ == Velocity::kOverGround ? 0 : std::max(P_(4, 4), P_(5, 5));
  return std::sqrt(noise * noise + scale * scale + unmeasured);
}

Navigation DeadReckoning::estimated() const {
  Navigation fix{time_, {attitude(), {x_[0], x_[1], depth_}}, velocity_W(), Matrix6(Matrix6::Zero())};
  if (velocity_ != Velocity::kOverGround) fix.v_WB->head<2>() += x_.tail<2>();
  Matrix6& C = *fix.covariance;
  C.topLeftCorner<2, 2>() = P_.topLeftCorner<2, 2>();
  C(2, 2) = depth_variance_;
  const Eigen::Vector3d down_B = fix.X_WB.rotation.inverse() * Eigen::Vector3d::UnitZ();
  const bool compass = heading_known_ && fresh(compass_at_, time_, sheet_.compass.rate_hz);
  const double heading_variance = P_(2, 2) + (compass ? heading_covariance_(0, 0) : 0);
  const double tilt_variance = sheet_.ahrs.noise.radians() * sheet_.ahrs.noise.radians();
  C.bottomRightCorner<3, 3>() =
      Eigen::Matrix3d::Identity() * tilt_variance + down_B * down_B.transpose() * heading_variance;
  C.block<2, 3>(0, 3) = -P_.block<2, 1>(0, 2) * down_B.transpose();
  C.block<3, 2>(3, 0) = C.block<2, 3>(0, 3).transpose();
  fix.v_sigma = velocity_sigma(fix.v_WB->head<2>().norm());
  return fix;
}

}  // namespace isobath
