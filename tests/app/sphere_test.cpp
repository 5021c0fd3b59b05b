// The spherical grid as a user meets it: `isobath sphere`, a room scanned along a path; and what a run says of it.
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
using test::ends_with_one_line;
using testing::HasSubstr;

std::string polygon_room() { return (test::source_folder() / "scenarios/polygon_room.toml").string(); }

// ledger: S4-D01 S4-35
TEST(Sphere, WritesThreePicturesOfARoomAndSaysWhatIsInItsGrid) {
  const auto folder = test::scratch_folder();
  const std::string room = polygon_room();
  const auto result = test::isobath({"sphere", room, "--out", (folder / "out").string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["scans"], 10);
  EXPECT_EQ(json["beams"], 1440);
  EXPECT_LT(json["median_error_m"], 0.25);
  for (const char* name : {"plan.png", "above.png", "solid.png"}) {
    EXPECT_EQ(test::content_of(folder / "out" / name).substr(1, 3), "PNG") << name;
  }
  const auto few = test::isobath({"sphere", room, "--out", (folder / "few").string(), "--scans", "3", "--range", "12",
                                  "--rule", "maximum_response"});
  EXPECT_THAT(few.out, HasSubstr("3 scans, 432 beams"));
}

// Known walls stand in the grid before they are heard, move with the vehicle, and keep their state. ledger: S4-14 S4-15
TEST(Sphere, HoldsKnownWallsWhereverTheVehicleGoes) {
  const auto folder = test::scratch_folder();
  const std::string room = polygon_room();
  const auto known_after = [&](const std::string& scans) {
    const auto run =
        test::isobath({"sphere", room, "--out", (folder / "out").string(), "--known", "--scans", scans, "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out);
  };
  for (const char* scans : {"1", "10"}) {
    const auto json = known_after(scans);
    EXPECT_GT(json["known"], 300) << scans;
    EXPECT_LT(json["known_error_m"], 0.5) << scans;
  }
  EXPECT_EQ(
      nlohmann::json::parse(test::isobath({"sphere", room, "--out", (folder / "out").string(), "--json"}).out)["known"],
      0);
}

// ledger: S4-17
TEST(Sphere, DrawsTheSameGridInWiderCells) {
  const auto folder = test::scratch_folder();
  const std::string room = polygon_room();
  const auto run = test::isobath({"sphere", room, "--out", (folder / "out").string(), "--coarser", "4", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_LT(json["coarse_cells"].get<int>(), json["cells"].get<int>() / 4);
  EXPECT_GT(json["coarse_cells"].get<int>(), json["cells"].get<int>() / 64);
  EXPECT_EQ(test::content_of(folder / "out/coarse.png").substr(1, 3), "PNG");
  EXPECT_THAT(test::isobath({"sphere", room, "--out", (folder / "out").string(), "--coarser", "7"}),
              ends_with_one_line(HasSubstr("bucket")));
}

/// Two poles, 1 m apart along the path of a vehicle that passes them and sees them from 25 m at last: there a direction
/// of 2.5 degrees and a layer are 1.1 m wide.
constexpr const char* kTwoPoles = R"(
[scene]
title = "Two poles"
[vehicle]
start = [-25, 4, 5]
speed = 1
[[waypoint]]
north = 25
east = 4
depth = 5
[[prism]]
name = "poles"
arcs = [[0, 0, 0.1, 0, 360], [1, 0, 0.1, 0, 360]]
top = 0
bottom = 10
)";

// The grid has one target there. A finer grid of the same echoes has two, where the poles stand. ledger: S4-17
TEST(Sphere, LooksCloserAtTwoPolesThatTheGridTakesForOne) {
  const auto folder = test::scratch_folder();
  const auto scene = test::write(folder / "poles.toml", kTwoPoles).string();
  for (const char* seed : {"1", "2", "3"}) {
    const auto run = test::isobath({"sphere", scene, "--sonar", "simulated_2_5", "--seed", seed, "--scans", "26",
                                    "--closer", "4", "--out", (folder / "out").string(), "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto targets = nlohmann::json::parse(run.out)["targets"];
    ASSERT_EQ(targets.size(), 1u) << seed;
    auto peaks = targets[0]["peaks"];
    ASSERT_EQ(peaks.size(), 2u) << seed;
    if (peaks[0]["north_m"] > peaks[1]["north_m"]) std::swap(peaks[0], peaks[1]);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(peaks[static_cast<std::size_t>(i)]["north_m"].get<double>(), i, 0.2) << seed;
      EXPECT_NEAR(peaks[static_cast<std::size_t>(i)]["east_m"].get<double>(), 0, 0.2) << seed;
    }
  }
}

// Each target gets a grid of its own beside that of the survey. ledger: S4-18
TEST(Sphere, KeepsAFinerGridOfEachTargetAtOnce) {
  const auto folder = test::scratch_folder();
  const auto run =
      test::isobath({"sphere", polygon_room(), "--closer", "2", "--out", (folder / "out").string(), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto targets = nlohmann::json::parse(run.out)["targets"];
  EXPECT_GT(targets.size(), 5u);
  for (const auto& target : targets) {
    EXPECT_GT(target["closer_cells"], target["cells"]);
    EXPECT_GE(target["peaks"].size(), 1u);
  }
}

// The room by the sonars of three data sheets: their beams, the layers of their resolution. ledger: S4-36
TEST(Sphere, ScansTheRoomWithTheSonarOfADataSheet) {
  const auto folder = test::scratch_folder();
  const auto scanned = [&](const char* sonar) {
    const auto run =
        test::isobath({"sphere", polygon_room(), "--sonar", sonar, "--out", (folder / "out").string(), "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out);
  };
  const auto multibeam = scanned("em_1000_shallow"), head = scanned("wesmar_ss150"), fine = scanned("simulated_2_5");
  EXPECT_EQ(multibeam["beams"], 10 * 60);
  EXPECT_EQ(fine["beams"], 10 * 144);
  EXPECT_EQ(head["beams"], 10 * 55) << "6.5 degrees each, all round";
  EXPECT_EQ(multibeam["directions"], 144 * 72);
  EXPECT_EQ(head["directions"], 56 * 28);
  EXPECT_LT(multibeam["median_error_m"], 0.25);
  EXPECT_LT(fine["median_error_m"], 0.25);
  EXPECT_LT(head["median_error_m"], 0.7) << "layers of 0.5 m";
  EXPECT_THAT(test::isobath({"sphere", polygon_room(), "--sonar", "asdic"}), ends_with_one_line(HasSubstr("asdic")));
}

// To and fro in a room whose corners the chart shows, at 1 % drift, on several seeds. ledger: S4-49
TEST(Sphere, CornersBoundTheDriftThatGrowsWithoutThem) {
  const auto folder = test::scratch_folder();
  const std::string room = polygon_room();
  const auto drifting = [&](int seed, int passes) {
    const auto result =
        test::isobath({"sphere", room, "--out", (folder / "out").string(), "--seed", std::to_string(seed), "--passes",
                       std::to_string(passes), "--drift", "1", "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out);
  };
  for (int seed = 1; seed <= 3; ++seed) {
    const auto json = drifting(seed, 6);
    const auto& navigation = json["navigation"];
    EXPECT_NEAR(navigation["dead_reckoning_last_m"].get<double>(), 0.01 * navigation["way_m"].get<double>(), 1e-6);
    EXPECT_GT(navigation["dead_reckoning_last_m"].get<double>(), 2.4);
    EXPECT_LT(navigation["corrected_worst_m"].get<double>(), 1) << seed;
    EXPECT_GT(navigation["fixes"].get<int>(), 15);
    EXPECT_LT(json["median_error_m"].get<double>(), 0.4) << "the grid holds the walls where they are";
  }
  EXPECT_TRUE(
      test::isobath({"sphere", room, "--out", (folder / "out").string(), "--json"}).out.find("\"navigation\": null") !=
      std::string::npos);
}

/// A wall 24 m ahead of a vehicle that stands still; a fan, a cone that looks ahead and one that looks down.
constexpr const char* kWallAhead = R"(
[scene]
title = "A wall ahead"
duration_s = 8
[bottom]
kind = "flat"
material = "mud"
depth = 12
[vehicle]
start = [0, 0, 5]
speed = 0
[[wall]]
name = "wall"
line = [[24, 14], [24, -14]]
top = 0
bottom = 12
[[sonar]]
preset = "p450_horizontal"
range_m = 40
bins = 300
[[sonar]]
preset = "obstacle_cone"
name = "ahead"
[[sonar]]
preset = "altimeter"
)";

// The sonar of this mission hears nothing within 9 m, and yet its buoys and banks stand in the grid.
// ledger: S4-01 S4-50 S6-09
TEST(SphereOfARun, HoldsWhatASonarWithALongBlindZoneHears) {
  const auto folder = test::scratch_folder();
  const auto run = test::isobath_run(test::source_folder() / "scenarios/pandan.toml", folder / "out");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto sphere = nlohmann::json::parse(run.out)["sphere"];
  EXPECT_GT(sphere["occupied"], 100);
  EXPECT_NE(sphere["ahead"], "blocked");
  EXPECT_GT(sphere["clear_ahead_m"], 20);
  EXPECT_GT(sphere["empty_directions"], 0.3) << "a sonar that looks 60 degrees to each side, between two banks";
}

// The planner gets the cells with echoes as hazards where the settings ask for them, and the mission is the same
// whether the grid turns with the vehicle or stays north up. ledger: S4-20 S4-21 S4-51
TEST(SphereOfARun, TellsThePlannerOfItsEchoesWhereAskedTo) {
  const auto folder = test::scratch_folder();
  const auto told = [&](const std::string& name, const std::string& setting) {
    const auto run = test::isobath_run(test::source_folder() / "scenarios/pandan.toml", folder / name,
                                       {"--set", "simulation.duration_s=40", "--set", setting});
    EXPECT_EQ(run.exit_code, 1) << "the mission is still under way: " << run.err;
    return nlohmann::json::parse(run.out);
  };
  const auto with = told("with", "chart_room.sphere=true"), without = told("without", "chart_room.sphere=false");
  EXPECT_GT(with["mission"]["hazards"]["measured"], 50);
  EXPECT_EQ(without["mission"]["hazards"]["measured"], 0);
  const auto turning = told("turning", "sphere.axes=course_up"), north_up = told("north", "sphere.axes=north_up");
  EXPECT_GT(turning["sphere"]["occupied"], 100);
  EXPECT_EQ(turning["sphere"]["ahead"], north_up["sphere"]["ahead"]);
  EXPECT_EQ(test::content_of(folder / "turning/decisions.json"), test::content_of(folder / "north/decisions.json"));
}

// A tank of 5 m: its walls stand in the grid, and no water behind them is clear.
// ledger: S4-12 S4-50
TEST(SphereOfARun, KnowsTheWallsOfABrightTank) {
  ISOBATH_NEEDS_DATA(tank, "msis-tank");
  const auto folder = test::scratch_folder();
  const auto run = test::isobath_run(tank, folder / "out");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto sphere = nlohmann::json::parse(run.out)["sphere"];
  EXPECT_GT(sphere["occupied"], 500);
  EXPECT_EQ(sphere["ahead"], "blocked");
  EXPECT_LT(sphere["clear_ahead_m"], 3);
  EXPECT_LT(sphere["empty_directions"], 0.1) << "walls all around (S4-11)";
}

// The wall stands in the grid of the run, which says so; its replay says the same.
// ledger: S4-01 S4-12 S4-36 S4-48 S4-50
TEST(SphereOfARun, SaysWhatIsAheadAndIsTheSameInAReplay) {
  const auto folder = test::scratch_folder();
  const auto scene = test::write(folder / "wall.toml", kWallAhead);
  const auto record = (folder / "wall.mcap").string();
  const auto run = test::isobath_run(scene, folder / "out", {"--record", record});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto sphere = nlohmann::json::parse(run.out)["sphere"];
  EXPECT_GT(sphere["pings"], 10);
  EXPECT_GT(sphere["ranges"], 20);
  EXPECT_GT(sphere["scans"], 5);
  EXPECT_EQ(sphere["ahead"], "blocked");
  EXPECT_NEAR(sphere["clear_ahead_m"], 24, 1.5);
  for (const char* name : {"sphere-above.png", "sphere-solid.png"}) {
    EXPECT_EQ(test::content_of(folder / "out" / name).substr(1, 3), "PNG") << name;
  }
  EXPECT_THAT(test::content_of(folder / "out/report.html"), HasSubstr("Echoes around the vehicle"));

  const auto replay = test::isobath_run(record, folder / "again");
  ASSERT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_EQ(nlohmann::json::parse(replay.out)["sphere"], sphere);

  const auto none = test::isobath_run(scene, folder / "none", {"--set", "sphere.keep=false"});
  EXPECT_TRUE(nlohmann::json::parse(none.out)["sphere"].is_null());
  EXPECT_FALSE(std::filesystem::exists(folder / "none/sphere-above.png"));

  const auto coarse = test::isobath_run(scene, folder / "coarse", {"--set", "sphere.sonar=wesmar_ss150"});
  EXPECT_THAT(nlohmann::json::parse(coarse.out)["sphere"]["coarser"].get<std::string>(), HasSubstr("layers of 0.5 m"));
  EXPECT_EQ(test::isobath_run(scene, folder / "bad", {"--set", "sphere.sonar=asdic"}).exit_code, 2);
  EXPECT_THAT(test::isobath({"run", scene.string(), "--set", "sphere.keep=false", "--set", "scan.on=true"}),
              ends_with_one_line(HasSubstr("scan.on")));
}

TEST(Sphere, SaysInOneLineWhatItCannotScan) {
  const auto folder = test::scratch_folder();
  const auto tank = (test::source_folder() / "scenarios/tank.toml").string();
  EXPECT_THAT(test::isobath({"sphere", (folder / "nowhere.toml").string()}), ends_with_one_line(HasSubstr("nowhere")));
  EXPECT_EQ(test::isobath({"sphere", tank, "--out", (folder / "out").string()}).exit_code, 2);
  EXPECT_EQ(test::isobath({"sphere"}).exit_code, 2);
}

}  // namespace
}  // namespace isobath
