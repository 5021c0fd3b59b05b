#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/evaluation/baseline_helms.hpp>
#include <isobath/evaluation/evaluation_report.hpp>
#include <isobath/evaluation/run_store.hpp>
#include <isobath/report/html_report.hpp>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tests/support/data.hpp>
#include <tests/support/pole_scene.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Statistics ---------------------------------------------------------------------------------------------------------

// Newcombe 1998 (Statistics in Medicine 17, 857 and 873): tables of both papers.
TEST(Shares, HaveWilsonsIntervals) {
  const Share a = share(81, 263);
  EXPECT_NEAR(a.low, 0.2553, 5e-5);
  EXPECT_NEAR(a.high, 0.3662, 5e-5);
  const Share none = share(0, 20);
  EXPECT_EQ(none.low, 0);
  EXPECT_NEAR(none.high, 0.1611, 5e-5);
  const Share all = share(29, 29);
  EXPECT_NEAR(all.low, 0.8830, 5e-5);
  EXPECT_EQ(all.high, 1);
  EXPECT_EQ(share(0, 0).high, 1) << "nothing is known of no runs";
}

TEST(Shares, DifferAsNewcombeSays) {
  const ShareDifference d = difference(share(56, 70), share(48, 80));
  EXPECT_NEAR(d.value, 0.2, 1e-12);
  EXPECT_NEAR(d.low, 0.0524, 5e-5);
  EXPECT_NEAR(d.high, 0.3339, 5e-5);
}

TEST(Spreads, AreQuantilesOfTheSample) {
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({7}, 0.95), 7);
  std::vector<double> hundred(101);
  for (std::size_t i = 0; i < hundred.size(); ++i) hundred[i] = static_cast<double>(100 - i);
  const Spread s = spread(hundred);
  EXPECT_DOUBLE_EQ(s.least, 0);
  EXPECT_DOUBLE_EQ(s.low, 5);
  EXPECT_DOUBLE_EQ(s.median, 50);
  EXPECT_DOUBLE_EQ(s.high, 95);
  EXPECT_DOUBLE_EQ(s.most, 100);
  EXPECT_EQ(spread({}).count, 0u);
}

RunScore scored(bool collision, bool goal, const std::string& refused, double ratio) {
  RunScore s;
  s.collision = s.near_miss = s.encounter = collision;
  s.goal_reached = goal;
  s.refused = refused;
  s.path_ratio = ratio;
  return s;
}

std::vector<ScoredRun> four_runs() {
  std::vector<ScoredRun> runs(4);
  for (std::size_t i = 0; i < runs.size(); ++i) runs[i].seed = 10 + i;
  runs[0].scores = {scored(false, true, "", 1.1)};
  runs[1].scores = {scored(true, false, "", -1)};
  runs[2].scores = {scored(false, false, "no way within 3.5 m of (12, 4)", -1)};
  runs[3].scores = {scored(false, false, "", -1)};
  return runs;
}

TEST(Summaries, EveryRunIsAGoalARefusalACollisionOrLost) {
  const Summary s = summarise("ours", four_runs(), 0);
  EXPECT_EQ(s.goals.count, 1u);
  EXPECT_EQ(s.collisions.count, 1u);
  EXPECT_EQ(s.refused.count, 1u);
  EXPECT_EQ(s.lost.count, 1u);
  EXPECT_EQ(s.path_ratio.count, 1u);
  EXPECT_THAT(s.reasons, testing::ElementsAre(testing::Pair("no way within # m of (#, #)", 1)));
}

TEST(Summaries, TheWorstRunComesFirst) { EXPECT_THAT(worst_runs(four_runs(), 3), testing::ElementsAre(1, 3, 2)); }

TEST(Bars, AreNamedWhereTheyAreBroken) {
  const Summary s = summarise("ours", four_runs(), 0);
  BarsConfig bars;
  bars.collisions = 1;
  EXPECT_TRUE(broken_bars(bars, s).empty());
  bars = {.collisions = 0, .goals_share = 0.5, .refused_share = 0.2, .path_ratio_median = 1.05};
  EXPECT_THAT(broken_bars(bars, s),
              testing::ElementsAre(HasSubstr("collisions: 1, at most 0"), HasSubstr("goals_share: 0.250"),
                                   HasSubstr("refused_share: 0.250"), HasSubstr("path_ratio_median: 1.100")));
}

