// A scene through the whole program: what it writes reads back, what it says of the truth is so.
#include <bit>
#include <gtest/gtest.h>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/mission/plan/planner_budget.hpp>
#include <isobath/scenario/detection_scorer.hpp>
#include <isobath/scenario/mission_chart.hpp>
#include <isobath/scenario/scenario.hpp>
#include <tests/support/data.hpp>
#include <tests/support/kept_scans.hpp>

namespace isobath {
namespace {

class Both : public ResultSink {
 public:
  explicit Both(Simulator& simulator) : judge(simulator) {}
  void on_ping(const PosedPing& ping) override {
    keeper.on_ping(ping);
    judge.on_ping(ping);
  }
  void on_scan(const ScanResult& scan) override {
    keeper.on_scan(scan);
    judge.on_scan(scan);
  }
  test::ScanKeeper keeper;
  DetectionScorer judge;
};

struct Judged {
  TruthScore score;
  test::ScanKeeper keeper;
};

Judged run_scene(Scene scene, const SimulationConfig& simulation, Configuration configuration = {}) {
  SimulatedSource source(std::move(scene), simulation, 1);
  Both sinks(source.simulator());
  source.tell_truth_to(sinks.judge);
  Pipeline pipeline(configuration, sinks);
  while (auto event = source.next()) pipeline.on_event(std::move(*event));
  pipeline.finish();
  return {sinks.judge.score(), sinks.keeper};
}

// The main job without an input: the buoys are found where they are.
// ledger: S6-D04 S6-D07 S6-60
TEST(EmbeddedScene, TheBuoysAreFoundWithinABinOfTheirRangeForEverySeed) {
  for (int seed = 1; seed <= 5; ++seed) {
    const TruthScore score = run_scene(open_scene(""), {.seed = seed, .duration_s = 24}).score;
    int found = 0;
    for (const BodyScore& body : score.bodies) {
      if (!body.name.starts_with("buoy")) continue;
      EXPECT_GT(body.pings_heard, 5) << body.name;
      if (body.scans_found == 0) continue;
      ++found;
      EXPECT_LT(std::abs(body.range_error_mean_m), 50.0 / 44) << body.name << ", seed " << seed;
      EXPECT_TRUE(body.compact);
    }
    EXPECT_GE(found, 1) << "seed " << seed;
    EXPECT_EQ(score.of_bodies + score.of_bottom + score.of_surface + score.of_mirrors + score.false_alarms,
              score.obstacles);
  }
}

// The buoys of the trials: 0.15 x 0.70 m, three quarters of it under water.
// ledger: S6-60 S6-D07
TEST(EmbeddedScene, PandanHasTheBuoysOfTheTrials) {
  const Scene scene = open_scene("");
  int buoys = 0;
  for (const Body& body : scene.bodies) {
    if (!body.name.starts_with("buoy")) continue;
    ++buoys;
    const auto& buoy = std::get<Cylinder>(body.shape);
    EXPECT_NEAR(2 * buoy.radius, 0.15, 1e-9);
    EXPECT_NEAR(buoy.length, 0.70, 1e-9);
    EXPECT_NEAR((buoy.centre.z() + buoy.length / 2) / buoy.length, 0.75, 1e-9) << "under water";
  }
  EXPECT_EQ(buoys, 2);
  EXPECT_EQ(scene.vehicle.start.z(), 0.5);
  EXPECT_EQ(scene.sonars[0].bins, 44);
  EXPECT_EQ(scene.sonars[0].range_m, 50);
}

class MissionScenario : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, MissionScenario,
                         testing::Values("pandan", "simulated_mission_1", "simulated_mission_2", "field_mission_1",
                                         "field_mission_2"),
                         [](const auto& name) { return std::string(name.param); });

// Scene and mission of one file, each of them whole.
// ledger: S6-43 S6-58 S6-60
TEST_P(MissionScenario, HoldsASceneAndThreeMissionPoints) {
  const Scenario scenario =
      load_scenario((test::source_folder() / "scenarios" / (std::string(GetParam()) + ".toml")).string());
  EXPECT_GT(scenario.scene.about.text.size(), 40u);
  EXPECT_EQ(scenario.mission.points.size(), 3u);
  EXPECT_EQ(scenario.scene.sonars.size(), 1u);
  Simulator simulator(scenario.scene, {.duration_s = 1});
  int pings = 0;
  while (const auto event = simulator.next()) pings += std::holds_alternative<Ping>(*event) ? 1 : 0;
  EXPECT_GT(pings, 5);
}

TEST(Scenario, WithoutMissionPointsIsASceneAlone) {
  EXPECT_TRUE(parse_scenario("[scene]\n", "a.toml").mission.points.empty());
}

// What is wrong with either is said with its place in the file.
TEST(Scenario, NamesThePlaceOfWhatIsWrong) {
  const auto problem_of = [](const std::string& toml) {
    try {
      (void)parse_scenario(toml, "a.toml");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(problem_of("[scene]\n[mission]\nspeed = -1\n").find("a.toml:3:"), std::string::npos);
  EXPECT_NE(problem_of("[scene]\n[vehicle]\nspeed = -1\n").find("a.toml:3:"), std::string::npos);
  EXPECT_NE(problem_of("[scene]\n[mission]\ntitle = \"none\"\n"), "") << "a mission without points";
  EXPECT_NE(problem_of("[scene]\n[misison]\n").find("a.toml:2:"), std::string::npos);
}

// Each vehicle of a group sees the others as bodies, and knows which one it is. ledger: S2-50
TEST(Scenario, OfAGroupIsTheSameMissionForEachVehicle) {
  const std::string text =
      "[scene]\n[vehicle]\nname = \"alpha\"\nstart = [1, 2, 3]\n[[group_vehicle]]\nname = \"bravo\"\nstart = [10, 20, "
      "3]\n"
      "[[group_vehicle]]\nname = \"charlie\"\nstart = [50, 20, 3]\n[[sphere]]\ncentre = [99, 0, 3]\n"
      "[search_area]\nlength_m = 60\nbreadth_m = 20\n";
  const Scenario all = parse_scenario(text, "a.toml");
  ASSERT_EQ(all.mission.group.size(), 3u);
  EXPECT_EQ(all.mission.points.size(), 10u + 6u) << "two lanes of three stations and two ends; two waiting places each";
  const Scenario bravo = all.of_vehicle(1);
  EXPECT_EQ(bravo.mission.own, 1u);
  EXPECT_EQ(bravo.scene.vehicle.start, Eigen::Vector3d(10, 20, 3));
  ASSERT_EQ(bravo.scene.bodies.size(), 3u);
  EXPECT_EQ(bravo.scene.bodies[bravo.body_of(0)].name, "alpha");
  EXPECT_EQ(bravo.scene.bodies[bravo.body_of(2)].name, "charlie");
  EXPECT_EQ(all.of_vehicle(0).scene.about.seed, all.scene.about.seed);
  EXPECT_NE(bravo.scene.about.seed, all.of_vehicle(2).scene.about.seed);
  Simulator simulator(bravo.scene);
  simulator.steer_body(bravo.body_of(0), 5, {30, 2, 3}, {1, 0, 0});
  const Body& body = simulator.scene().bodies[bravo.body_of(0)];
  EXPECT_EQ(displacement(body, 5.5), Eigen::Vector3d(29.5, 0, 0)) << "it goes on";
  const auto problem_of = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    try {
      (void)parse_scenario(other, "a.toml");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(problem_of("charlie", "bravo").find("two vehicles have this name"), std::string::npos);
  EXPECT_NE(problem_of("charlie", "../etc").find("not the name of a vehicle"), std::string::npos);
  EXPECT_NE(problem_of("bravo", "").find("not the name of a vehicle"), std::string::npos);
  EXPECT_NE(problem_of("breadth_m = 20", "breadth_m = 9999").find("lanes"), std::string::npos);
}

// What no simulator has is told as a report of the host, so that a log holds it.
// ledger: S6-39
TEST(SimulatedSource, TellsWhatThePlannerIsLeftWhileItsFaultHolds) {
  const Scenario scenario = parse_scenario(
      "[scene]\nduration_s = 8\n[[fault]]\nsource = \"planner\"\nkind = \"wrong_scale\"\nat_s = 3\nfor_s = 2\n"
      "amount = 0.01\n",
      "a.toml");
  SimulatedSource source(scenario.scene, {}, 1);
  std::vector<std::pair<double, double>> told;
  while (const auto event = source.next()) {
    const auto* health = std::get_if<Health>(&*event);
    const auto share = health ? budget_share(*health) : std::nullopt;
    if (share) told.emplace_back(to_seconds(health->time), *share);
  }
  ASSERT_EQ(told.size(), 2u);
  EXPECT_NEAR(told[0].first, 3, 0.2);
  EXPECT_EQ(told[0].second, 0.01);
  EXPECT_NEAR(told[1].first, 5, 0.2);
  EXPECT_EQ(told[1].second, 1);
}

// A target that was not there is a false alarm, one that was there and is not seen is a miss.
TEST(DetectionScorer, TellsWhatIsThereFromWhatIsNot) {
  const std::string toml = R"(
[scene]
duration_s = 30
[vehicle]
start = [0, 0, 20]
speed = 0
[[sonar]]
preset = "micron"
noise_level = 40
spurious_share = 0
[[sphere]]
name = "ball"
centre = [30, 0, 20]
radius = 1
[[sphere]]
name = "behind"
centre = [-30, 0, 20]
radius = 1
)";
  const TruthScore there = run_scene(parse_scene(toml, "a.toml"), {}).score;
  ASSERT_EQ(there.bodies.size(), 1u) << "nothing is heard of what stands behind";
  EXPECT_EQ(there.bodies[0].name, "ball");
  EXPECT_GT(there.bodies[0].scans_found, 3);
  EXPECT_LT(there.bodies[0].range_error_rms_m, 1.2);
  EXPECT_GE(there.bodies[0].delay_pings, 1);
  // The same echoes, with a scene in which the ball is somewhere else.
  SimulatedSource source(parse_scene(toml, "a.toml"), {}, 1);
  std::string moved = toml;
  moved.replace(moved.find("[30, 0, 20]"), 11, "[30, 20, 20]");
  Simulator elsewhere(parse_scene(moved, "b.toml"), {});
  Both sinks(elsewhere);
  Pipeline pipeline({}, sinks);
  while (auto event = source.next()) pipeline.on_event(std::move(*event));
  pipeline.finish();
  EXPECT_GT(sinks.judge.score().false_alarms, 3);
  EXPECT_EQ(sinks.judge.score().of_bodies, 0);
}

// ledger: S6-57
TEST(SimulatedLog, GivesTheSameScansAsTheSceneItCameFrom) {
  const auto file = test::scratch_folder() / "run.mcap";
  const SimulationConfig short_run{.duration_s = 16};
  {
    Simulator simulator(open_scene(""), short_run);
    NativeLogWriter log(file);
    while (const auto event = simulator.next()) {
      std::visit(
          [&log](const auto& e) {
            using T = std::decay_t<decltype(e)>;
            if constexpr (std::is_same_v<T, EchoTruth> || std::is_same_v<T, TrueMotion>) {
              log.write(e);
            } else if constexpr (!std::is_same_v<T, CameraPair>) {  // pictures are not in logs
              EXPECT_TRUE(log.write(Event(e)));
            }
          },
          *event);
    }
    log.close();
  }
  const auto direct = run_scene(open_scene(""), short_run).keeper.scans;
  const auto replayed = test::scans_of(file, {}).scans;
  ASSERT_EQ(direct.size(), replayed.size());
  ASSERT_GT(direct.size(), 3u);
  for (std::size_t i = 0; i < direct.size(); ++i) {
    ASSERT_EQ(direct[i].obstacles.size(), replayed[i].obstacles.size());
    for (std::size_t k = 0; k < direct[i].obstacles.size(); ++k) {
      EXPECT_EQ(direct[i].obstacles[k].range_m, replayed[i].obstacles[k].range_m);
      EXPECT_EQ(direct[i].obstacles[k].existence, replayed[i].obstacles[k].existence);
    }
  }
}

TEST(SimulatedLog, HoldsTheTruthBitForBit) {
  const auto file = test::scratch_folder() / "truth.mcap";
  std::vector<TrueMotion> motions;
  std::vector<EchoTruth> echoes;
  Simulator simulator(open_scene(""), {.duration_s = 2});
  NativeLogWriter log(file);
  while (const auto event = simulator.next()) {
    if (const auto* m = std::get_if<TrueMotion>(&*event)) {
      motions.push_back(*m);
      log.write(*m);
    } else if (const auto* e = std::get_if<EchoTruth>(&*event)) {
      echoes.push_back(*e);
      log.write(*e);
    }
  }
  log.close();
  TruthReader reader(file);
  std::size_t m = 0, e = 0;
  while (const auto truth = reader.next()) {
    if (const auto* motion = std::get_if<TrueMotion>(&*truth)) {
      const TrueMotion& wrote = motions.at(m++);
      EXPECT_EQ(motion->time, wrote.time);
      EXPECT_EQ(motion->state.X_WB.translation, wrote.state.X_WB.translation);
      EXPECT_EQ(motion->state.v_B, wrote.state.v_B);
      EXPECT_EQ(motion->state.w_B, wrote.state.w_B);
      EXPECT_EQ(motion->altitude_m, wrote.altitude_m);
      EXPECT_EQ(motion->current_W, wrote.current_W);
    } else {
      const auto& labels = std::get<EchoTruth>(*truth);
      const EchoTruth& wrote = echoes.at(e++);
      EXPECT_EQ(labels.time, wrote.time);
      EXPECT_EQ(labels.sonar, wrote.sonar);
      EXPECT_TRUE(labels.labels == wrote.labels);
    }
  }
  EXPECT_EQ(m, motions.size());
  EXPECT_EQ(e, echoes.size());
}

// The map of the plane has no use for a fan that stands upright; the map in three dimensions has.
// ledger: S5-07
TEST(Pipeline, KeepsVerticalFansApartFromTheMapOfThePlane) {
  const auto scene = load_scenario((test::source_folder() / "scenarios/bridge.toml").string()).scene;
  SimulatedSource source(scene, {.duration_s = 2}, 1);
  test::ScanKeeper keeper;
  Pipeline pipeline({}, keeper);
  while (auto event = source.next()) pipeline.on_event(std::move(*event));
  pipeline.finish();
  EXPECT_EQ(keeper.pings, 5);
  EXPECT_EQ(pipeline.counts().vertical, 5u);
  EXPECT_EQ(pipeline.counts().pings, 5u);
}

TEST(SetupOfAScenario, HasItsMissionAndTheVehicleOfItsFile) {
  const auto file = test::source_folder() / "scenarios" / "simulated_mission_1.toml";
  const Scenario scenario = load_scenario(file.string());
  const MissionSetup setup = setup_of(scenario);
  EXPECT_EQ(setup.plan.title, scenario.mission.title);
  EXPECT_EQ(setup.plan.points.size(), 3u);
  const VehicleModel remus = load_vehicle((test::source_folder() / "vehicles" / "remus100.toml").string());
  EXPECT_EQ(setup.vehicle.half_width_m, parameters_of(remus).half_width_m);
  EXPECT_EQ(setup.vehicle.limits.turning_radius, remus.limits.turning_radius);
  EXPECT_FALSE(setup.chart.depths) << "the scenario names no prior";
}

TEST(SetupOfAScenario, HasTheChartOfItsPrior) {
  const auto file = test::source_folder() / "scenarios" / "charted_shoals.toml";
  EXPECT_TRUE(setup_of(load_scenario(file.string())).chart.depths);
}

// A step that the vehicle's sonar cannot follow is refused before the run. ledger: S2-16 S2-18
TEST(Scenario, RefusesAStepThatNoScanningSonarCanFollow) {
  const auto problem_of = [](const std::string& sonar, const std::string& scan) -> std::string {
    const std::string text = "[scene]\ntitle = \"steps\"\n[[sonar]]\npreset = \"" + sonar +
                             "\"\n[[mission_point]]\nnorth = 40\ntask = \"look_about\"\n"
                             "[[task_step]]\ntask = \"look_about\"\n" +
                             scan;
    try {
      (void)parse_scenario(text, "steps.toml");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(problem_of("micron", "sector_deg = 360\n"), "");
  EXPECT_EQ(problem_of("oculus_m750d", ""), "");
  EXPECT_NE(problem_of("oculus_m750d", "sector_deg = 360\n").find("the vehicle has no scanning sonar"),
            std::string::npos);
  EXPECT_NE(problem_of("micron", "sector_deg = 360\nsonar_range_m = 5\n").find("cannot do this"), std::string::npos);
}

}  // namespace
}  // namespace isobath
