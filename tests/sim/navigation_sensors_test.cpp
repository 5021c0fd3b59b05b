#include <cmath>
#include <gmock/gmock.h>
#include <isobath/sim/navigation_sensors.hpp>

namespace isobath {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

NavigationSensorsConfig all_off() {
  NavigationSensorsConfig c;
  c.compass.on = c.ahrs.on = c.gyro.on = c.dvl.on = c.depth.on = c.gps.on = c.lbl.on = false;
  return c;
}

VehicleState at(double north, double east, double depth, Angle heading = {}) {
  VehicleState s;
  s.X_WB = {Rotation::from_heading(heading), {north, east, depth}};
  s.v_B = {1.5, 0.1, -0.2};
  s.w_B = {0.01, -0.02, 0.03};
  return s;
}

std::vector<NavReading> readings_of(const NavigationSensorsConfig& config, const VehicleState& state, double duration_s,
                                    const NavigationScene& scene = {10.0}, std::uint64_t seed = 1) {
  NavigationSensors sensors(config, seed);
  std::vector<NavReading> all;
  for (double t = 0; t <= duration_s + 1e-9; t += 0.1) {
    const auto& now = sensors.advance(Time(seconds(t)), state, scene);
    all.insert(all.end(), now.begin(), now.end());
  }
  return all;
}

/// Mean and standard deviation of what `get` takes from the readings of type T.
template <class T, class Get>
std::pair<double, double> statistics(const std::vector<NavReading>& readings, Get get) {
  double n = 0, sum = 0, sum2 = 0;
  for (const NavReading& r : readings) {
    if (const auto* value = std::get_if<T>(&r.value)) {
      const double x = get(*value);
      ++n, sum += x, sum2 += x * x;
    }
  }
  return {sum / n, std::sqrt(sum2 / n - sum / n * (sum / n))};
}

TEST(NavigationSensors, NoiseAndBiasAreAsConfigured) {
  NavigationSensorsConfig c = all_off();
  c.compass = {true, 10, Angle::degrees(2), Angle::degrees(0.5)};
  c.ahrs = {true, 10, Angle::degrees(-1), Angle::degrees(0.3), Angle::degrees(0.2)};
  c.gyro.on = c.dvl.on = c.depth.on = c.gps.on = true;
  c.gyro.rate_hz = c.dvl.rate_hz = c.depth.rate_hz = c.gps.rate_hz = 10;
  c.gyro.bias = {0.01, 0, -0.02};
  c.gyro.bias_walk = 0;
  c.dvl.scale_error = 0.02;
  c.dvl.bias = {0, 0.05, 0};
  c.depth.bias = 0.3;
  c.depth.step = 0;
  c.gps.bias = {3, -4};
  c.gps.first_fix_s = 0;
  const auto readings = readings_of(c, at(100, 50, 0.1, Angle::degrees(30)), 400);  // 4001 readings of each

  const auto near = [](std::pair<double, double> found, double mean, double sigma) {
    EXPECT_NEAR(found.first, mean, 4 * sigma / std::sqrt(4001.0));
    EXPECT_NEAR(found.second, sigma, 0.05 * sigma);
  };
  near(statistics<CompassReading>(readings, [](auto r) { return r.heading.degrees(); }), 32, 0.5);
  near(statistics<AttitudeReading>(readings, [](auto r) { return r.roll.degrees(); }), -1, 0.2);
  near(statistics<AttitudeReading>(readings, [](auto r) { return r.pitch.degrees(); }), 0.3, 0.2);
  near(statistics<GyroReading>(readings, [](auto r) { return r.w_B.x(); }), 0.02, 0.001);
  near(statistics<GyroReading>(readings, [](auto r) { return r.w_B.z(); }), 0.01, 0.001);
  near(statistics<VelocityReading>(readings, [](auto r) { return r.v_B.x(); }), 1.53, 0.01);
  near(statistics<VelocityReading>(readings, [](auto r) { return r.v_B.y(); }), 0.152, 0.01);
  near(statistics<DepthReading>(readings, [](auto r) { return r.depth; }), 0.4, 0.02);
  near(statistics<GpsReading>(readings, [](auto r) { return r.north_east.x(); }), 103, 2);
  near(statistics<GpsReading>(readings, [](auto r) { return r.north_east.y(); }), 46, 2);
}

TEST(NavigationSensors, EveryReadingComesAtItsInstantHoweverTheClockSteps) {
  NavigationSensorsConfig c = all_off();
  c.compass.on = c.depth.on = true;
  c.compass.rate_hz = 3;  // a period that is no whole number of nanoseconds
  c.depth.rate_hz = 7;
  const Time start(seconds(1e9));
  for (const double step : {0.01, 0.37, 10.0}) {
    NavigationSensors sensors(c, 1);
    std::vector<Time> compass, depth;
    Time last = start;
    for (int i = 0; i * step <= 100; ++i) {
      for (const NavReading& r : sensors.advance(start + seconds(i * step), at(0, 0, 5), {})) {
        EXPECT_GE(r.time, last);
        last = r.time;
        (r.source == "compass" ? compass : depth).push_back(r.time);
      }
    }
    ASSERT_GE(compass.size(), 295u);
    EXPECT_EQ(compass[1] - start, Duration(333333333));
    EXPECT_EQ(compass[3] - start, Duration(1000000000));
    EXPECT_EQ(compass[294] - start, seconds(98));
    EXPECT_EQ(depth[686] - start, seconds(98));
  }
}

TEST(NavigationSensors, TruthBetweenTwoStepsIsInterpolated) {
  NavigationSensorsConfig c = all_off();
  c.depth = {true, 10, 0, 0, 0};
  NavigationSensors sensors(c, 1);
  sensors.advance(Time{}, at(0, 0, 2), {});
  const auto& readings = sensors.advance(Time(seconds(1)), at(0, 0, 4), {});
  ASSERT_EQ(readings.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(std::get<DepthReading>(readings[i].value).depth, 2.2 + 0.2 * static_cast<double>(i), 1e-9);
  }
}

TEST(NavigationSensors, CompassDeviationFollowsItsFiveCoefficients) {
  NavigationSensorsConfig c = all_off();
  c.compass.on = true;
  c.compass.noise = {};
  c.compass.deviation_deg = {1, 2, 4, 8, 16};
  const auto error = [&](double heading_deg) {
    const auto readings = readings_of(c, at(0, 0, 5, Angle::degrees(heading_deg)), 0);
    return (std::get<CompassReading>(readings.at(0).value).heading - Angle::degrees(heading_deg)).wrapped().degrees();
  };
  EXPECT_NEAR(error(0), 1 + 4 + 16, 1e-9);
  EXPECT_NEAR(error(90), 1 + 2 - 16, 1e-9);
  EXPECT_NEAR(error(180), 1 - 4 + 16, 1e-9);
  EXPECT_NEAR(error(45), 1 + (2 + 4) * std::sqrt(0.5) + 8, 1e-9);
}

TEST(NavigationSensors, GyroBiasWalksWithTheRootOfTime) {
  NavigationSensorsConfig c = all_off();
  c.gyro = {true, 1, {0, 0, 0}, 1e-3, 0};
  double sum2 = 0;
  constexpr int kSeeds = 300;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    NavigationSensors sensors(c, seed);
    sensors.advance(Time{}, {}, {});
    const auto& readings = sensors.advance(Time(seconds(100)), {}, {});
    sum2 += std::pow(std::get<GyroReading>(readings.back().value).w_B.z(), 2);
  }
  EXPECT_NEAR(std::sqrt(sum2 / kSeeds), 1e-3 * std::sqrt(100.0), 0.12 * 1e-2);
}

