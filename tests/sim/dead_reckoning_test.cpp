#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <isobath/sim/dead_reckoning.hpp>

namespace isobath {
namespace {

/// Turn rate and heading: legs of 40 s, with smooth half turns of 10 s between them to one side and the other.
std::pair<double, double> turn(double t) {
  const int leg = static_cast<int>(t / 50);
  const double side = leg % 2 ? -1 : 1;
  const double before = leg % 2 ? std::numbers::pi : 0;
  const double u = std::max(0.0, (t - 50 * leg - 40) / 10);
  constexpr double kTurn = 2 * std::numbers::pi;
  return {side * (std::numbers::pi / 10) * (1 - std::cos(kTurn * u)),
          0.3 + before + side * std::numbers::pi * (u - std::sin(kTurn * u) / kTurn)};
}

/// Up and down at 1.5 m/s, every 0.1 s.
std::vector<VehicleState> sail() {
  std::vector<VehicleState> track;
  Eigen::Vector3d p(0, 0, 20);
  constexpr int kSteps = 20;  // between two states
  constexpr double kStep = 0.1 / kSteps;
  for (int i = 0; i <= 2000; ++i) {
    const auto [rate, heading] = turn(i * 0.1);
    track.push_back({{Rotation::from_heading(Angle::radians(heading)), p}, {1.5, 0, 0}, {0, 0, rate}});
    for (int k = 0; k < kSteps; ++k) {
      const double middle = turn(i * 0.1 + (k + 0.5) * kStep).second;
      p += Eigen::Vector3d(std::cos(middle), std::sin(middle), 0) * (1.5 * kStep);
    }
  }
  return track;
}
const VehicleState& lawnmower(double t) {
  static const std::vector<VehicleState> kTrack = sail();
  return kTrack[static_cast<std::size_t>(std::lround(t * 10))];
}

VehicleState straight(double distance, double depth = 20) {
  VehicleState s;
  s.X_WB.translation = {distance, 0, depth};
  s.v_B = {1.5, 0, 0};
  return s;
}

Eigen::Vector2d error_of(const Navigation& fix, const VehicleState& truth) {
  return (fix.X_WB.translation - truth.X_WB.translation).head<2>();
}

struct Voyage {
  NavigationSensorsConfig actual, sheet;
  DeadReckoningConfig config;
  std::uint64_t seed = 1;
  double duration_s = 160;
  std::function<NavigationScene(double)> scene = [](double) { return NavigationScene{10.0}; };
  std::function<VehicleState(double)> truth = [](double t) { return lawnmower(t); };
  std::function<void(const Navigation&, const VehicleState&)> each = [](const auto&, const auto&) {};

