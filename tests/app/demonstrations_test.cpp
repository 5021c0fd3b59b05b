// What the commands of docs/demonstrations.md rest on, each on a small case; the page itself: scripts/demonstrations.
#include <cmath>
#include <fmt/format.h>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string scenario(const std::string& name) { return (test::source_folder() / "scenarios" / name).string(); }

class Demonstrations : public testing::Test {
 protected:
  json told(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const auto result = test::isobath(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  }
  [[nodiscard]] std::string in(const std::string& name) const { return (folder_ / name).string(); }
  const std::filesystem::path folder_ = test::scratch_folder();
};

// ledger: S1-D06 S1-12 S1-E01
TEST_F(Demonstrations, TheExampleOfAQuadtreeHas19LeavesAnd25Words) {
  told({"convert", scenario("quadtree_example.asc"), in("map"), "--set", "prior.sign=down", "--set", "prior.epsg=32631",
        "--set", "prior.datum_offset_m=[0]", "--set", "depth_map.area_m=256", "--set", "depth_map.pixel_m=8"});
  const json map = told({"info", in("map"), "--picture", in("tree.png")});
  EXPECT_EQ(map["trees"]["prior"]["leaves"], 19);
  EXPECT_EQ(map["trees"]["prior"]["words"], 25);
  EXPECT_EQ(test::content_of(folder_ / "tree.png").substr(1, 3), "PNG");
}

// Soundings scattered over 1.6 km2: neighbours differ, so nearly every pixel is a leaf. What a mission of a minute has
// measured fills few. ledger: S1-D07
TEST_F(Demonstrations, ATreeSavesMuchOnWhatSensorsHaveSeenAndLittleOnASurvey) {
  told({"convert", scenario("lake_soundings.csv"), in("survey"), "--origin", "43.6,-71.33", "--set", "prior.sign=down",
        "--set", "prior.epsg=4326", "--set", "prior.datum_offset_m=[0]", "--set", "depth_map.area_m=1280", "--set",
        "depth_map.pixel_m=2.5"});
  const json run =
      json::parse(test::isobath({"run", scenario("winnipesaukee.toml"), "--set", "simulation.duration_s=60", "--map",
                                 in("survey"), "--out", in("run"), "--json"})
                      .out);
  const json trees = told({"info", in("survey")})["trees"];
  constexpr int kPixels = 512 * 512;
  EXPECT_GT(trees["prior"]["leaves"], 0.9 * kPixels);
  EXPECT_GT(run["depth"]["sensed_pixels"], 20);
  EXPECT_GT(trees["sensed"]["leaves"], run["depth"]["sensed_pixels"]);
  EXPECT_LT(trees["sensed"]["words"], 0.01 * kPixels);
}

// ledger: S1-D05 S1-29 S1-32 S1-70
TEST_F(Demonstrations, TheWindowShiftsInARunAndLosesNoReading) {
  std::string depth[2];
  for (const bool aside : {false, true}) {
    const std::string out = in(aside ? "aside" : "one");
    const json run = told({"run", scenario("long_lane.toml"), "--set", "simulation.duration_s=250", "--set",
                           std::string("depth.background=") + (aside ? "true" : "false"), "--out", out});
    const json& map = run["depth"];
    EXPECT_GE(map["shifts"], 3);
    EXPECT_EQ(map["lost"], 0);
    EXPECT_GT(map["readings"], 2000);
    for (const char* gap : {"shift_gap_mean_s", "shift_gap_least_s"}) {
      EXPECT_NEAR(map[gap].get<double>(), 64 / 1.5, 0.6) << "64 m at 1.5 m/s, within one cycle of 0.6 s";
    }
    EXPECT_GT(run["rates"]["depth_map_share"], 0) << "processor time of a cycle that the map takes";
    EXPECT_LE(run["rates"]["shift_waits"], aside ? map["shifts"].get<int>() : 0)
        << "how many must wait: up to the disk";
    depth[aside] = test::content_of(out + "/depth.tif");
  }
  EXPECT_EQ(depth[0], depth[1]) << "a shift in a thread of its own gives the same map";
}

// A reading costs a fixed time and a time for each pixel that it has evidence on. In open water these are the pixels of
// the beam's plan, a sector: twice as many in a beam twice as wide, four times as many at twice the range.
// ledger: S1-E03
TEST_F(Demonstrations, ARunSaysOnHowManyPixelsAReadingHasEvidence) {
  constexpr double kPixel = 0.5, kDegree = 0.017453292519943295;
  for (const double width_deg : {6.0, 12.0}) {
    const std::string scene = in(fmt::format("{}.toml", width_deg));
    test::write(scene, fmt::format("[scene]\ntitle = \"open water\"\nduration_s = 20\n[vehicle]\nstart = [0, 0, 30]\n"
                                   "speed = 1\n[[waypoint]]\nnorth = 15\neast = 12\ndepth = 30\n[[sonar]]\n"
                                   "preset = \"obstacle_cone\"\nwidth_deg = {0}\nheight_deg = {0}\n",
                                   width_deg));
    for (const double range : {20.0, 40.0}) {
      const json map = told({"run", scene, "--out", in("open"), "--set", fmt::format("evidence.range_cap_m={}", range),
                             "--set", fmt::format("simulation.seed={}", width_deg + range)})["depth"];
      ASSERT_GT(map["applied"], 5);
      EXPECT_NEAR(map["pixels_examined"], map["applied"].get<double>() * map["pixels_per_reading"].get<double>(), 0.01);
      const double sector = range * range * width_deg / 2 * kDegree / (kPixel * kPixel);
      EXPECT_NEAR(map["pixels_per_reading"], sector, 0.1 * sector) << width_deg << " degrees, " << range << " m";
      EXPECT_EQ(json::parse(test::content_of(folder_ / "open" / "manifest.json"))["depth"]["pixels_per_reading"],
                map["pixels_per_reading"]);
    }
  }
}

// The readings of six sonars, every 0.6 s, are mapped while the mission is planned; the prefilter merges similar ones.
// ledger: S1-D01 S1-D04 S1-26
TEST_F(Demonstrations, ARunSaysWhenAnUnchartedRockStandsInTheMap) {
  const json run = told({"run", scenario("winnipesaukee.toml"), "--set", "simulation.seed=1", "--set",
                         "depth_map.area_m=512", "--out", in("lake")});
  ASSERT_EQ(run["truth"]["mapped"].size(), 1u);
  const json& rock = run["truth"]["mapped"][0];
  EXPECT_EQ(rock["name"], "obstacle C");
  EXPECT_LE(rock["first_echo_m"], 50);
  const double delay_s = rock["in_map_s"].get<double>() - rock["first_echo_s"].get<double>();
  EXPECT_GT(delay_s, 0);
  EXPECT_LT(delay_s, 4);
  const json& map = run["depth"];
  EXPECT_GT(map["readings"], 4000);
  EXPECT_GT(map["merged"], 1000);
  EXPECT_EQ(map["merged"].get<int>() + map["applied"].get<int>(), map["readings"]);
  EXPECT_EQ(map["lost"], 0);
}

/// From the rock's first echo until a route goes round it; negative: before.
double route_round_the_rock_s(const json& run, const std::string& out) {
  const json told = json::parse(test::content_of(out + "/decisions.json"));
  for (const json& decision : told["decisions"]) {
    if (decision["reason"].get<std::string>().find("an obstacle of the depth map") == std::string::npos) continue;
    return 1e-9 * decision["time_ns"].get<double>() - run["truth"]["mapped"][0]["first_echo_s"].get<double>();
  }
  return 1e9;
}

// The first mission hears the rock that is not on its chart and plans round it; the second one, on the map of the
// first, plans round it before its sonar hears it. ledger: S1-26
TEST_F(Demonstrations, ASecondMissionKnowsTheRockOfTheFirst) {
  const std::string map = in("map");
  const auto lag_s = [&](const std::string& seed) {
    const std::string out = in("lake" + seed);
    const auto sailed = test::isobath({"run", scenario("winnipesaukee.toml"), "--set", "simulation.seed=" + seed,
                                       "--set", "simulation.duration_s=190", "--set", "depth_map.area_m=512", "--map",
                                       map, "--out", out, "--json"});
    EXPECT_EQ(sailed.exit_code, 1) << "the mission is still under way: " << sailed.err;
    const json run = json::parse(sailed.out);
    return route_round_the_rock_s(run, out);
  };
  EXPECT_GT(lag_s("1"), 0);
  EXPECT_LT(lag_s("2"), -10);
}

// ledger: S1-D08 S1-50
TEST_F(Demonstrations, DelayRisesAndFalseObstaclesFallWithTheBaseConfidence) {
  const json delay = told({"delay", "--seeds", "2", "--readings", "400", "--out", in("delay")});
  ASSERT_EQ(delay["bases"].size(), 14u);
  for (std::size_t i = 1; i < delay["bases"].size(); ++i) {
    const json &before = delay["bases"][i - 1], &now = delay["bases"][i];
    EXPECT_GT(now["delay_s"], before["delay_s"]);
    EXPECT_LE(now["false_standing"]["mean"], before["false_standing"]["mean"]);
    EXPECT_GE(now["false_standing"]["most"], now["false_standing"]["least"]);
  }
  EXPECT_EQ(test::content_of(folder_ / "delay/delay.png").substr(1, 3), "PNG");
}

// ledger: S4-D03 S4-04 S4-06
TEST_F(Demonstrations, SphereComparesItsCellsWithThoseOfOtherGrids) {
  const json room = told({"sphere", scenario("polygon_room.toml"), "--scans", "1", "--out", in("room")});
  const int layers[] = {86, 102, 119}, uniform[] = {334, 667, 1334};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(room["sizes"][i]["layers"], layers[i]);
    EXPECT_EQ(room["sizes"][i]["uniform_layers"], uniform[i]);
    EXPECT_EQ(room["sizes"][i]["cells"], 10368 * layers[i]);
  }
  EXPECT_NEAR(room["sizes"][1]["cubic_cells"].get<double>(), 2.4e9, 0.05e9);
}