TEST(NavigationSensors, DvlHearsTheBottomOnlyBetweenTwoAltitudes) {
  NavigationSensorsConfig c = all_off();
  c.dvl.on = true;
  c.dvl.noise = 0;
  NavigationScene scene;
  const auto first = [&](std::optional<double> altitude) {
    scene.altitude_m = altitude;
    const auto readings = readings_of(c, at(0, 0, 5, Angle::degrees(90)), 0, scene);
    return readings.empty() ? std::nullopt : std::optional(std::get<VelocityReading>(readings[0].value));
  };
  EXPECT_FALSE(first(0.49));
  ASSERT_TRUE(first(0.5));
  EXPECT_TRUE(first(80.0)->over_ground);
  EXPECT_TRUE(first(80.0)->v_B.isApprox(at(0, 0, 5).v_B));
  EXPECT_FALSE(first(80.1));
  EXPECT_FALSE(first({}));
  c.dvl.water_track = true;
  scene.current_W = {0, 0.5, 0};  // sets east, where the bow points
  EXPECT_FALSE(first(0.49)) << "too near for a bottom echo, not too far";
  ASSERT_TRUE(first(80.1));
  EXPECT_FALSE(first(80.1)->over_ground);
  EXPECT_NEAR(first({})->v_B.x(), 1.0, 1e-12);
}

TEST(NavigationSensors, GpsFixesOnlyAtTheSurfaceAndAfterItsFirstFixTime) {
  NavigationSensorsConfig c = all_off();
  c.gps.on = true;
  c.gps.first_fix_s = 5;
  NavigationSensors sensors(c, 1);
  std::vector<double> times;
  for (int t = 0; t <= 40; ++t) {
    const bool up = (t >= 10 && t < 20) || t >= 23;
    for (const NavReading& r : sensors.advance(Time(seconds(t)), at(0, 0, up ? 0.2 : 0.5), {})) {
      times.push_back(to_seconds(r.time));
    }
  }
  EXPECT_THAT(times, ElementsAre(15, 16, 17, 18, 19, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40));
}

TEST(NavigationSensors, DropoutLosesItsShareAndDepthIsRounded) {
  NavigationSensorsConfig c = all_off();
  c.depth.on = true;
  c.depth.rate_hz = 10;
  c.depth.step = 0.25;
  c.depth.dropout = 0.3;
  const auto readings = readings_of(c, at(0, 0, 5.02), 400);
  EXPECT_NEAR(static_cast<double>(readings.size()) / 4001, 0.7, 0.03);
  for (const NavReading& r : readings) EXPECT_EQ(std::get<DepthReading>(r.value).depth, 5.0);
}

