// What a closed loop writes down: events for the replay, set-points and decisions for whoever reads.
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/mission/mission_file.hpp>
#include <isobath/runtime/run_log.hpp>
#include <tests/runtime/events.hpp>
#include <tests/runtime/mission_runs.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

constexpr const char* kScene = R"(
[scene]
duration_s = 4
latitude_deg = 1
longitude_deg = 103
[mission]
title = "there and back"
[[mission_point]]
name = "A"
north = 0.1234567890123456
east = 20
)";

Decision decision_at(double t, const std::string& what) {
  Decision d;
  d.time = Time(seconds(t));
  d.agent = "navigator";
  d.what = what;
  d.reason = "leg 1 would run into \"something\"";
  d.obstacle = Eigen::Vector2d(1.5, -2);
  d.leg = 1;
  d.margin_m = -0.25;
  d.way = {{3, 4}, {5, 6}};
  return d;
}

TEST(RunLog, KeepsEventsDecisionsAndWhatTheRunWasMadeOf) {
  const auto file = test::scratch_folder() / "run.mcap";
  const Scenario scenario = parse_scenario(kScene, "s.toml");
  const MissionSetup setup = test::setup_of(scenario);
  std::vector<Decision> decisions;
  {
    RunLog log(file, Simulator(scenario.scene, {}), kScene, {});
    log.attach(setup);
    for (int i = 0; i < 5; ++i) {
      const double t = i;
      log.write(Event(test::fix_at(t, t)));
      if (i == 2) decisions = {decision_at(t, "plan"), decision_at(t, "replan")};
      log.write(Time(seconds(t)), {Angle::degrees(i < 3 ? 10 : 20), 1, 1}, decisions);
    }
    log.close();
  }
  EXPECT_EQ(decisions_in(file), (std::vector<std::string>{decision_json(decisions[0]), decision_json(decisions[1])}));
  const auto source = open_native_log(file, {});
  int fixes = 0;
  while (const auto event = source->next()) fixes += std::holds_alternative<Navigation>(*event) ? 1 : 0;
  EXPECT_EQ(fixes, 5);
  EXPECT_TRUE(source->report().rejected.empty()) << "set-points and decisions are passed over in silence";
  EXPECT_EQ(attachment_in(file, kScenarioAttachment), kScene);
  EXPECT_EQ(attachment_in(file, "nothing"), std::nullopt);
  const MissionPlan read = parse_mission(attachment_in(file, kMissionAttachment).value_or(""), "m.toml");
  ASSERT_EQ(read.points.size(), 1u);
  EXPECT_EQ(read.points[0].north_east, scenario.mission.points[0].north_east) << "to the last bit";
}

// The same vehicle commands in the replay: its sheet comes with the log.
TEST(RunLog, TheVehicleIsThatOfTheRecordedRun) {
  const auto file = test::scratch_folder() / "run.mcap";
  const Scenario scenario = test::scenario_of("simulated_mission_1");
  const Simulator simulator(scenario.scene, {});
  const MissionSetup setup = test::setup_of(scenario);
  {
    RunLog log(file, simulator, kScene, {});
    log.attach(setup);
    log.write(Event(test::fix_at(0, 0)));
    log.close();
  }
  const auto replay = mission_setup(test::source_folder() / "scenarios" / "simulated_mission_1.toml", file, nullptr);
  ASSERT_TRUE(replay);
  EXPECT_EQ(replay->vehicle.half_width_m, setup.vehicle.half_width_m);
  EXPECT_EQ(replay->vehicle.hull_radius_m, setup.vehicle.hull_radius_m);
  EXPECT_EQ(replay->vehicle.braking, setup.vehicle.braking);
  EXPECT_EQ(replay->vehicle.min_speed, setup.vehicle.min_speed);
  EXPECT_EQ(replay->vehicle.can_sway, setup.vehicle.can_sway);
  EXPECT_EQ(replay->vehicle.limits.turning_radius, setup.vehicle.limits.turning_radius);
  EXPECT_EQ(replay->vehicle.limits.max_yaw_rate.radians(), setup.vehicle.limits.max_yaw_rate.radians());
}

TEST(RunLog, DecisionsAreToldApartFromThoseRecorded) {
  const auto file = test::scratch_folder() / "run.mcap";
  const Scenario scenario = parse_scenario(kScene, "s.toml");
  std::vector<Decision> decisions{decision_at(1, "plan"), decision_at(2, "replan"), decision_at(3, "finish")};
  {
    RunLog log(file, Simulator(scenario.scene, {}), kScene, {});
    log.write(Time(seconds(3)), {}, decisions);
    log.close();
  }
  EXPECT_EQ(compare_with_log(decisions, file)->the_same, 3u);
  decisions[1].margin_m = -0.250001;
  EXPECT_EQ(compare_with_log(decisions, file)->the_same, 1u);
  decisions.resize(1);
  EXPECT_EQ(compare_with_log(decisions, file)->the_same, 1u);
  EXPECT_EQ(compare_with_log(decisions, file)->decisions, 3u);
  EXPECT_FALSE(compare_with_log(decisions, test::source_folder() / "README.md"));
}

TEST(RunLog, IsAFileOfItsKind) {
  const Scenario scenario = parse_scenario(kScene, "s.toml");
  EXPECT_THROW(RunLog(test::scratch_folder() / "run.bag", Simulator(scenario.scene, {}), kScene, {}), Error);
}

}  // namespace
}  // namespace isobath
