// A suite of groups: what its runs vary, what they score, and what it refuses.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/evaluation/evaluation_report.hpp>
#include <isobath/evaluation/run_store.hpp>
#include <nlohmann/json.hpp>
#include <tests/support/data.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using testing::HasSubstr;

class GroupSuite : public testing::Test {
 protected:
  GroupSuite() {
    write_whole_file(folder_ / "scene.toml", fmt::format(R"([scene]
title = "A small group"
duration_s = 300
[bottom]
kind = "flat"
material = "mud"
depth = 25
[vehicle]
name = "alpha"
file = "{}"
start = [-15, 10, 12]
[[group_vehicle]]
name = "bravo"
start = [-15, 30, 12]
[search_area]
length_m = 30
breadth_m = 40
spacing_m = 20
depth_m = 12
[[sonar]]
preset = "oculus_m750d"
range_m = 30
bins = 40
interval_s = 1
)",
                                                         (test::source_folder() / "vehicles/remus100.toml").string()));
  }
  Suite suite(const std::string& more = "") {
    write_whole_file(folder_ / "small.toml", R"([suite]
scene = "scene.toml"
runs = 3
seed = 0
duration_s = 0
[vary]
start = [2, 2]
lost_s = [10, 20]
[[group]]
name = "one"
vehicles = 1
[[group]]
name = "two"
loss = 0.3
[[group]]
name = "one-lost"
loses_vehicle = true
[bars]
collisions = 0
overlap_share = 0.9
bit_rate = 5
)" + more);
    return load_suite(folder_ / "small.toml");
  }
  std::string problem_of(const std::string& more) {
    try {
      suite(more);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }

  std::filesystem::path folder_ = test::scratch_folder();
};

// ledger: S2-50 S2-51 S6-67
TEST_F(GroupSuite, ScoresEachGroupInTurn) {
  ISOBATH_NOT_SANITIZED();
  EvaluationRequest request;
  request.suite = suite();
  request.methods = methods_of(request.suite, {});
  request.threads = 2;
  request.out = folder_ / "out";
  const Evaluation evaluation = evaluate(request);
  ASSERT_EQ(evaluation.runs.size(), 3u);
  const GroupRunScore &one = evaluation.runs[0].scores[0].group, &two = evaluation.runs[1].scores[0].group,
                      &lost = evaluation.runs[2].scores[0].group;
  EXPECT_EQ(one.vehicles, 1);
  EXPECT_EQ(one.separation_m, -1) << "it is alone";
  EXPECT_EQ(one.bit_rate, 0);
  EXPECT_EQ(two.vehicles, 2);
  EXPECT_GT(two.separation_m, 5);
  EXPECT_GT(two.bit_rate, 5);
  EXPECT_LT(two.all_searched_s, one.all_searched_s) << "two are faster";
  EXPECT_GE(lost.lost_s, 10);
  EXPECT_LE(lost.lost_s, 20.1);
  EXPECT_GT(lost.reassigned_s, 0);
  for (const ScoredRun& run : evaluation.runs) {
    EXPECT_TRUE(run.scores[0].goal_reached) << run.scores[0].refused;
    EXPECT_GT(run.scores[0].group.searched, 0.8);
    const auto again = from_line(to_line(run, "x"), "x");
    ASSERT_TRUE(again);
    EXPECT_EQ(again->scores[0].group.searched, run.scores[0].group.searched);
  }
  ASSERT_EQ(evaluation.variants.size(), 3u);
  EXPECT_EQ(evaluation.variants[2].group.reassigned.count, 1u);
  EXPECT_THAT(evaluation.broken, testing::ElementsAre(HasSubstr("bit_rate"))) << "a bar that none can meet";
  write_evaluation(request, evaluation);
  const auto json = nlohmann::json::parse(to_json(request, evaluation));
  EXPECT_EQ(json["variants"]["two"]["group"]["overlap"]["count"], 1);
  EXPECT_THAT(text_of_file((request.out / "report.html").string()),
              HasSubstr("isobath eval small --runs 1 --seed 2 --variant one-lost"));
}

TEST_F(GroupSuite, RefusesWhatAGroupHasNot) {
  EXPECT_EQ(problem_of(""), "");
  EXPECT_THAT(problem_of("[[baseline]]\nhelm = \"no avoidance\"\n"), HasSubstr("baseline"));
  EXPECT_THAT(problem_of("[encounters]\non = true\n"), HasSubstr("encounters"));
  EXPECT_THAT(problem_of("[[group]]\nname = \"two\"\n"), HasSubstr("used twice"));
  Suite many = suite("[[group]]\nname = \"three\"\nvehicles = 3\n");
  const auto scenes = load_scenes(many);
  EXPECT_THROW(make_run(many, scenes, 3), Error) << "the scene has two vehicles";
  EXPECT_THAT(make_run(many, scenes, 2).conditions, HasSubstr("is lost after"));
}

}  // namespace
}  // namespace isobath
