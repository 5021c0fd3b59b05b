#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/evaluation/evaluation_report.hpp>
#include <isobath/report/html_report.hpp>
#include <set>
#include <tests/support/data.hpp>
#include <tests/support/pole_scene.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class Variants : public testing::Test {
 protected:
  Variants()
      : folder_(fs::path(testing::TempDir()) /
                ("variants_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    fs::remove_all(folder_);
    make_folder(folder_);
    write_whole_file(folder_ / "pole.toml", test::kPoleScene);
    for (const char* vehicle : {"remus100", "bluerov2"}) {
      const fs::path file = std::string(vehicle) + ".toml";
      fs::copy_file(test::source_folder() / "vehicles" / file, folder_ / file);
    }
  }
  [[nodiscard]] Suite suite(const std::string& about, const std::string& lists) const {
    write_whole_file(folder_ / "suite.toml", "[suite]\nscene = \"pole.toml\"\n" + about + lists);
    return load_suite(folder_ / "suite.toml");
  }
  [[nodiscard]] std::string problem(const std::string& about, const std::string& lists) const {
    try {
      (void)suite(about, lists);
    } catch (const Error& e) {
      return e.what();
    }
    return "none";
  }
  static std::vector<std::string> names(const std::vector<SuiteVariant>& variants) {
    std::vector<std::string> all;
    for (const SuiteVariant& variant : variants) all.push_back(variant.name);
    return all;
  }

  fs::path folder_;
  const std::string vehicles_ =
      "[[vehicle]]\nfile = \"remus100.toml\"\n[[vehicle]]\nname = \"rov\"\nfile = \"bluerov2.toml\"\nspeed = 0.8\n";
  const std::string sonars_ = "[[sonar]]\npreset = \"oculus_m750d\"\nrange_m = 30\n[[sonar]]\npreset = \"micron\"\n";
};

TEST_F(Variants, AreAllCombinationsOfWhatTheSuiteLists) {
  EXPECT_TRUE(suite("", "").variants.empty());
  EXPECT_THAT(names(suite("altimeter = \"both\"\n", vehicles_ + sonars_).variants),
              ElementsAre("remus100/oculus_m750d/altimeter", "rov/oculus_m750d/altimeter", "remus100/micron/altimeter",
                          "rov/micron/altimeter", "remus100/oculus_m750d/no-altimeter", "rov/oculus_m750d/no-altimeter",
                          "remus100/micron/no-altimeter", "rov/micron/no-altimeter"));
  EXPECT_THAT(names(suite("", vehicles_).variants), ElementsAre("remus100", "rov"));
  EXPECT_THAT(names(suite("altimeter = \"without\"\n", "").variants), ElementsAre("no-altimeter"));
}

TEST_F(Variants, AreTakenInTurnBySeed) {
  const Suite s = suite("altimeter = \"both\"\n", vehicles_ + sonars_);
  const std::vector<Scenario> scenes = load_scenes(s);
  std::set<std::string> taken;
  for (std::uint64_t seed = 40; seed < 48; ++seed) taken.insert(make_run(s, scenes, seed).variant);
  EXPECT_EQ(taken.size(), 8u);
  const SuiteRun run = make_run(s, scenes, 41);
  EXPECT_EQ(run.variant, "rov/oculus_m750d/altimeter");
  const Scene& scene = run.scenario.scene;
  EXPECT_EQ(fs::path(scene.vehicle.file).filename(), "bluerov2.toml");
  EXPECT_EQ(run.scenario.mission.speed, 0.8);
  ASSERT_EQ(scene.sonars.size(), 2u);
  EXPECT_EQ(scene.sonars[0].range_m, 30);
  EXPECT_EQ(scene.sonars[0].beams, 512);
  EXPECT_EQ(scene.sonars[1].kind, SonarKind::kRanges);
  EXPECT_EQ(make_run(s, scenes, 45).scenario.scene.sonars.size(), 1u) << "without the altimeter";
}

TEST_F(Variants, OfOneSeedMeetTheSameWater) {
  Suite all = suite("[vary]\nstart = [1, 2]\nnoise = [0.5, 2]\n[clutter]\ndensity = 10\n", vehicles_ + sonars_),
        one = all;
  select_variants(one, "rov/micron");
  EXPECT_THAT(names(one.variants), ElementsAre("rov/micron"));
  const std::vector<Scenario> scenes = load_scenes(all);
  EXPECT_EQ(make_run(one, scenes, 8).variant, "rov/micron");
  EXPECT_EQ(make_run(all, scenes, 8).variant, "remus100/oculus_m750d");
  EXPECT_EQ(make_run(one, scenes, 8).conditions, make_run(all, scenes, 8).conditions);
}

