#include <fstream>
#include <gtest/gtest.h>
#include <isobath/mission/safety/fault_table.hpp>
#include <nlohmann/json.hpp>
#include <tests/app/program.hpp>
#include <tests/support/pole_scene.hpp>

namespace isobath::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Eval : public testing::Test {
 protected:
  Eval() : folder_(fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write(folder_ / "pole.toml", kPoleScene);
  }
  /// `more` stands before the baselines.
  ProgramResult eval(const std::string& more, const std::vector<std::string>& options = {}) {
    write(folder_ / "small.toml", "[suite]\nscene = \"pole.toml\"\nduration_s = 40\nruns = 1\n" + more +
                                      "[[baseline]]\nhelm = \"no avoidance\"\n");
    std::vector<std::string> arguments{"eval", (folder_ / "small.toml").string(), "--out", (folder_ / "out").string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return isobath(arguments);
  }

  fs::path folder_;
};

TEST_F(Eval, ScoresEveryHelmOnTheSameRuns) {
  const ProgramResult result = eval("", {"--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "") << "no progress in a pipe";
  auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["runs"], 1);
  EXPECT_EQ(json["collisions"], 0) << "the pole is seen and gone round";
  EXPECT_EQ(json["baselines"]["no avoidance"]["collisions"], 1);
  for (const char* file : {"report.html", "results.json", "runs.jsonl"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / file));
  for (const char* beside : {"bars", "files"}) json.erase(beside);
  EXPECT_EQ(json_of(folder_ / "out/results.json"), json);
}

TEST_F(Eval, EndsWithOneBelowTheBarsAndNamesThem) {
  const ProgramResult result = eval("[bars]\npath_ratio_median = 0.5\n");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("path_ratio_median"));
  EXPECT_THAT(result.out, HasSubstr("BELOW THE BAR"));
}

TEST_F(Eval, RunsOneOfManyAlone) {
  const auto json = nlohmann::json::parse(eval("", {"--json", "--runs", "5", "--seed", "30", "--only", "4"}).out);
  EXPECT_EQ(json["runs"], 1);
  EXPECT_EQ(json["first_seed"], 34);
}

// The report and results.json name the command that shows a run on the live page; run takes the same options.
TEST_F(Eval, NamesTheCommandThatShowsARunAndItIsTheSameRun) {
  const auto json =
      nlohmann::json::parse(eval("[vary]\nstart = [1, 2]\ncurrent = 0.2\n", {"--json", "--alone", "--seed", "34"}).out);
  ASSERT_EQ(json["worst"].size(), 1U);
  EXPECT_EQ(json["worst"][0]["watch"], "isobath serve --suite small --set simulation.seed=34");
  const fs::path out = folder_ / "watched";
  const ProgramResult shown = isobath(
      {"run", "--suite", (folder_ / "small.toml").string(), "--set", "simulation.seed=34", "--out", out.string()});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("seed 34: start at north "));
  EXPECT_THAT(shown.out, HasSubstr(json["worst"][0]["conditions"].get<std::string>()));
  std::ifstream runs(folder_ / "out" / "runs.jsonl");
  const auto scored = nlohmann::json::parse(runs);
  const auto mission = json_of(out / "mission.json");
  EXPECT_NEAR(mission["truth"]["least_clearance_m"], scored["scores"][0]["min_clearance_m"], 1e-6);
  EXPECT_TRUE(fs::exists(out / "voxels.png") || fs::exists(out / "occupancy.png")) << "with the pictures of a run";
}

