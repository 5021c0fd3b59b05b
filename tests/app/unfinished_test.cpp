// A command that fails, or that is killed, leaves no output that looks complete.
#include <gtest/gtest.h>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;

/// A shell that may write files of this many blocks of 1024 bytes, and ignores the signal of a file that grows beyond.
ProgramResult with_little_space(int blocks, const std::vector<std::string>& arguments) {
  return in_bash("trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; \"$0\" \"$@\"", arguments);
}

TEST(Unfinished, AConversionThatFailsLeavesWhatStoodThere) {
  const fs::path folder = scratch_folder(), log = write(folder / "wall.csv", wall_csv(2000));
  const fs::path out = write(folder / "wall.mcap", "earlier");
  const ProgramResult failed = with_little_space(4, {"convert", log, out});
  EXPECT_EQ(failed.exit_code, 2) << failed.err;
  EXPECT_EQ(content_of(out), "earlier");
  EXPECT_EQ(files_of(folder).size(), 2u) << "nothing beside it";
}

TEST(Unfinished, ASimulationThatFailsLeavesNoFile) {
  const fs::path folder = scratch_folder(), out = folder / "scene.mcap";
  const ProgramResult failed = with_little_space(1, {"sim", "--duration", "30", "--out", out});
  EXPECT_EQ(failed.exit_code, 2) << failed.err;
  EXPECT_TRUE(files_of(folder).empty());
}

TEST(Unfinished, ARunThatFailsLeavesNoManifestOfAnEarlierOne) {
  const fs::path folder = scratch_folder(), log = write(folder / "wall.csv", wall_csv(200)), out = folder / "out";
  ASSERT_EQ(isobath_run(log, out).exit_code, 0);
  ASSERT_TRUE(fs::exists(out / "manifest.json"));
  const ProgramResult failed = with_little_space(4, {"run", log, "--out", out});
  EXPECT_EQ(failed.exit_code, 2) << failed.err;
  for (const char* name : {"manifest.json", "report.html"}) EXPECT_FALSE(fs::exists(out / name)) << name;
  for (const auto& [name, bytes] : files_of(out)) {
    EXPECT_FALSE(bytes.empty()) << name;
    EXPECT_FALSE(name.ends_with(".part")) << name;
  }
}

}  // namespace
}  // namespace isobath