  /// The last fix, and the truth then.
  std::pair<Navigation, VehicleState> operator()() const {
    NavigationSensors sensors(actual, seed);
    DeadReckoning navigator(config, sheet, seed + 1000);
    std::pair<Navigation, VehicleState> last;
    for (int i = 0; i * 0.1 <= duration_s; ++i) {
      const double t = i * 0.1;
      last.second = truth(t);
      const Time now(seconds(t));
      const auto& readings = sensors.advance(now, last.second, scene(t));
      for (const Navigation& fix : navigator.advance(now, last.second, readings)) {
        last.first = fix;
        if (fix.time == now) each(fix, last.second);
      }
    }
    return last;
  }
};

/// Sensors and navigator with errors as the navigator believes them, drawn anew for each seed.
Voyage honest_voyage(std::uint64_t seed) {
  Voyage voyage;
  voyage.seed = seed;
  voyage.config.rate_hz = 1;
  Random random(seed + 77);
  voyage.actual.compass.bias = voyage.config.compass_bias_sigma * random.normal();
  voyage.actual.dvl.scale_error = voyage.config.dvl_scale_sigma * random.normal();
  voyage.actual.gyro.bias[2] = 0.002 * random.normal();
  voyage.actual.dvl.dropout = 0.05;
  voyage.actual.depth.on = voyage.actual.ahrs.on = false;
  voyage.actual.gyro.rate_hz = voyage.actual.dvl.rate_hz = 10;
  voyage.actual.compass.rate_hz = 5;
  voyage.sheet = voyage.actual;
  return voyage;
}

/// Mean normalised squared error of north and east (2 expected) over seeds 1 .. count.
double nees(int count, const std::function<Voyage(std::uint64_t)>& make) {
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    const auto [fix, truth] = make(static_cast<std::uint64_t>(i))();
    const Eigen::Vector2d e = error_of(fix, truth);
    const Eigen::Matrix2d P = fix.covariance->topLeftCorner<2, 2>();
    sum += e.dot(P.inverse() * e) / count;
  }
  return sum;
}

// Bounds of chi-square with 2 n degrees of freedom over n: 99 %, both sides.
constexpr int kSeeds = 60;
constexpr double kLowNees = 1.39, kHighNees = 2.73;

TEST(DeadReckoning, TruthIsTheTruth) {
  Voyage voyage;
  voyage.config.kind = NavigatorKind::kTruth;
  voyage.each = [](const Navigation& fix, const VehicleState& truth) {
    EXPECT_EQ(fix.X_WB.translation, truth.X_WB.translation);
    EXPECT_EQ(fix.X_WB.rotation.quaternion(), truth.X_WB.rotation.quaternion());
    EXPECT_TRUE(fix.covariance->isZero(0));
  };
  voyage();
}

TEST(DeadReckoning, FixesComeAtTheirRate) {
  for (const auto kind : {NavigatorKind::kTruth, NavigatorKind::kDrift, NavigatorKind::kSensors}) {
    DeadReckoningConfig config;
    config.kind = kind;
    config.rate_hz = 3;
    DeadReckoning navigator(config, {}, 1);
    std::vector<Time> times;
    for (int i = 0; i <= 50; ++i) {
      for (const Navigation& fix : navigator.advance(Time(seconds(0.2 * i)), straight(0.3 * i), {})) {
        times.push_back(fix.time);
      }
    }
    ASSERT_EQ(times.size(), 31u);
    EXPECT_EQ(times[1], Time(Duration(333333333)));
    EXPECT_EQ(times[30], Time(seconds(10)));
  }
}

// ledger: S5-02
TEST(DeadReckoning, DriftIsFiveMetresAfterAThousand) {
  for (const double length : {0.0, 100.0}) {
    constexpr int kRuns = 200;
    double sum2 = 0, sum2_100 = 0, stated = 0;
    for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
      DeadReckoningConfig config;
      config.kind = NavigatorKind::kDrift;
      config.rate_hz = 0.1;
      config.drift_length_m = length;
      DeadReckoning navigator(config, {}, seed);
      Eigen::Vector2d error = Eigen::Vector2d::Zero();
      for (int i = 0; i <= 500; ++i) {
        for (const Navigation& fix : navigator.advance(Time(seconds(i)), straight(2.0 * i), {})) {
          error = error_of(fix, straight(2.0 * i));
          stated = std::sqrt((*fix.covariance)(0, 0));
          if (i == 50) sum2_100 += error.squaredNorm() / 2;
        }
      }
      sum2 += error.squaredNorm() / 2;  // two axes
    }
    EXPECT_NEAR(std::sqrt(sum2 / kRuns), 5, 0.15 * 5) << length;
    EXPECT_NEAR(stated, 5, 1e-6);
    // After 100 m: a random walk has sqrt(0.1) of it, a correlated one less: sqrt((1 - (1 - 1/e)) / 9).
    EXPECT_NEAR(std::sqrt(sum2_100 / kRuns), 5 * (length > 0 ? std::sqrt(std::exp(-1.0) / 9) : std::sqrt(0.1)), 0.2);
  }
}