// The plant is drawn last, so that the other draws of a seed stay. ledger: S7-08
TEST_F(Variants, DrawAPlantThatTheControlDoesNotKnow) {
  const std::string vehicle = "[[vehicle]]\nname = \"learns\"\nfile = \"" +
                              (test::source_folder() / "vehicles/remus100.toml").string() +
                              "\"\ncontrol = \"adaptive\"\n";
  const Suite plain = suite("[vary]\nstart = [1, 2]\n", vehicle);
  const Suite s = suite(
      "[vary]\nstart = [1, 2]\nplant_mass = [0.5, 1.5]\nplant_drag = [0.5, 1.5]\nplant_buoyancy = 3.5\n", vehicle);
  const std::vector<Scenario> scenes = load_scenes(s);
  double least = 2, most = 0;
  for (std::uint64_t seed = 1; seed < 60; ++seed) {
    const Scene& scene = make_run(s, scenes, seed).scenario.scene;
    EXPECT_EQ(scene.vehicle.control, ControlKind::kAdaptive);
    EXPECT_EQ(scene.vehicle.start, make_run(plain, scenes, seed).scenario.scene.vehicle.start);
    least = std::min({least, scene.plant.mass, scene.plant.drag});
    most = std::max({most, scene.plant.mass, scene.plant.drag});
    EXPECT_LE(std::abs(scene.plant.buoyancy), 3.5);
  }
  EXPECT_GE(least, 0.5);
  EXPECT_LT(least, 0.6);
  EXPECT_GT(most, 1.4);
  EXPECT_LE(most, 1.5);
  EXPECT_THAT(make_run(s, scenes, 3).conditions, testing::HasSubstr("; plant: mass x "));
  EXPECT_EQ(make_run(plain, scenes, 3).scenario.scene.plant, PlantDifference{});
  const SuiteRun wrong = make_run(suite("[vary]\nstart = [1, 2]\ncontrol_mass = [0.5, 1.5]\n", vehicle), scenes, 3);
  EXPECT_THAT(wrong.conditions, testing::HasSubstr("; model of the control: mass x "));
  EXPECT_EQ(wrong.scenario.scene.plant, PlantDifference{});
  EXPECT_NE(wrong.scenario.scene.control_model.mass, 1);
}

TEST_F(Variants, AreSelectedByPartsOfTheirNames) {
  const Suite s = suite("altimeter = \"both\"\n", vehicles_ + sonars_);
  EXPECT_EQ(matching(s.variants, "rov").size(), 4u);
  EXPECT_THAT(names(matching(s.variants, "micron/altimeter")),
              ElementsAre("remus100/micron/altimeter", "rov/micron/altimeter"));
  Suite other = s;
  select_variants(other, "rov");
  EXPECT_NE(other.digest, s.digest) << "seeds now mean other runs";
  EXPECT_THROW((void)matching(s.variants, "micro"), Error);
  EXPECT_THROW((void)matching(s.variants, "/"), Error);
  EXPECT_THROW((void)matching({}, "rov"), Error);
}

TEST_F(Variants, AreStrict) {
  EXPECT_THAT(problem("", "[[vehicle]]\nname = \"a\"\n"), HasSubstr("3:"));
  EXPECT_THAT(problem("", "[[vehicle]]\nfile = \"submarine.toml\"\n"), HasSubstr("no such file"));
  EXPECT_THAT(problem("", "[[vehicle]]\nfile = \"remus100.toml\"\nname = \"a/b\"\n"), HasSubstr("a/b"));
  EXPECT_THAT(problem("", vehicles_ + "[[vehicle]]\nfile = \"remus100.toml\"\n"), HasSubstr("twice"));
  EXPECT_THAT(problem("", "[[sonar]]\npreset = \"micron\"\nrange = 40\n"), HasSubstr("range_m"));
  EXPECT_THAT(problem("", "[[sonar]]\npreset = \"micron\"\nblanking_m = 60\n"), HasSubstr("blanking_m"));
  EXPECT_THAT(problem("altimeter = \"perhaps\"\n", ""), HasSubstr("both"));
}

TEST_F(Variants, HaveALineEach) {
  const Suite s = suite("", vehicles_);
  Evaluation evaluation;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    ScoredRun& run = evaluation.runs.emplace_back();
    run.seed = seed;
    run.variant = s.variants[seed % 2].name;
    RunScore& score = run.scores.emplace_back();
    score.goal_reached = seed > 0;
    score.scans = 10;
    score.near_false_obstacles = static_cast<int>(seed);
  }
  evaluation.variants = summarise_variants(s.variants, evaluation.runs);
  ASSERT_EQ(evaluation.variants.size(), 2u);
  EXPECT_EQ(evaluation.variants[0].goals.count, 1u);
  EXPECT_EQ(evaluation.variants[0].goals.of, 2u);
  EXPECT_DOUBLE_EQ(evaluation.variants[0].near_false_obstacles, 0.1);
  EXPECT_DOUBLE_EQ(evaluation.variants[1].near_false_obstacles, 0.1);
  const auto table = variant_table(evaluation);
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(table[2][0], "rov");
  EXPECT_EQ(table[2].size(), table[0].size());
  EXPECT_TRUE(variant_table({}).empty());
}

// What the suites of imaging sonars promise: every pair of vehicle and sonar, with and without an altimeter.
TEST(ImagingSuites, HaveEighteenVariantsThatCanBegin) {
  for (const char* name : {"low", "middle", "high", "shallow", "sea"}) {
    const Suite s = load_suite(test::source_folder() / "suites" / (std::string("imaging-") + name + ".toml"));
    ASSERT_EQ(s.variants.size(), 18u) << name;
    EXPECT_EQ(s.about.runs % 18, 0) << name;
    const std::vector<Scenario> scenes = load_scenes(s);
    for (std::uint64_t seed = 0; seed < 18; ++seed) {
      const SuiteRun run = make_run(s, scenes, seed);
      const double range = run.scenario.scene.sonars[0].range_m;
      const double mine = run.variant.find("m1200d") == std::string::npos ? 60 : 40;
      EXPECT_EQ(range, std::string(name) == "shallow" ? 30 : mine) << run.variant;
      EXPECT_EQ(run.scenario.scene.sonars.size(), run.variant.ends_with("no-altimeter") ? 1u : 2u);
      EXPECT_GE(run.scenario.mission.speed * s.about.duration_s, 2 * 120) << "no time for " << run.variant;
      EXPECT_EQ(run.scenario.mission.points.back().depth_m, run.scenario.scene.vehicle.start.z());
    }
  }
}

}  // namespace
}  // namespace isobath
