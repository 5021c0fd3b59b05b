// A run is a function of its input, configuration and seed: the same bytes in every file, on any number of threads.
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;

/// Runs `input` three times, the last time with another number of threads, and compares all files.
void expect_the_same_bytes(const fs::path& input, const std::vector<std::string>& more = {}) {
  const fs::path folder = scratch_folder();
  const auto run = [&](const std::string& name, const std::string& threads) {
    std::vector<std::string> arguments{"--threads", threads};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = isobath_run(input, folder / name, arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return files_of(folder / name);
  };
  const auto first = run("first", "2"), again = run("again", "2"), alone = run("alone", "1");
  EXPECT_GE(first.size(), 8u);
  for (const auto& [name, bytes] : first) {
    EXPECT_TRUE(again.contains(name) && again.at(name) == bytes) << name << " differs between two runs";
    EXPECT_TRUE(alone.contains(name) && alone.at(name) == bytes) << name << " differs with one thread";
  }
  EXPECT_EQ(again.size(), first.size());
  EXPECT_EQ(alone.size(), first.size());
}

fs::path first_turns_of_the_tank(const fs::path& recordings) {
  std::string log = content_of(recordings / "msis-tank-rev00-20.csv").substr(0, 500'000);
  log.resize(log.rfind('\n') + 1);
  const fs::path folder = fs::current_path() / "scratch" / "inputs";
  fs::create_directories(folder);
  return write(folder / ("tank-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".csv"),
               log);
}

// ledger: S6-57
TEST(Determinism, EmbeddedMission) { expect_the_same_bytes({}); }

TEST(Determinism, RecordedTank) {
  ISOBATH_NEEDS_DATA(recordings, "msis-tank");
  expect_the_same_bytes(first_turns_of_the_tank(recordings));
}

TEST(Determinism, AnotherSeedIsAnotherRun) {
  const fs::path folder = scratch_folder();
  isobath_run({}, folder / "one", {"--set", "simulation.duration_s=8"});
  isobath_run({}, folder / "two", {"--set", "simulation.duration_s=8", "--set", "simulation.seed=2"});
  EXPECT_NE(content_of(folder / "one" / "sonar.png"), content_of(folder / "two" / "sonar.png"));
}

/// What is found in a log and in the native log made of it.
void expect_the_same_obstacles(const fs::path& log, const fs::path& folder, const std::vector<std::string>& more) {
  std::vector<std::string> convert{"convert", log, folder / "native.mcap"};
  convert.insert(convert.end(), more.begin(), more.end());
  const ProgramResult converted = isobath::test::isobath(convert);
  ASSERT_EQ(converted.exit_code, 0) << converted.err;
  EXPECT_EQ(isobath_run(log, folder / "original", more).exit_code, 0);
  EXPECT_EQ(isobath_run(folder / "native.mcap", folder / "native").exit_code, 0);
  for (const char* name : {"obstacles.json", "scans.json", "occupancy.tif"}) {
    EXPECT_EQ(content_of(folder / "original" / name), content_of(folder / "native" / name)) << name;
  }
  EXPECT_FALSE(json_of(folder / "native" / "obstacles.json")["obstacles"].empty());
}

TEST(Determinism, NativeLogGivesTheObstaclesOfItsOriginal) {
  const fs::path folder = scratch_folder(), poses = write(folder / "poses.csv", pose_csv(25, 30));
  const std::vector<std::string> posed{"--set", "input.navigation=" + poses.string()};
  expect_the_same_obstacles(write(folder / "wall.csv", wall_csv(200)), folder, posed);
  EXPECT_EQ(content_of(folder / "original" / "obstacles.geojson"), content_of(folder / "native" / "obstacles.geojson"));
}

TEST(Determinism, NativeLogOfARecordingGivesTheObstaclesOfItsOriginal) {
  ISOBATH_NEEDS_DATA(recordings, "msis-tank");
  expect_the_same_obstacles(first_turns_of_the_tank(recordings), scratch_folder(), {});
}

}  // namespace
}  // namespace isobath
