// The stages of a story, looked for in a run past a pole.
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/evaluation/evaluation.hpp>
#include <tests/support/data.hpp>
#include <tests/support/pole_scene.hpp>

namespace isobath {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class MissionStory : public testing::Test {
 protected:
  Evaluation told(const std::string& stages) {
    write_whole_file(folder_ / "pole.toml", test::kPoleScene);
    write_whole_file(folder_ / "story.toml", "[suite]\nscene = \"pole.toml\"\nduration_s = 45\ngoal_m = 7\n" + stages);
    EvaluationRequest request;
    request.suite = load_suite(folder_ / "story.toml");
    request.methods = methods_of(request.suite, {});
    request.runs = 1;
    request.seed = 5;
    request.out = folder_ / "out";
    return evaluate(request);
  }

  static constexpr const char* kSeenAndRounded = R"(
[bars]
story_share = 1
[[stage]]
name = "seen"
what = "seen"
at = [26, 0.3]
[[stage]]
name = "rounded"
what = "replanned"
at = [26, 0.3]
)";
  const std::filesystem::path folder_ = test::scratch_folder();
};

// ledger: S6-54 S6-D07 S6-D08
TEST_F(MissionStory, IsShownWhereAllStagesHappenInTheirOrder) {
  const Evaluation evaluation = told(kSeenAndRounded);
  const Summary& s = evaluation.summaries.front();
  const StoryCheck& story = evaluation.runs.front().scores.front().story;
  EXPECT_EQ(story.failure, "");
  ASSERT_EQ(story.after_s.size(), 2u);
  EXPECT_GT(story.after_s[0], 0);
  EXPECT_EQ(s.story.count, 1u);
  ASSERT_EQ(s.stages.size(), 2u);
  EXPECT_EQ(s.stages[1].name, "rounded");
  EXPECT_EQ(s.stages[1].scans.median, story.scans[1]);
  EXPECT_TRUE(evaluation.broken.empty());
}

TEST_F(MissionStory, FailsWhereAStageIsTooLateOrDoesNotHappen) {
  const Evaluation late = told(std::string(kSeenAndRounded) + "after_s = [500, 600]\n");
  EXPECT_THAT(late.runs.front().scores.front().story.failure, HasSubstr("rounded: after "));
  EXPECT_EQ(late.summaries.front().story.count, 0u);
  EXPECT_EQ(late.summaries.front().stages.front().shown.count, 1u) << "the stage before was shown";
  EXPECT_THAT(late.broken, ElementsAre(HasSubstr("story_share: 0.000, at least 1; 1 times rounded: after # s")));
  const Evaluation elsewhere = told("[[stage]]\nname = \"far off\"\nwhat = \"seen\"\nat = [10, 90]\n");
  EXPECT_EQ(elsewhere.runs.front().scores.front().story.failure, "far off: did not happen");
}

TEST_F(MissionStory, NeedsThePointThatItNames) {
  try {
    told("[[stage]]\nname = \"dropped\"\nwhat = \"dropped\"\n");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("stage.point"));
  }
}

}  // namespace
}  // namespace isobath