TEST(Summaries, FalseObstaclesAreThoseOfAllScans) {
  std::vector<ScoredRun> runs = four_runs();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    runs[i].scores[0].scans = i == 0 ? 100 : 300;  // a long run counts by its scans
    runs[i].scores[0].false_obstacles = 200;
    runs[i].scores[0].near_false_obstacles = i == 0 ? 50 : 0;
  }
  const Summary s = summarise("ours", runs, 0);
  EXPECT_DOUBLE_EQ(s.false_obstacles, 0.8);
  EXPECT_DOUBLE_EQ(s.near_false_obstacles, 0.05);
  EXPECT_TRUE(broken_bars({.collisions = -1, .false_obstacles_20m = 0.05}, s).empty());
  EXPECT_THAT(broken_bars({.collisions = -1, .false_obstacles_20m = 0.04}, s),
              testing::ElementsAre("false_obstacles_20m: 0.050 a scan, at most 0.04"));
  EXPECT_EQ(summarise("ours", four_runs(), 0).false_obstacles, 0) << "no scans at all";
}

// ledger: S6-39
TEST(Summaries, OfFaultsCountWhatEachRowShowed) {
  std::vector<ScoredRun> runs = four_runs();
  EXPECT_TRUE(summarise("ours", runs, 0).rows.empty()) << "none of them is of a fault";
  for (ScoredRun& run : runs) run.scores[0].proof.fault = to_text(Fault::kLeak);
  runs[1].scores[0].proof.after_s = 0.4;
  runs[2].scores[0].proof.failure = "not raised";
  runs[3].scores[0].proof.fault = to_text(Fault::kNoPath);
  const Summary s = summarise("ours", runs, 0);
  ASSERT_EQ(s.rows.size(), kFaults);
  const RowSummary& leak = s.rows[static_cast<std::size_t>(Fault::kLeak)];
  EXPECT_EQ(leak.name, to_text(Fault::kLeak));
  EXPECT_EQ(leak.shown.count, 2u);
  EXPECT_EQ(leak.shown.of, 3u);
  EXPECT_EQ(leak.latest_s, 0.4);
  EXPECT_THAT(leak.failures, testing::ElementsAre("seed 12: not raised"));
  EXPECT_EQ(s.rows[static_cast<std::size_t>(Fault::kNoPath)].shown.count, 1u);
  EXPECT_EQ(s.rows[static_cast<std::size_t>(Fault::kDiskFull)].shown.of, 0u);
  EXPECT_EQ(s.shown.count, 3u);
  EXPECT_EQ(s.shown.of, 4u);
  EXPECT_THAT(broken_bars({.collisions = -1, .shown_share = 1}, s),
              testing::ElementsAre("shown_share: 0.750, at least 1; leak: seed 12: not raised"));
  EXPECT_TRUE(broken_bars({.collisions = -1, .shown_share = 0.75}, s).empty());
}

// Suites -------------------------------------------------------------------------------------------------------------

TEST(Suites, OfTheRepositoryAreInTheProgramAndCanBeRead) {
  const fs::path folder = fs::path(testing::TempDir()) / "suites_of_the_program";
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "suites")) {
    files.push_back(entry.path().stem().string());
  }
  EXPECT_THAT(embedded_suites(), testing::UnorderedElementsAreArray(files));
  for (const std::string& name : embedded_suites()) {
    const Suite inside = load_suite(find_suite(name, folder));
    const Suite outside = load_suite(test::source_folder() / "suites" / (name + ".toml"));
    EXPECT_EQ(inside.digest, outside.digest) << name;
    EXPECT_EQ(inside.name, name);
    EXPECT_GE(inside.bars.collisions, 0) << name << " has no bar for collisions";
    const bool compared = inside.about.faults.empty() && inside.about.without.empty() && inside.stages.empty() &&
                          inside.axes.groups.empty();
    const std::size_t baselines = name == "usbl-fixes" ? 3 : 4;
    EXPECT_EQ(inside.baselines.size(), compared ? baselines : 0) << name;
  }
}

TEST(Suites, UnknownOnesAreRefusedWithTheNamesOfTheOthers) {
  try {
    find_suite("cluter-low", testing::TempDir());
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("clutter-low"));
  }
}