// ledger: S5-02
TEST(DeadReckoning, GpsResetsTheDrift) {
  DeadReckoningConfig config;
  config.kind = NavigatorKind::kDrift;
  config.rate_hz = 1;
  config.drift_share = 0.05;
  DeadReckoning navigator(config, {}, 3);
  Navigation fix;
  for (int i = 0; i <= 500; ++i) fix = navigator.advance(Time(seconds(i)), straight(2.0 * i), {}).back();
  EXPECT_GT(error_of(fix, straight(1000)).norm(), 10);
  const NavReading gps{Time(seconds(501)), "gps", GpsReading{{1002.5, -0.5}, 2}};
  fix = navigator.advance(Time(seconds(501)), straight(1002), std::span(&gps, 1)).back();
  EXPECT_NEAR(fix.X_WB.translation.x(), 1002.5, 1e-9);
  EXPECT_NEAR(fix.X_WB.translation.y(), -0.5, 1e-9);
  EXPECT_NEAR((*fix.covariance)(0, 0), 4, 1e-9);
}

TEST(DeadReckoning, WithoutErrorsItKeepsTheTrack) {
  Voyage voyage;
  NavigationSensorsConfig& c = voyage.actual;
  c.compass.noise = c.ahrs.noise = {};
  c.gyro.noise = c.gyro.bias_walk = c.dvl.noise = c.depth.noise = c.depth.step = 0;
  voyage.truth = [](double t) { return lawnmower(t); };
  const auto [fix, truth] = voyage();
  EXPECT_LT(error_of(fix, truth).norm(), 0.1);  // after 240 m and three half turns
  EXPECT_NEAR(fix.X_WB.translation.z(), 20, 1e-6);
  EXPECT_NEAR((fix.X_WB.rotation.inverse() * truth.X_WB.rotation).log().norm(), 0, 0.01);
  EXPECT_LT((*fix.v_WB - truth.X_WB.rotation * truth.v_B).norm(), 0.03);
}

TEST(DeadReckoning, CovarianceGrowsAsTheErrorDoes) {
  const double found = nees(kSeeds, honest_voyage);
  EXPECT_GT(found, kLowNees);
  EXPECT_LT(found, kHighNees);
}

TEST(DeadReckoning, CovarianceIsHonestAfterFixes) {
  const double found = nees(kSeeds, [](std::uint64_t seed) {
    Voyage voyage = honest_voyage(seed);
    voyage.actual.lbl.on = true;
    voyage.actual.lbl.rate_hz = 0.2;
    voyage.actual.lbl.transponders = {-200, -200, 40, 300, -200, 40, 0, 300, 40};
    voyage.actual.lbl.outlier_share = 0;
    voyage.sheet = voyage.actual;
    return voyage;
  });
  EXPECT_GT(found, kLowNees);
  EXPECT_LT(found, kHighNees);
}

TEST(DeadReckoning, CovarianceIsHonestOverUnknownCurrents) {
  const double found = nees(kSeeds, [](std::uint64_t seed) {
    Voyage voyage = honest_voyage(seed);
    voyage.actual.dvl.water_track = true;
    voyage.sheet = voyage.actual;
    voyage.config.current_walk = 0;
    Random random(seed + 55);
    Eigen::Vector3d current = Eigen::Vector3d::Zero();
    current.x() = 0.3 * random.normal();
    current.y() = 0.3 * random.normal();
    voyage.scene = [current](double t) {
      return NavigationScene{t < 30 ? std::optional(10.0) : std::nullopt, 1500, current};
    };
    return voyage;
  });
  EXPECT_GT(found, kLowNees);
  EXPECT_LT(found, kHighNees);
}