TEST_F(Eval, ARunOfASuiteTakesNoOtherInput) {
  const ProgramResult both = isobath({"run", "scene.toml", "--suite", "bridge"});
  EXPECT_EQ(both.exit_code, 2);
  const ProgramResult none = isobath({"run", "--suite", "brigde"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("bridge"));
  const ProgramResult strait = isobath({"run", "--suite", "strait", "--out", (folder_ / "strait").string()});
  EXPECT_EQ(strait.exit_code, 2);
  EXPECT_THAT(strait.err, HasSubstr("--replay FILE"));
}

// Two ships on the same line, 15 m/s; lengths by 30 and times by 3.
TEST_F(Eval, ReplaysARecordingOfShips) {
  const ProgramResult without = eval("[replay]\non = true\n");
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("none is given; give a table of AIS reports: --replay FILE"));
  std::string table = "time,mmsi,north,east\n";
  for (int t = 0; t <= 900; t += 10) {
    table += std::to_string(t) + ",7," + std::to_string(15 * t) + ",0\n";
    table += std::to_string(t) + ",8," + std::to_string(15 * t) + ",3000\n";
  }
  write(folder_ / "ais.csv", table);
  const std::vector<std::string> replay{"--replay", (folder_ / "ais.csv").string(), "--alone", "--json"};
  EXPECT_EQ(nlohmann::json::parse(eval("[replay]\non = true\n", replay).out)["runs"], 1);
  const ProgramResult vain = eval("", replay);
  EXPECT_EQ(vain.exit_code, 2);
  EXPECT_THAT(vain.err, HasSubstr("replays no recording"));
}

TEST_F(Eval, RunsOneVariantAlone) {
  const std::string sonars = "[[sonar]]\npreset = \"micron\"\nrange_m = 40\n[[sonar]]\nname = \"off\"\non = false\n";
  const auto json = nlohmann::json::parse(eval(sonars, {"--json", "--alone", "--runs", "2", "--variant", "off"}).out);
  EXPECT_EQ(json["runs"], 2);
  EXPECT_EQ(json["variants"].size(), 1u);
  EXPECT_EQ(json["variants"]["off"]["runs"], 2);
  EXPECT_THAT(json["worst"][0]["again"].get<std::string>(), HasSubstr("--variant off"));
  EXPECT_THAT(eval(sonars, {"--variant", "on"}), ends_with_one_line(HasSubstr("one of micron, off")));
}

// The flat fan alone finds no way under the bridge; the vehicle, which cannot stop, circles within its fence until the
// mission ends for that reason. On a held heading, or without the circle, it leaves with both seeds.
// ledger: S5-D05 S6-39
TEST_F(Eval, EndsForWantOfAPathWithinTheFence) {
  for (const char* existence : {"0.95", "0.98"}) {  // the default, and the threshold of the paper
    const ProgramResult result =
        isobath({"eval", "bridge-flat", "--alone", "--runs", "2", "--seed", "109", "--out", folder_ / existence,
                 "--json", "--set", "fls_detector.min_existence=" + std::string(existence)});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["refused"], 2) << existence;
    for (const auto& reason : json["reasons"].items()) EXPECT_THAT(reason.key(), HasSubstr("there is no path"));
  }
}

