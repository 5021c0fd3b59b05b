// Emergencies from raw readings, with no map behind them, through the pipeline and into the results of a run.
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/run/run.hpp>
#include <nlohmann/json.hpp>
#include <tests/perception/mapper_rig.hpp>
#include <tests/support/count_allocations.hpp>
#include <tests/support/data.hpp>
#include <tests/support/events.hpp>

namespace isobath {
namespace {

using test::looking, test::with_range;
using testing::HasSubstr;

struct NoResults : ResultSink {
  void on_ping(const PosedPing&) override {}
  void on_scan(const ScanResult&) override {}
};

Navigation moving(double t, double north, std::optional<double> speed) {
  Navigation fix = test::fix_at(t, north);
  if (speed) fix.v_WB = {*speed, 0, 0};
  return fix;
}

Health report(double t, const std::string& source, HealthState state = HealthState::kOk) {
  Health health;
  health.time = Time(seconds(t));
  health.source = source;
  health.state = state;
  return health;
}

/// Water left before a wall by a vehicle that brakes as soon as the flag is up, and how many readings reached the
/// gate's other side. Nobody keeps a depth map.
double gap_left(double speed, bool says_speed, bool navigated) {
  NoResults sink;
  Pipeline pipeline({}, sink, nullptr);
  double gap = 60.3, v = speed, north = 0;
  constexpr double kDt = 0.02, kBraking = 0.25;  // m/s2
  bool braking = false;
  for (int step = 0; step < 20000 && v > 0; ++step) {
    const double t = step * kDt;
    if (step % 10 == 0 && navigated) pipeline.on_event(moving(t, north, says_speed ? std::optional(v) : std::nullopt));
    if (step % 30 == 0) {
      pipeline.on_event(with_range(looking(0, 20), gap < 50 ? std::optional(gap) : std::nullopt, t));
      braking = braking || pipeline.emergencies().snapshot().has(Emergency::kImminentCollision);
    }
    if (braking) v = std::max(0.0, v - kBraking * kDt);
    north += v * kDt;
    gap -= v * kDt;
  }
  EXPECT_EQ(v, 0) << "never braked";
  return gap;
}

// ledger: S1-44
TEST(Alarms, WithMapUpdatingDisabledTheVehicleStopsBeforeAWall) {
  for (const double speed : {0.5, 1.5, 2.0}) {
    EXPECT_GT(gap_left(speed, true, true), 3 - 0.3) << "the margin, at " << speed << " m/s";
    EXPECT_GT(gap_left(speed, false, true), 3 - 0.5) << "the speed from one fix to the next";
    EXPECT_GT(gap_left(speed, false, false), 3 - 0.3) << "2 m/s while nobody says how fast it is";
  }
}

// ledger: S1-44
TEST(Alarms, AReadingThatTheGateRefusesIsHeardAllTheSame) {
  NoResults sink;
  Pipeline pipeline({}, sink);
  pipeline.on_event(moving(100, 0, 1.5));
  for (const double t : {90.0, 89.4})
    pipeline.on_event(with_range(looking(0, 20), 5.0, t));  // a clock that was set back
  EXPECT_FALSE(pipeline.rejected().empty());
  EXPECT_TRUE(pipeline.emergencies().snapshot().has(Emergency::kImminentCollision));
  for (int i = 0; i < 3; ++i) pipeline.on_event(with_range(looking(0, 20), 45.0, 101 + i));
  EXPECT_FALSE(pipeline.emergencies().snapshot().has(Emergency::kImminentCollision));
  const auto alarms = alarms_of(pipeline.emergencies());
  ASSERT_EQ(alarms.size(), 1U);
  EXPECT_EQ(alarms[0].first, Time(seconds(89.4)));
  EXPECT_FALSE(alarms[0].lasting);
}

// ledger: S1-05, S1-43
TEST(Alarms, HealthReportsRaiseAndClearTheirFlags) {
  NoResults sink;
  Pipeline pipeline({}, sink);
  const auto up = [&](Emergency e) { return pipeline.emergencies().snapshot().has(e); };
  Health vehicle = report(1, "vehicle");
  pipeline.on_event(vehicle);
  EXPECT_EQ(pipeline.emergencies().snapshot().raised, 0U);
  pipeline.on_event(report(2, "sonar", HealthState::kLost));
  EXPECT_TRUE(up(Emergency::kSensorFailure));
  pipeline.on_event(report(3, "sonar"));
  EXPECT_FALSE(up(Emergency::kSensorFailure));
  vehicle.time = Time(seconds(4));
  vehicle.leak = true;
  vehicle.battery_share = 0.1F;
  pipeline.on_event(vehicle);
  EXPECT_TRUE(up(Emergency::kLeak) && up(Emergency::kLowFuel));
  vehicle = report(5, "vehicle");
  pipeline.on_event(vehicle);
  EXPECT_TRUE(up(Emergency::kLeak)) << "latched";
  EXPECT_FALSE(up(Emergency::kLowFuel));
  const auto alarms = alarms_of(pipeline.emergencies());
  ASSERT_EQ(alarms.size(), 3U);
  EXPECT_EQ(to_text(alarms[0]), "low fuel, first at " + to_text(Time(seconds(4))) + ", over at the end");
  EXPECT_EQ(to_text(alarms[1]), "leak, first at " + to_text(Time(seconds(4))) + ", still raised at the end");
  EXPECT_EQ(alarms[2].what, "sensor failure");
  EXPECT_EQ(alarms[2].first, Time(seconds(2)));
}

// Design, section 9.
TEST(Alarms, RangesAndFixesAllocateNothing) {
  Alarms alarms({}, {});
  const Event range = with_range(looking(0, 20), 5.0, 1);
  const Navigation fix = moving(1, 0, 1.5);
  alarms.on_event(range);
  const std::uint64_t before = test::allocations();
  for (int i = 0; i < 10; ++i) {
    alarms.moved(fix);
    alarms.on_event(range);
  }
  EXPECT_EQ(test::allocations(), before);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// ledger: S1-43
TEST(AlarmsOfARun, StandInTheOutcomeTheManifestAndTheReport) {
  const auto folder = test::scratch_folder();
  {
    NativeLogWriter log(folder / "run.mcap");
    for (int i = 0; i < 20; ++i) {
      const double t = 0.6 * i;
      log.write(moving(t, 1.5 * t, 1.5));
      log.write(with_range(looking(0, 20), 20 - 1.5 * t, t));
      Health health = report(t, "vehicle");
      health.leak = i == 10;
      log.write(health);
    }
    log.close();
  }
  RunRequest request;
  request.input = folder / "run.mcap";
  request.out = folder / "out";
  const RunOutcome outcome = run(request);
  ASSERT_EQ(outcome.alarms.size(), 2U);
  EXPECT_EQ(outcome.alarms[0].what, "leak");
  EXPECT_EQ(outcome.alarms[0].first, Time(seconds(6)));
  EXPECT_EQ(outcome.alarms[1].what, "imminent collision");
  // 20 - 1.5 t < 9.3: from t = 7.2 on, raised by the second such reading.
  EXPECT_EQ(outcome.alarms[1].first, Time(seconds(7.8)));
  EXPECT_TRUE(outcome.alarms[1].lasting);
  const auto manifest = nlohmann::json::parse(text_of(request.out / "manifest.json"));
  EXPECT_EQ(manifest["alarms"][1]["what"], "imminent collision");
  EXPECT_EQ(manifest["alarms"][1]["first"], to_text(Time(seconds(7.8))));
  EXPECT_EQ(manifest["alarms"][1]["lasting"], true);
  EXPECT_THAT(text_of(request.out / "report.html"), HasSubstr("Alarm: imminent collision, first at"));
}

}  // namespace
}  // namespace isobath