TEST(Suites, ARunIsAFunctionOfItsSeed) {
  const Suite suite = load_suite(test::source_folder() / "suites/clutter-middle.toml");
  const std::vector<Scenario> scenes = load_scenes(suite);
  const SuiteRun a = make_run(suite, scenes, 17), b = make_run(suite, scenes, 17), c = make_run(suite, scenes, 18);
  EXPECT_EQ(a.conditions, b.conditions);
  EXPECT_NE(a.conditions, c.conditions);
  EXPECT_EQ(a.scenario.scene.vehicle.start, b.scenario.scene.vehicle.start);
  EXPECT_EQ(a.scenario.scene.bodies.size(), b.scenario.scene.bodies.size());
  EXPECT_EQ(a.scenario.scene.about.seed, 17);
}

TEST(Suites, DrawWithinTheirLimits) {
  const Suite suite = load_suite(test::source_folder() / "suites/clutter-middle.toml");
  const std::vector<Scenario> scenes = load_scenes(suite);
  double fastest = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Scene scene = make_run(suite, scenes, seed).scenario.scene;
    EXPECT_LE(std::abs(scene.vehicle.start.y()), 5);
    EXPECT_LE(std::abs(scene.vehicle.heading.degrees()), 15);
    const double current = std::hypot(scene.water.current[1], scene.water.current[2]);
    EXPECT_LE(current, 0.5);
    fastest = std::max(fastest, current);
    EXPECT_LE(scene.navigator.drift_share, 0.01);
    const double noise = scene.sonars[0].noise_level / scenes[0].scene.sonars[0].noise_level;
    EXPECT_GE(noise, 0.7);
    EXPECT_LE(noise, 1.3);
  }
  EXPECT_GT(fastest, 0.45);
}

