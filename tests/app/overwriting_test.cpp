// No command overwrites what it reads, under whatever name: one line, exit code 2, and the input as it was.
#include <gtest/gtest.h>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::AllOf, testing::HasSubstr;

class Overwriting : public testing::Test {
 protected:
  void SetUp() override {
    const ProgramResult made = isobath({"convert", write(folder_ / "wall.csv", wall_csv(120)), log_});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    before_ = content_of(log_);
  }
  void refuses(const std::vector<std::string>& arguments, const std::string& option) {
    EXPECT_THAT(isobath(arguments),
                ends_with_one_line(AllOf(HasSubstr("is an input, which would be overwritten"), HasSubstr(option))));
    EXPECT_EQ(content_of(log_), before_) << "the input is as it was";
  }

  fs::path folder_ = scratch_folder(), log_ = folder_ / "log.mcap";
  std::string before_;
};

TEST_F(Overwriting, ConvertRefusesItsOwnInput) { refuses({"convert", log_, log_}, "OUT"); }

TEST_F(Overwriting, AnotherPathAndALinkAreTheSameFile) {
  refuses({"convert", log_, folder_ / "." / "log.mcap"}, "OUT");
  fs::create_symlink(log_, folder_ / "soft.mcap");
  refuses({"convert", log_, folder_ / "soft.mcap"}, "OUT");
  refuses({"convert", folder_ / "soft.mcap", log_}, "OUT");
  fs::create_hard_link(log_, folder_ / "hard.mcap");
  refuses({"convert", log_, folder_ / "hard.mcap"}, "OUT");
}

TEST_F(Overwriting, ARecordingRefusesTheLogOfItsRun) {
  refuses({"run", log_, "--out", folder_ / "out", "--record", log_}, "--record");
}

TEST_F(Overwriting, ServeRefusesToRecordOverTheRecordingThatItRunsAgain) {
  const fs::path recording = folder_ / "recording.mcap";
  fs::copy_file(log_, recording);
  EXPECT_THAT(isobath({"serve", recording, "--anew", "--out", folder_, "--port", "0"}),
              ends_with_one_line(AllOf(HasSubstr("would be overwritten"), HasSubstr("--record"))));
  EXPECT_EQ(content_of(recording), before_);
}

TEST_F(Overwriting, ARunRefusesAFolderWhoseFilesItReads) {
  const fs::path poses = write(folder_ / "scans.json", pose_csv(25));
  refuses({"run", log_, "--out", folder_, "--set", "input.navigation=" + poses.string()}, "--out");
  EXPECT_EQ(content_of(poses), pose_csv(25));
}

// The names of its results are not known before: it is said when they are written.
TEST_F(Overwriting, TracksRefuseTheTableThatTheyAreMadeOf) {
  std::string table = "time,north,east\n";
  for (int t = 0; t < 30; ++t) table += std::to_string(t) + "," + std::to_string(t) + ",0\n";
  const fs::path tracks = write(folder_ / "tracks.csv", table);
  EXPECT_THAT(isobath({"track", tracks, "--out", folder_}),
              ends_with_one_line(HasSubstr("is an input, which would be overwritten")));
  EXPECT_EQ(content_of(tracks), table);
}

TEST_F(Overwriting, AConvertedLogMayReplaceAnEarlierOne) {
  const fs::path copy = folder_ / "copy.mcap";
  for (int i = 0; i < 2; ++i) EXPECT_EQ(isobath({"convert", log_, copy}).exit_code, 0);
}

TEST_F(Overwriting, APictureRefusesTheSceneThatItShows) {
  const std::string text = content_of(source_folder() / "scenarios" / "bridge.toml");
  const fs::path scene = write(folder_ / "scene.toml", text);
  EXPECT_THAT(isobath({"sim", scene, "--duration", "1", "--picture", scene}),
              ends_with_one_line(HasSubstr("would be overwritten")));
  EXPECT_EQ(content_of(scene), text);
}

}  // namespace
}  // namespace isobath