// 20 m ahead of the start a box and two poles bar 9 m of the way, and a current sets towards them. The vehicle cannot
// stop: where the sonar learns its noise from 100 beams before it decides, it touches a pole. ledger: S6-70 S6-39
TEST_F(Eval, TheSonarDecidesBeforeTheVehicleHasSailedFarBlind) {
  const ProgramResult result = isobath(
      {"eval", "clutter-middle", "--alone", "--runs", "1", "--seed", "70009", "--out", folder_ / "one", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["collisions"], 0);
}

// The position jumps by some 3 m every 5 s. About the vehicle the grid keeps the range of what was heard; in the world
// it jumps with the position. ledger: S6-62
TEST_F(Eval, AGridAboutTheVehicleKeepsRangesWhereFixesJump) {
  const ProgramResult result =
      isobath({"eval", "usbl-fixes", "--runs", "6", "--seed", "1", "--out", folder_ / "out", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const auto& other = json["baselines"]["world-fixed grid"];
  EXPECT_EQ(json["collisions"], 0);
  EXPECT_LT(json["range_error_m_median"].get<double>(), 0.9 * other["range_error_m_median"].get<double>());
  const auto false_near = [](const auto& method) {
    return method["false_obstacles_20m_a_scan"].template get<double>();
  };
  EXPECT_LT(false_near(json), 0.2 * false_near(other)) << "obstacles that the jumps doubled";
  // Thresholds of one scan are scored by what they find: a high one finds the bodies late, a low one finds noise.
  const auto& image = json["baselines"]["image threshold"];
  EXPECT_GT(image["detection_delay_pings_median"].get<double>(),
            2 * json["detection_delay_pings_median"].get<double>());
  EXPECT_GT(false_near(json["baselines"]["histogram threshold"]), 10 * false_near(json));
  EXPECT_GT(json["goals_reached"].get<int>(), image["goals_reached"].get<int>());
}

// Through a reef in the noise of the sea, where a vehicle that does not avoid collides; and how often a replan was for
// nothing. ledger: S6-67
TEST_F(Eval, PassesAReefInSeaNoiseAndTellsItsFalseReplans) {
  const ProgramResult result =
      isobath({"eval", "reef", "--runs", "2", "--seed", "1", "--out", (folder_ / "out").string(), "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["collisions"], 0);
  EXPECT_EQ(json["baselines"]["no avoidance"]["collisions"], 2);
  EXPECT_EQ(json["goals_reached"], 2);
  EXPECT_EQ(json["encounters"], 2);
  EXPECT_GT(json["false_replans"], 0);
  EXPECT_GT(json["replans"].get<int>(), 2 * json["false_replans"].get<int>());
}

// The second lane begins 110 m from the pile, and the sonar reaches 50 m. ledger: S6-66
TEST_F(Eval, RemembersThePileOfTheFirstLaneInTheSecond) {
  const auto shown = [&](const std::vector<std::string>& more, const std::string& runs) {
    std::vector<std::string> words{"eval",   "two-lanes", "--alone", "--runs", runs,
                                   "--seed", "1",         "--json",  "--out",  (folder_ / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    const auto json = nlohmann::json::parse(isobath(words).out);
    EXPECT_EQ(json["collisions"], 0);
    return json["story"]["shown"]["count"].get<int>();
  };
  EXPECT_EQ(shown({}, "3"), 3);
  EXPECT_EQ(shown({"--set", "fls_detector.memory_radius_m=0"}, "2"), 0) << "without memory";
}

// The run of a seed sails one row of the fault table: this is that of the leak.
// ledger: S6-39
TEST_F(Eval, OfFaultsSaysWhatEachRowShowed) {
  const std::string seed = std::to_string(static_cast<int>(Fault::kLeak));
  const ProgramResult result =
      isobath({"eval", "faults", "--runs", "1", "--seed", seed, "--json", "--out", (folder_ / "out").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["runs"], 1);
  EXPECT_EQ(json["collisions"], 0);
  EXPECT_EQ(json["faults"]["shown"]["count"], 1);
  EXPECT_EQ(json["faults"]["rows"].size(), kFaults);
  EXPECT_EQ(json["faults"]["rows"]["leak"]["shown"], 1);
  EXPECT_GE(json["faults"]["rows"]["leak"]["latest_s"], 0);
  EXPECT_EQ(json["faults"]["rows"]["disk full"]["runs"], 0);
}

TEST_F(Eval, RefusesWhatIsNoSuite) {
  EXPECT_THAT(isobath({"eval", "nowhere"}), ends_with_one_line(HasSubstr("clutter-low")));
  EXPECT_THAT(eval("[bar]\n"), ends_with_one_line(HasSubstr("small.toml:5")));
  EXPECT_THAT(eval("", {"--threads", "0"}), ends_with_one_line(HasSubstr("threads")));
}

}  // namespace
}  // namespace isobath::test