TEST(Suites, AreStrict) {
  const fs::path folder = fs::path(testing::TempDir()) / "strict_suites";
  make_folder(folder);
  write_whole_file(folder / "pole.toml", test::kPoleScene);
  const auto refused = [&](const std::string& text) -> std::string {
    write_whole_file(folder / "suite.toml", text);
    try {
      load_suite(folder / "suite.toml");
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(refused("[suite]\nscene = \"pole.toml\"\n"), "");
  EXPECT_THAT(refused("[suite]\nscene = \"pole.toml\"\n[vary]\nheding_deg = 3\n"), HasSubstr("heading_deg"));
  EXPECT_THAT(refused("[suite]\nruns = 3\n"), HasSubstr("suite.scene"));
  EXPECT_THAT(refused("[suite]\nscene = \"pole.toml\"\nfaults = \".\"\n"), HasSubstr("cannot be combined with faults"));
  EXPECT_THAT(refused("[suite]\nfaults = \".\"\n"), HasSubstr("sonar_silent.toml"));
  EXPECT_THAT(refused("[suite]\nscene = \"pole.toml\"\n[vary]\ndrift = [0.2, 0.1]\n"), HasSubstr("vary.drift"));
  EXPECT_THAT(refused("[suite]\nscene = \"pole.toml\"\n[[baseline]]\nhelm = \"luck\"\n"), HasSubstr("as printed"));
  const std::string twice = "[[baseline]]\nhelm = \"no avoidance\"\n";
  EXPECT_THAT(refused("[suite]\nscene = \"pole.toml\"\n" + twice + twice), HasSubstr("twice"));
}

// Runs ---------------------------------------------------------------------------------------------------------------

class SmallEvaluation : public testing::Test {
 protected:
  SmallEvaluation() {
    const fs::path folder =
        fs::path(testing::TempDir()) /
        ("evaluation_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    make_folder(folder);
    write_whole_file(folder / "pole.toml", test::kPoleScene);
    write_whole_file(folder / "small.toml",
                     "[suite]\nscene = \"pole.toml\"\nduration_s = 20\n[vary]\nstart = [0, 6]\nnoise = [0.8, 1.2]\n");
    request_.suite = load_suite(folder / "small.toml");
    request_.methods = {{"potential field", {}, counted([](const Scenario& scenario, const VehicleParameters& vehicle) {
                           return std::make_unique<PotentialFieldHelm>(scenario.mission, vehicle,
                                                                       PotentialFieldConfig{});
                         })},
                        {"no avoidance", {}, counted([](const Scenario& scenario, const VehicleParameters& vehicle) {
                           return std::make_unique<LineOfSightHelm>(scenario.mission, vehicle);
                         })}};
    request_.runs = 3;
    request_.seed = 5;
    request_.out = folder / "out";
    request_.version = "1";
  }

  template <class Make>
  decltype(ComparedMethod::make) counted(Make make) {
    return [this, make](const Scenario& scenario, const VehicleParameters& vehicle, const Configuration&) {
      ++made_;
      return std::unique_ptr<Helm>(make(scenario, vehicle));
    };
  }

  [[nodiscard]] std::string lines() const {
    std::ostringstream text;
    text << std::ifstream(request_.out / "runs.jsonl", std::ios::binary).rdbuf();
    return text.str();
  }

  EvaluationRequest request_;
  std::atomic<int> made_{0};
};

TEST_F(SmallEvaluation, IsTheSameOnAnyNumberOfThreads) {
  const std::string one = to_json(request_, evaluate(request_)), lines_of_one = lines();
  request_.out += "_threads";
  request_.threads = 3;
  EXPECT_EQ(to_json(request_, evaluate(request_)), one);
  EXPECT_EQ(lines(), lines_of_one);
}

TEST_F(SmallEvaluation, GoesOnWhereItWasCutOff) {
  ISOBATH_NOT_SANITIZED();
  const std::string whole = to_json(request_, evaluate(request_)), all = lines();
  EXPECT_EQ(made_, 6);
  const std::size_t second = all.find('\n') + 1;
  // Cut in the second line, in the third, between them, and with a line that no program wrote.
  for (const std::string& left : {all.substr(0, second + 40), all.substr(0, all.size() - 1), all.substr(0, second),
                                  all.substr(0, second) + "{\"seed\": 6, \"fingerprint\": 3}\n", std::string("\n")}) {
    write_whole_file(request_.out / "runs.jsonl", left);
    made_ = 0;
    const Evaluation again = evaluate(request_);
    EXPECT_EQ(to_json(request_, again), whole);
    EXPECT_EQ(lines(), all);
    EXPECT_EQ(made_, 2 * (3 - again.taken_over));
  }
  made_ = 0;
  EXPECT_EQ(evaluate(request_).taken_over, 3);
  EXPECT_EQ(made_, 0);
}

TEST_F(SmallEvaluation, MoreRunsAreAddedToThoseThatAreThere) {
  ISOBATH_NOT_SANITIZED();
  evaluate(request_);
  request_.runs = 4;
  made_ = 0;
  EXPECT_EQ(evaluate(request_).taken_over, 3);
  EXPECT_EQ(made_, 2);
}

TEST_F(SmallEvaluation, TakesNothingOverFromAnotherConfiguration) {
  ISOBATH_NOT_SANITIZED();
  evaluate(request_);
  made_ = 0;
  request_.methods[0].configuration.grid.prior = 0.02;
  EXPECT_EQ(evaluate(request_).taken_over, 0);
  request_.version = "2";
  EXPECT_EQ(evaluate(request_).taken_over, 0);
}

TEST_F(SmallEvaluation, ARunCanBeHadAgainByItsSeedAlone) {
  ISOBATH_NOT_SANITIZED();
  const Evaluation three = evaluate(request_);
  request_.runs = 1;
  request_.seed = 7;
  request_.out += "_alone";
  const Evaluation one = evaluate(request_);
  EXPECT_EQ(to_line(one.runs[0], ""), to_line(three.runs[2], ""));
}

TEST_F(SmallEvaluation, SaysWhatTheNumbersAreAndDrawsTheWorstRuns) {
  const Evaluation evaluation = evaluate(request_);
  write_evaluation(request_, evaluation);
  const auto json = nlohmann::json::parse(to_json(request_, evaluation));
  EXPECT_EQ(json["runs"], 3);
  for (const char* key :
       {"collisions", "near_misses", "goals_reached", "refused", "path_ratio_median", "detection_delay_pings_median"}) {
    EXPECT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json["baselines"]["no avoidance"].contains(key)) << key;
  }
  EXPECT_EQ(json["worst"].size(), 3u);
  std::ostringstream page;
  page << std::ifstream(request_.out / "report.html").rdbuf();
  for (const ScoredRun& run : evaluation.runs) {
    EXPECT_THAT(page.str(), HasSubstr("isobath eval small --runs 1 --seed " + std::to_string(run.seed)));
  }
}

}  // namespace
}  // namespace isobath