const std::vector<double> kSquare = {0, 0, 20, 400, 0, 20, 400, 400, 30, 0, 400, 30};

// ledger: S2-47 S1-10
TEST(NavigationSensors, TranspondersFixWithinReachAndFarOnesAreNotHeard) {
  NavigationSensorsConfig c = all_off();
  c.lbl.on = true;
  c.lbl.transponders = kSquare;
  c.lbl.outlier_share = 0;
  const auto readings = readings_of(c, at(200, 200, 10), 300);
  EXPECT_EQ(readings.size(), 501u);
  EXPECT_EQ(readings[1].time, Time(seconds(0.6)));
  // Four transponders square around: J^T J = 2 I, nearly; so the standard deviation is 1 m / sqrt(2).
  const auto [mean, sigma] = statistics<LblReading>(readings, [](const auto& r) { return r.north_east.x(); });
  EXPECT_NEAR(mean, 200, 0.15);
  EXPECT_NEAR(sigma, std::sqrt(0.5), 0.07);
  // Sound that is 1 % faster than the device believes brings all ranges 1 % short: no shift at the centre, one off it.
  const auto shifted = readings_of(c, at(100, 200, 10), 300, {10.0, 1515});
  EXPECT_GT(statistics<LblReading>(shifted, [](const auto& r) { return r.north_east.x(); }).first, 100.5);

  c.lbl.max_range_m = 290;  // from (130, 130) one is at 184 m, two are at 300 m, one is at 382 m
  NavigationSensors deaf(c, 1);
  EXPECT_TRUE(deaf.advance(Time{}, at(130, 130, 10), {}).empty());
  EXPECT_EQ(deaf.lbl_refusals(), 1);
}

TEST(NavigationSensors, SameSeedSameReadingsAndNoSensorDisturbsAnother) {
  NavigationSensorsConfig c;
  c.lbl.transponders = kSquare;
  const auto text = [](const std::vector<NavReading>& readings, const std::string& except) {
    std::vector<std::pair<Time, double>> values;
    for (const NavReading& r : readings) {
      if (r.source == except) continue;
      struct First {
        double operator()(const CompassReading& v) const { return v.heading.radians(); }
        double operator()(const AttitudeReading& v) const { return v.pitch.radians(); }
        double operator()(const GyroReading& v) const { return v.w_B.z(); }
        double operator()(const VelocityReading& v) const { return v.v_B.z(); }
        double operator()(const DepthReading& v) const { return v.depth; }
        double operator()(const GpsReading& v) const { return v.north_east.y(); }
        double operator()(const LblReading& v) const { return v.north_east.y(); }
      };
      values.emplace_back(r.time, std::visit(First{}, r.value));
    }
    return values;
  };
  const VehicleState state = at(200, 100, 0.1);
  const auto before = readings_of(c, state, 20);
  EXPECT_EQ(text(before, ""), text(readings_of(c, state, 20), ""));
  EXPECT_NE(text(before, ""), text(readings_of(c, state, 20, {10.0}, 2), ""));
  NavigationSensorsConfig other = c;
  other.compass.rate_hz = 33;
  other.compass.dropout = 0.5;
  EXPECT_EQ(text(before, "compass"), text(readings_of(other, state, 20), "compass"));
  other = c;
  other.gyro.on = false;
  EXPECT_EQ(text(before, "gyro"), text(readings_of(other, state, 20), "gyro"));
  other = c;
  other.lbl.on = true;
  EXPECT_EQ(text(before, "lbl"), text(readings_of(other, state, 20), "lbl"));
  // A gate that closes for a while does not shift the readings after it.
  NavigationSensors open(c, 1), closed(c, 1);
  for (int t = 0; t < 20; ++t) {
    const auto a = open.advance(Time(seconds(t)), state, {10.0});
    const auto b = closed.advance(Time(seconds(t)), state, {t < 10 ? 0.1 : 10.0});
    if (t > 11) {
      EXPECT_EQ(text(a, ""), text(b, ""));
    }
  }
}

TEST(NavigationSensors, SettingsAreReadAndChecked) {
  NavigationSensorsConfig c;
  auto all = sections(c);
  read_toml("[compass]\nbias_deg = 2\ndeviation_deg = [1, 2, 3, 4, 5]\n[lbl]\ntransponders = [[0, 0, 5], [9, 9, 5]]\n",
            "v.toml", all);
  EXPECT_DOUBLE_EQ(c.compass.bias.degrees(), 2);
  EXPECT_EQ(c.compass.deviation_deg[4], 5);
  EXPECT_EQ(c.lbl.transponders.size(), 6u);
  try {
    read_toml("[gps]\ndropout = 2\n", "v.toml", all);
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("v.toml:2:11: gps.dropout"));
  }
}

}  // namespace
}  // namespace isobath