// A vehicle that surfaces learns its position, and the bias of its compass with it.
TEST(DeadReckoning, GpsTellsTheBiasOfTheCompass) {
  Voyage voyage;
  voyage.actual.compass.bias = Angle::degrees(3);
  voyage.config.compass_bias_sigma = Angle::degrees(3);
  voyage.duration_s = 300;
  voyage.truth = [](double t) { return straight(1.5 * t, 0.1); };
  const auto [fix, truth] = voyage();
  EXPECT_NEAR(fix.X_WB.rotation.heading().degrees(), 0, 0.5);
  EXPECT_LT(error_of(fix, truth).norm(), 1.5);
  EXPECT_NEAR(std::sqrt((*fix.covariance)(5, 5)) * 180 / std::numbers::pi, 0.3, 0.2);
}

// ledger: S2-47
TEST(DeadReckoning, SmoothsTransponderFixesWithoutAVelocityLog) {
  Voyage voyage;
  voyage.actual.dvl.on = false;
  voyage.actual.lbl.on = true;
  voyage.actual.lbl.noise = std::sqrt(2.0);  // 1 m each axis at the centre of the square
  voyage.actual.lbl.outlier_share = 0.01;
  voyage.actual.lbl.transponders = {-500, -500, 20, 500, -500, 20, -500, 500, 20, 500, 500, 20};
  voyage.config.speed_walk = 0.05;
  voyage.sheet = voyage.actual;
  voyage.duration_s = 300;
  voyage.truth = [](double t) { return straight(1.0 * t - 150); };
  double sum2 = 0, n = 0;
  voyage.each = [&](const Navigation& fix, const VehicleState& truth) {
    if (fix.time < Time(seconds(30))) return;
    sum2 += error_of(fix, truth).squaredNorm() / 2;
    ++n;
  };
  voyage();
  EXPECT_LT(std::sqrt(sum2 / n), 0.6);  // 40 % less than the fixes have
}

TEST(DeadReckoning, AWildFixIsRefusedAndALastingOneBelieved) {
  DeadReckoningConfig config;
  DeadReckoning navigator(config, {}, 1);
  const auto with_gps = [&](int i, double north) {
    const NavReading gps{Time(seconds(i)), "gps", GpsReading{{north, 0}, 2}};
    return navigator.advance(Time(seconds(i)), straight(0), std::span(&gps, 1)).back().X_WB.translation.x();
  };
  EXPECT_LT(with_gps(0, 0), 10);
  EXPECT_LT(with_gps(1, 500), 10);
  double last = 0;
  for (int i = 2; i < 8; ++i) last = with_gps(i, 500);
  EXPECT_NEAR(last, 500, 10);
}

TEST(DeadReckoning, GarbageThatIsNoNumberIsIgnored) {
  const double nan = std::nan("");
  DeadReckoning navigator({}, {}, 1);
  const std::vector<NavReading> bad = {{Time{}, "compass", CompassReading{Angle::radians(nan)}},
                                       {Time{}, "dvl", VelocityReading{{nan, 0, 0}, true}},
                                       {Time{}, "depth", DepthReading{nan}},
                                       {Time{}, "gps", GpsReading{{0, nan}, 2}},
                                       {Time{}, "gyro", GyroReading{{0, 0, nan}}},
                                       {Time{}, "ahrs", AttitudeReading{Angle::radians(nan), {}}}};
  navigator.advance(Time{}, straight(0), bad);
  const auto& fixes = navigator.advance(Time(seconds(1)), straight(1.5), bad);
  EXPECT_TRUE(fixes.back().X_WB.is_finite());
}

TEST(DeadReckoning, SameSeedSameFixes) {
  const auto last = [](std::uint64_t seed) {
    Voyage voyage = honest_voyage(seed);
    voyage.duration_s = 20;
    return voyage().first;
  };
  EXPECT_EQ(last(1).X_WB.translation, last(1).X_WB.translation);
  EXPECT_EQ(*last(1).covariance, *last(1).covariance);
  EXPECT_NE(last(1).X_WB.translation, last(2).X_WB.translation);
}

}  // namespace
}  // namespace isobath
