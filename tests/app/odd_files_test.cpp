// Files that are no plain files, too large ones, and paths without a folder: each gets one clear line, at once.
#include <fstream>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::HasSubstr;

/// In the folder $1; a program that waits for something is ended, with the exit code 124.
ProgramResult in_folder(const fs::path& folder, const std::string& script) {
  return in_bash("cd \"$1\" && isobath() { timeout 60 \"$0\" \"$@\"; }; " + script, {folder.string()});
}

TEST(OddFiles, APipeIsNoLog) {
  const fs::path folder = scratch_folder();
  ASSERT_EQ(::mkfifo((folder / "pipe.csv").c_str(), 0600), 0);
  write(folder / "wall.csv", wall_csv(20));
  for (const char* script :
       {"isobath info pipe.csv", "isobath run pipe.csv", "isobath convert pipe.csv out.mcap",
        "isobath serve pipe.csv --port 0", "isobath sim pipe.csv", "cat wall.csv | isobath info /dev/stdin"}) {
    EXPECT_THAT(in_folder(folder, script), ends_with_one_line(HasSubstr("is a pipe, which can be read only once")))
        << script;
  }
  EXPECT_THAT(in_folder(folder, "isobath run wall.csv --set input.navigation=pipe.csv"),
              ends_with_one_line(HasSubstr("is a pipe, which can be read only once")));
  EXPECT_THAT(in_folder(folder, "isobath info /dev/zero"), ends_with_one_line(HasSubstr("is a device, not a file")));
}

TEST(OddFiles, SettingsMayComeThroughAPipeThatAProgramWritesTo) {
  const fs::path folder = scratch_folder();
  write(folder / "wall.csv", wall_csv(20));
  const ProgramResult read =
      in_folder(folder, "isobath config --config <(sleep 0.2; printf '[echoes]\\nfalse_alarm = 0.02\\n')");
  EXPECT_EQ(read.exit_code, 0) << read.err;
  EXPECT_THAT(read.out, HasSubstr("false_alarm = 0.02"));
  ASSERT_EQ(::mkfifo((folder / "pipe.toml").c_str(), 0600), 0);
  EXPECT_THAT(in_folder(folder, "isobath config --config pipe.toml"),
              ends_with_one_line(HasSubstr("is a pipe that no program writes to")));
}

TEST(OddFiles, TextOfManyMegabytesIsRefused) {
  const fs::path folder = scratch_folder();
  write(folder / "wall.csv", wall_csv(20));
  std::ofstream(folder / "large.toml");
  fs::resize_file(folder / "large.toml", 17u << 20);
  for (const char* script :
       {"isobath config --config large.toml", "isobath sim large.toml", "isobath run wall.csv --mission large.toml",
        "isobath run wall.csv --model large.toml", "isobath config --config /dev/zero"}) {
    EXPECT_THAT(in_folder(folder, script), ends_with_one_line(HasSubstr("is too large; allowed: up to 16 MiB")))
        << script;
  }
}

TEST(OddFiles, AFileOfASettingStartsAtTheCurrentFolder) {
  const fs::path folder = scratch_folder();
  write(folder / "wall.csv", wall_csv(20));
  const ProgramResult shown = in_folder(folder, "isobath config --set prior.file=sub/x.shp");
  EXPECT_THAT(shown.out, HasSubstr("file = \"sub/x.shp\""));
}

TEST(OddFiles, ARecordingNeedsNoFolderInItsName) {
  const fs::path folder = scratch_folder();
  write(folder / "wall.csv", wall_csv(20));
  const ProgramResult run = in_folder(folder, "isobath run wall.csv --record name.mcap");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(fs::exists(folder / "name.mcap"));
  const ProgramResult served = in_folder(folder, R"(
      "$0" serve wall.csv --record served.mcap --speed max --port 0 --out out & server=$!
      for i in $(seq 300); do [ -s out/manifest.json ] && break; kill -0 $server || break; sleep 0.1; done
      kill -INT $server; wait $server)");
  if (served.err.find("without the live page") != std::string::npos) GTEST_SKIP() << served.err;
  EXPECT_EQ(served.exit_code, 0) << served.err;
  EXPECT_TRUE(fs::exists(folder / "served.mcap"));
}

// A ship stands 3 m ahead of this sonar, which tells soundings and no pings.
TEST(OddFiles, WhatA3dSonarHearsAheadIsAnObstacle) {
  ISOBATH_NEEDS_DATA(ship, "sonar3d-ship/ship_short.sonar");
  const fs::path folder = scratch_folder();
  const ProgramResult run = isobath::test::isobath({"run", ship, "--out", folder / "out", "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_GT(json["obstacles"].size(), 0u);
  EXPECT_LT(json["obstacles"][0]["range_m"].get<double>(), 3);
  EXPECT_FALSE(fs::exists(folder / "out" / "sonar.png")) << "there are no echoes to draw";
}

TEST(OddFiles, AFewBadEventsOfManyAreAWarning) {
  ISOBATH_NEEDS_DATA(log, "nmea-hakefjord/Hakefjord.log");
  const fs::path folder = scratch_folder();
  const ProgramResult run = isobath::test::isobath({"run", log, "--out", folder / "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("isobath: warning: time runs backwards: 90 of 12348 events"));
}

}  // namespace
}  // namespace isobath