/// By how much the curve of a range group lies below the theory of its signal-to-noise ratio, at most, for false-alarm
/// rates of 0.01 to 0.04; and above it.
std::pair<double, double> below_and_above_theory(const json& group) {
  double below = 0, above = 0;
  for (const json& theory : group["theory"]["f_p"]) {
    const double f = theory[0];
    const json& curve = group["roc"]["threshold_f_p"];
    std::size_t i = 1;
    while (curve[i][1].get<double>() < f) ++i;
    const double f0 = curve[i - 1][1], f1 = curve[i][1], p0 = curve[i - 1][2], p1 = curve[i][2];
    const double difference = p0 + (f - f0) / (f1 - f0) * (p1 - p0) - theory[1].get<double>();
    below = std::max(below, -difference);
    above = std::max(above, difference);
  }
  return {below, above};
}

// ledger: S6-D01 S6-D02 S6-D03 S6-06 S6-07 S6-08 S6-09
TEST_F(Demonstrations, ASimulatedLogIsCalibratedByItsOwnTruth) {
  told({"sim", scenario("noise_lake.toml"), "--duration", "60", "--seed", "3", "--out", in("lake.mcap")});
  const json lake =
      told({"calibrate", in("lake.mcap"), "--truth", "--out", in("model"), "--set", "calibration.blanking_m=10.2"});
  EXPECT_GT(lake["background_pings"], 200);
  EXPECT_GT(lake["marked_pings"], 200);
  int gaussian = 0;
  for (const json& group : lake["groups"]) {
    for (const json& law : group["noise_fits"]["laws"]) {
      if (law["law"] == "gaussian") gaussian += law["p_value"].get<double>() >= 0.05;
      if (law["law"] == "rayleigh") {
        EXPECT_LT(law["p_value"].get<double>(), 0.05);
      }
    }
  }
  EXPECT_GE(gaussian, 6) << "of 8 range groups";
  int as_in_theory = 0;
  for (const json& group : lake["groups"]) {
    const auto [below, above] = below_and_above_theory(group);
    as_in_theory += below < 0.03 && above < 0.03;  // one of 40 marked cells
  }
  EXPECT_GE(as_in_theory, 7) << "of 8 range groups; in one, bodies lie in the shadow of others";
  int blind = 0;
  const json model = test::json_of(folder_ / "model/sensor_model.json");
  for (const json& bin : model["bins"]) blind += bin.value("blind", false);
  EXPECT_EQ(blind, 9);
  EXPECT_EQ(model["bins"].size(), 44u);

  // At sea, with f = 0.03: neither law.
  told({"sim", scenario("noise_sea.toml"), "--duration", "60", "--seed", "3", "--out", in("sea.mcap")});
  const json sea = told({"calibrate", in("sea.mcap"), "--truth", "--out", in("at_sea"), "--set",
                         "calibration.blanking_m=10.2", "--set", "calibration.false_alarm=0.03"});
  int not_rejected = 0;
  for (const json& group : sea["groups"]) {
    for (const json& law : group["noise_fits"]["laws"]) {
      if (law["law"] != "k") not_rejected += law["p_value"].get<double>() >= 0.05;
    }
  }
  EXPECT_EQ(not_rejected, 0) << "of 8 range groups and two laws";
  double worst = 0;
  for (const json& group : sea["groups"]) worst = std::max(worst, below_and_above_theory(group).first);
  EXPECT_GT(worst, 0.1) << "the theory promises more than the spiky sea gives";
  blind = 0;
  const json model_at_sea = test::json_of(folder_ / "at_sea/sensor_model.json");
  for (const json& bin : model_at_sea["bins"]) blind += bin.value("blind", false);
  EXPECT_EQ(blind, 9);

  const auto water = test::isobath({"calibrate", in("lake.mcap"), "--truth", "--sonar", "other", "--out", in("no")});
  EXPECT_THAT(water, test::ends_with_one_line(HasSubstr("no ground truth of a sonar other")));
}

// ledger: S5-D07 S5-D08
TEST_F(Demonstrations, HelixSaysHowItSwingsAndConverges) {
  const json helix = told({"helix", "--height", "20", "--set", "helix.advance=4", "--out", in("helix")});
  EXPECT_GT(helix["swing"]["heading_second_deg"], helix["swing"]["heading_first_deg"]);
  EXPECT_LT(std::abs(helix["swing"]["correlation"].get<double>()), 0.35) << "a quarter of a turn apart";
  for (const json& one : helix["convergence"]) EXPECT_LT(one["last_m"], 0.01);
}

}  // namespace
}  // namespace isobath
