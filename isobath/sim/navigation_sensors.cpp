#include <algorithm>
#include <cmath>
#include <isobath/sim/navigation_sensors.hpp>

namespace isobath {
namespace {

enum Index { kCompass, kAhrs, kGyro, kDvl, kDepth, kGps, kLbl };

/// The settings that all sensors have, then the sensor's own.
std::vector<Field> with_common(bool* on, double* rate_hz, double* dropout, std::vector<Field> own) {
  std::vector<Field> all = {
      Field::flag("on", on, "Whether the vehicle carries this sensor."),
      Field::real("rate_hz", rate_hz, {0.001, 1000}, "Hz", "Readings per second."),
      Field::real("dropout", dropout, {0, 1}, "1", "Probability that a reading is lost."),
  };
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

Eigen::Vector3d normal3(Random& random) {
  const double x = random.normal();  // one by one: the compiler chooses the order of arguments
  const double y = random.normal();
  const double z = random.normal();
  return {x, y, z};
}
Eigen::Vector2d normal2(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  return {x, y};
}

double deviation_deg(const std::array<double, 5>& abcde, Angle psi) {
  return abcde[0] + abcde[1] * sin(psi) + abcde[2] * cos(psi) + abcde[3] * sin(psi * 2) + abcde[4] * cos(psi * 2);
}

VehicleState between(const VehicleState& a, const VehicleState& b, double share) {
  if (share >= 1) return b;  // exact, bit for bit
  return {interpolate(a.X_WB, b.X_WB, share), a.v_B + (b.v_B - a.v_B) * share, a.w_B + (b.w_B - a.w_B) * share};
}

}  // namespace

std::vector<Field> fields(CompassConfig& c) {
  return with_common(
      &c.on, &c.rate_hz, &c.dropout,
      {Field::degrees("bias_deg", &c.bias, {-180, 180}, "Constant error of the heading."),
       Field::degrees("noise_deg", &c.noise, {0, 90}, "Standard deviation of a reading."),
       Field::numbers("deviation_deg", c.deviation_deg.data(), 5, {-90, 90}, "deg",
                      "Deviation A, B, C, D, E: error A + B sin + C cos + D sin 2 + E cos 2 of the heading.")});
}
std::vector<Field> fields(AttitudeConfig& c) {
  return with_common(&c.on, &c.rate_hz, &c.dropout,
                     {Field::degrees("roll_bias_deg", &c.roll_bias, {-90, 90}, "Constant error of the roll."),
                      Field::degrees("pitch_bias_deg", &c.pitch_bias, {-90, 90}, "Constant error of the pitch."),
                      Field::degrees("noise_deg", &c.noise, {0, 45}, "Standard deviation of a reading.")});
}
std::vector<Field> fields(GyroConfig& c) {
  return with_common(&c.on, &c.rate_hz, &c.dropout,
                     {Field::numbers("bias", c.bias.data(), 3, {-1, 1}, "rad/s", "Bias at the start, each axis of B."),
                      Field::real("bias_walk", &c.bias_walk, {0, 1}, "rad/s/sqrt(s)",
                                  "Random walk of the bias: standard deviation after one second."),
                      Field::real("noise", &c.noise, {0, 1}, "rad/s", "Standard deviation of a reading.")});
}
std::vector<Field> fields(DvlConfig& c) {
  return with_common(
      &c.on, &c.rate_hz, &c.dropout,
      {Field::real("scale_error", &c.scale_error, {-0.5, 0.5}, "1",
                   "Scale error: share by which speeds read too high."),
       Field::numbers("bias", c.bias.data(), 3, {-5, 5}, "m/s", "Constant error, each axis of B."),
       Field::real("noise", &c.noise, {0, 5}, "m/s", "Standard deviation of a reading, each axis."),
       Field::real("min_altitude_m", &c.min_altitude_m, {0, 1000}, "m", "Minimum altitude of a bottom track."),
       Field::real("max_altitude_m", &c.max_altitude_m, {0, 1000}, "m", "Maximum altitude of a bottom track."),
       Field::flag("water_track", &c.water_track, "Whether the DVL tracks the water when it has no bottom track.")});
}
std::vector<Field> fields(DepthConfig& c) {
  return with_common(&c.on, &c.rate_hz, &c.dropout,
                     {Field::real("bias", &c.bias, {-100, 100}, "m", "Constant error."),
                      Field::real("noise", &c.noise, {0, 100}, "m", "Standard deviation of a reading."),
                      Field::real("step", &c.step, {0, 10}, "m",
                                  "Resolution: readings are rounded to multiples of it; 0: no rounding.")});
}
std::vector<Field> fields(GpsConfig& c) {
  return with_common(
      &c.on, &c.rate_hz, &c.dropout,
      {Field::numbers("bias", c.bias.data(), 2, {-1000, 1000}, "m", "Constant error north and east."),
       Field::real("noise", &c.noise, {0, 1000}, "m", "Standard deviation of a fix, each axis."),
       Field::real("max_depth_m", &c.max_depth_m, {0, 11000}, "m",
                   "Maximum depth of a fix; below a metre the fixes stand for those of an acoustic system (USBL)."),
       Field::real("first_fix_s", &c.first_fix_s, {0, 3600}, "s", "Time from surfacing to the first fix.")});
}
std::vector<Field> fields(LblConfig& c) {
  return with_common(
      &c.on, &c.rate_hz, &c.dropout,
      {Field::rows("transponders", &c.transponders, 3, {-1e6, 1e6}, "m", "North, east and depth of each transponder."),
       Field::real("noise", &c.noise, {0, 1000}, "m", "Standard deviation of a range."),
       Field::real("outlier_share", &c.outlier_share, {0, 1}, "1",
                   "Share of ranges that are outliers, too long by a reflected path."),
       Field::real("outlier_m", &c.outlier_m, {0, 10000}, "m", "Largest excess of an outlier."),
       Field::real("max_range_m", &c.max_range_m, {0, 100000}, "m", "Maximum range to a transponder."),
       Field::real("sound_speed", &c.sound_speed, {1300, 1700}, "m/s", "Speed of sound that the device assumes.")});
}
std::vector<Section> sections(NavigationSensorsConfig& c) {
  return {{"compass", "Heading.", fields(c.compass)},
          {"ahrs", "Roll and pitch.", fields(c.ahrs)},
          {"gyro", "Turn rates.", fields(c.gyro)},
          {"dvl", "Velocity over ground by Doppler.", fields(c.dvl)},
          {"depth", "Depth by pressure.", fields(c.depth)},
          {"gps", "Position at the surface.", fields(c.gps)},
          {"lbl", "Position from ranges to transponders.", fields(c.lbl)}};
}

Time Ticker::due() const { return start_ + Duration(std::llround(static_cast<double>(ticks_) * 1e9 / rate_hz_)); }

NavigationSensors::NavigationSensors(const NavigationSensorsConfig& config, std::uint64_t seed)
    : config_(config), gyro_bias_(Eigen::Map<const Eigen::Vector3d>(config.gyro.bias.data())) {
  Random root(seed);
  const auto add = [&](const char* source, bool on, double rate_hz, double dropout) {
    sensors_.push_back({source, on, rate_hz, dropout, root.fork()});
  };
  const NavigationSensorsConfig& c = config_;
  add("compass", c.compass.on, c.compass.rate_hz, c.compass.dropout);
  add("ahrs", c.ahrs.on, c.ahrs.rate_hz, c.ahrs.dropout);
  add("gyro", c.gyro.on, c.gyro.rate_hz, c.gyro.dropout);
  add("dvl", c.dvl.on, c.dvl.rate_hz, c.dvl.dropout);
  add("depth", c.depth.on, c.depth.rate_hz, c.depth.dropout);
  add("gps", c.gps.on, c.gps.rate_hz, c.gps.dropout);
  add("lbl", c.lbl.on, c.lbl.rate_hz, 0);  // LBL loses single ranges, not fixes
  ranges_.reserve(config.lbl.transponders.size() / 3);
}

const std::vector<NavReading>& NavigationSensors::advance(Time now, const VehicleState& truth,
                                                          const NavigationScene& scene) {
  readings_.clear();
  if (!last_) {
    for (Sensor& s : sensors_) s.ticker = Ticker(now, s.rate_hz);
    last_ = now;
    last_state_ = truth;
  }
  if (truth.X_WB.translation.z() > config_.gps.max_depth_m) {
    surfaced_.reset();
  } else if (!surfaced_) {
    surfaced_ = now;
  }
  for (;;) {
    int next = -1;
    for (int i = 0; i < static_cast<int>(sensors_.size()); ++i) {
      const Sensor& s = sensors_[static_cast<std::size_t>(i)];
      if (!s.on || s.ticker.due() > now) continue;
      if (next < 0 || s.ticker.due() < sensors_[static_cast<std::size_t>(next)].ticker.due()) next = i;
    }
    if (next < 0) break;
    Sensor& sensor = sensors_[static_cast<std::size_t>(next)];
    const Time time = sensor.ticker.due();
    sensor.ticker.advance();
    const double span = to_seconds(now - *last_);
    const double share = span > 0 ? to_seconds(time - *last_) / span : 1;
    measure(sensor, next, time, between(last_state_, truth, share), scene);
  }
  if (now > *last_) {
    last_ = now;
    last_state_ = truth;
  }
  return readings_;
}

// Each reading draws its random numbers whether it is kept or not, so that gates do not change later readings.
void NavigationSensors::measure(Sensor& sensor, int index, Time time, const VehicleState& state,
                                const NavigationScene& scene) {
  Random& random = sensor.random;
  const bool lost = random.uniform() < sensor.dropout;
  const auto keep = [&](const auto& value) {
    if (!lost) readings_.push_back({time, sensor.source, value});
  };
  switch (index) {
    case kCompass: {
      const Angle psi = state.X_WB.rotation.heading();
      const Angle deviation = Angle::degrees(deviation_deg(config_.compass.deviation_deg, psi));
      keep(
          CompassReading{(psi + config_.compass.bias + deviation + config_.compass.noise * random.normal()).wrapped()});
      break;
    }
    case kAhrs: {
      const Eigen::Vector2d noise = normal2(random) * config_.ahrs.noise.radians();
      keep(AttitudeReading{(state.X_WB.rotation.roll() + config_.ahrs.roll_bias + Angle::radians(noise.x())).wrapped(),
                           state.X_WB.rotation.pitch() + config_.ahrs.pitch_bias + Angle::radians(noise.y())});
      break;
    }
    case kGyro: {
      keep(GyroReading{state.w_B + gyro_bias_ + normal3(random) * config_.gyro.noise});
      gyro_bias_ += normal3(random) * (config_.gyro.bias_walk / std::sqrt(sensor.rate_hz));
      break;
    }
    case kDvl: {
      if (const auto velocity = measure_velocity(random, state, scene)) keep(*velocity);
      break;
    }
    case kDepth: {
      const double step = config_.depth.step;
      const double depth = state.X_WB.translation.z() + config_.depth.bias + config_.depth.noise * random.normal();
      keep(DepthReading{step > 0 ? std::round(depth / step) * step : depth});
      break;
    }
    case kGps: {
      const Eigen::Vector2d error =
          Eigen::Map<const Eigen::Vector2d>(config_.gps.bias.data()) + normal2(random) * config_.gps.noise;
      const bool fix = surfaced_ && time >= *surfaced_ + seconds(config_.gps.first_fix_s);
      if (fix) keep(GpsReading{state.X_WB.translation.head<2>() + error, config_.gps.noise});
      break;
    }
    default: {
      if (const auto fix = measure_lbl(random, state, scene)) keep(*fix);
      break;
    }
  }
}

std::optional<VelocityReading> NavigationSensors::measure_velocity(Random& random, const VehicleState& state,
                                                                   const NavigationScene& scene) const {
  const DvlConfig& dvl = config_.dvl;
  const Eigen::Vector3d error = Eigen::Map<const Eigen::Vector3d>(dvl.bias.data()) + normal3(random) * dvl.noise;
  const bool bottom = scene.altitude_m && *scene.altitude_m <= dvl.max_altitude_m;
  if (bottom && *scene.altitude_m < dvl.min_altitude_m) return std::nullopt;
  if (!bottom && !dvl.water_track) return std::nullopt;
  Eigen::Vector3d v_B = state.v_B;
  if (!bottom) v_B -= state.X_WB.rotation.inverse() * scene.current_W;
  return VelocityReading{v_B * (1 + dvl.scale_error) + error, bottom};
}

std::optional<LblReading> NavigationSensors::measure_lbl(Random& random, const VehicleState& state,
                                                         const NavigationScene& scene) {
  const LblConfig& lbl = config_.lbl;
  ranges_.clear();
  for (std::size_t i = 0; i + 2 < lbl.transponders.size(); i += 3) {
    const Eigen::Vector3d p_WT = Eigen::Map<const Eigen::Vector3d>(&lbl.transponders[i]);
    const bool lost = random.uniform() < lbl.dropout;
    const bool detour = random.uniform() < lbl.outlier_share;
    const double longer = random.uniform() * lbl.outlier_m;
    const double noise = random.normal() * lbl.noise;
    const double range = (state.X_WB.translation - p_WT).norm() * (lbl.sound_speed / scene.sound_speed) + noise +
                         (detour ? longer : 0.0);
    if (!lost && range > 0 && range <= lbl.max_range_m) ranges_.push_back({p_WT, range});
  }
  // Two ranges, or transponders on a line, leave a mirror ambiguity: no fix, so that it never depends on an older one.
  const auto fix = trilaterate(ranges_, {state.X_WB.translation.z(), std::max(lbl.noise, 1e-9)});
  if (!fix) {
    ++lbl_refusals_;
    return std::nullopt;
  }
  return LblReading{fix->p_W.head<2>(), fix->covariance.topLeftCorner<2, 2>(), fix->residual, fix->ranges};
}

}  // namespace isobath
