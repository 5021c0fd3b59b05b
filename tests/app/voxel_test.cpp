// The map in three dimensions as a user meets it: files, numbers, and one clear line where it cannot be.
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/io/mcap/native_log.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

using test::ends_with_one_line;
using test::isobath_run;
using test::ProgramResult;
using testing::HasSubstr;
namespace fs = std::filesystem;

class Voxels : public testing::Test {
 protected:
  fs::path out_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
  fs::path bridge_ = scene_of_the_bridge();

 private:
  /// Without its mission: the vehicle sails straight, and the run is over when its time is.
  [[nodiscard]] fs::path scene_of_the_bridge() const {
    fs::create_directories(out_.string() + "_scene/scenarios");
    fs::create_directories(out_.string() + "_scene/vehicles");
    fs::copy_file(test::source_folder() / "vehicles/remus100.toml", out_.string() + "_scene/vehicles/remus100.toml",
                  fs::copy_options::overwrite_existing);
    const fs::path file = out_.string() + "_scene/scenarios/bridge.toml";
    std::ofstream(file) << test::scene_text("bridge");
    return file;
  }
};

// ledger: S5-03 S5-27 S5-30
TEST_F(Voxels, OfTheBridgeHaveALayerForEachImagePlane) {
  const ProgramResult run = isobath_run(bridge_, out_, {"--set", "simulation.duration_s=8"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto voxels = test::json_of(out_ / "manifest.json")["voxels"];
  ASSERT_EQ(voxels["layers"].size(), 2u);
  EXPECT_EQ(voxels["layers"][0]["sensor"], "flat");
  EXPECT_EQ(voxels["layers"][1]["sensor"], "upright");
  EXPECT_GT(voxels["free"], 1000);
  for (const char* name :
       {"voxels.bt", "voxels.ply", "voxels.png", "voxels-south.png", "voxels-east.png", "voxels-depth.png"}) {
    EXPECT_TRUE(fs::exists(out_ / name)) << name;
  }
  EXPECT_THAT(test::content_of(out_ / "report.html"), HasSubstr("Voxel map"));
  EXPECT_GT(voxels["truth"]["precision"], 0.5);
  EXPECT_GT(voxels["truth"]["judged"], 100'000);
}

// A third sonar, configured in the scene, joins by a layer of its own; the map then holds more of the surfaces, more
// surely. It looks 40 degrees to port and is of the same kind as the vertical one.
// ledger: S5-30
TEST_F(Voxels, OfAThirdSonarJoinTheMapAndImproveIt) {
  std::ofstream(bridge_, std::ios::app) << R"(
[[sonar]]
preset = "p450_vertical"
name = "side"
heading_deg = -40
sound_speed = 1467.6
interval_s = 0.5
)";
  const auto truth_of = [&](const std::string& name, const std::string& without) {
    const ProgramResult run = isobath_run(
        bridge_, out_ / name, {"--set", "simulation.duration_s=20", "--set", "simulation.without=" + without});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return test::json_of(out_ / name / "manifest.json")["voxels"];
  };
  const auto two = truth_of("two", "side"), three = truth_of("three", "");
  ASSERT_EQ(three["layers"].size(), 3u);
  EXPECT_EQ(three["layers"][2]["sensor"], "upright 2");
  EXPECT_EQ(two["layers"].size(), 2u);
  EXPECT_GT(three["truth"]["recall"].get<double>(), 1.1 * two["truth"]["recall"].get<double>());
  EXPECT_GT(three["truth"]["precision"], two["truth"]["precision"]);
}

TEST_F(Voxels, AreNotMadeWhereNobodyWantsThem) {
  const ProgramResult run =
      isobath_run(bridge_, out_, {"--set", "simulation.duration_s=2", "--set", "voxels.sonars=none"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_FALSE(test::json_of(out_ / "manifest.json").contains("voxels"));
  EXPECT_FALSE(fs::exists(out_ / "voxels.bt"));
}

TEST_F(Voxels, NeedAWindowAsLargeAsTheSonarsRange) {
  EXPECT_THAT(isobath_run(bridge_, out_, {"--set", "voxels.window_m=20"}),
              ends_with_one_line(HasSubstr("voxels.window_m: the map's window reaches 20 m, and the sonar")));
}

// ledger: S5-13
TEST_F(Voxels, ThatSpillAreTheSameVoxels) {
  const auto files_of = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> options{"--set", "simulation.duration_s=4"};
    options.insert(options.end(), more.begin(), more.end());
    const ProgramResult run = isobath_run(bridge_, out_ / name, options);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return test::content_of(out_ / name / "voxels.bt") + test::content_of(out_ / name / "voxels.ply");
  };
  const std::string all = files_of("all", {});
  EXPECT_FALSE(fs::exists(out_ / "all" / "voxels.sqlite"));
  EXPECT_TRUE(files_of("bounded", {"--set", "voxels.memory_mb=1"}) == all);
  EXPECT_TRUE(files_of("window", {"--set", "voxels.window_m=90", "--set", "voxels.spill=true"}) == all);
  for (const char* name : {"bounded", "window"}) {
    const auto manifest = test::json_of(out_ / name / "manifest.json");
    EXPECT_TRUE(fs::exists(out_ / name / "voxels.sqlite"));
    EXPECT_TRUE(manifest["voxels"].contains("spilled"));
    EXPECT_THAT(test::content_of(out_ / name / "report.html"), HasSubstr("blocks on disk only"));
  }
  EXPECT_GT(test::json_of(out_ / "bounded" / "manifest.json")["voxels"]["spilled"], 100);
}

/// A log of a fan of beams under way, with a fix that jumps by 8 m and five pings that are not as they should be.
fs::path spoilt_log(const fs::path& folder) {
  fs::create_directories(folder);
  NativeLogWriter log(folder / "spoilt.mcap");
  const auto fan = test::fan_of(40, Angle::degrees(-60), Angle::degrees(3));
  for (int n = 0; n < 40; ++n) {
    const Time time(seconds(0.25 * n));
    Navigation fix;
    fix.time = time;
    fix.X_WB.translation = {0.3 * n + (n < 20 ? 0 : 8), 0, 5};
    log.write(fix);
    Ping ping = test::ping_of<float>(fan, {0, 0.2, 100}, [](int beam, int bin) {
      return beam > 15 && beam < 25 && bin > 70 && bin < 74 ? 250.0 : 20.0 + (beam * 7 + bin * 13) % 5;
    });
    ping.time = time;
    if (n == 4) ping.fan = test::fan_of(40, Angle::degrees(-200), Angle::degrees(10));
    if (n == 8) ping.window.bin_m = 0;
    if (n == 12) ping = test::ping_of<float>(fan, {0, 0.2, 100}, [](int, int bin) { return bin == 9 ? NAN : 20.0; });
    if (n == 16) ping.window.bin_m = 2e-5;
    if (n == 17) ping.window.bin_m = 400;
    ping.time = time;
    log.write(ping);
  }
  log.close();
  return folder / "spoilt.mcap";
}

// What was refused and why stands in what is printed, in the report and in the manifest; the rest is mapped.
// ledger: S6-53
TEST_F(Voxels, OfASpoiltLogAreThoseOfTheRest) {
  const fs::path log = spoilt_log(out_.string() + "_log");
  const std::vector<std::string> arguments{"run", log, "--out", out_, "--set", "echoes.method=os_cfar"};
  const ProgramResult run = test::isobath(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string report = test::content_of(out_ / "report.html");
  const auto manifest = test::json_of(out_ / "manifest.json");
  for (const char* reason : {"beams round more than a whole turn", "no usable range window", "value not finite",
                             "left out of the voxels: voxels far too small for the range of a ping",
                             "left out of the voxels: voxels far too large for the bins of a ping"}) {
    EXPECT_THAT(run.out, HasSubstr(std::string("refused 1: ") + reason));
    EXPECT_THAT(report, HasSubstr(reason));
    EXPECT_EQ(manifest["rejected"][reason], 1) << reason;
  }
  EXPECT_EQ(manifest["counts"]["pings"], 37);
  EXPECT_EQ(manifest["voxels"]["layers"][0]["pings"], 35);
  EXPECT_THAT(run.out, HasSubstr("jumps of the position: 1, by up to 8.0 m"));
  EXPECT_THAT(report, HasSubstr("the maps around the vehicle moved along"));
  EXPECT_EQ(manifest["counts"]["position_jumps"], 1);
  EXPECT_EQ(manifest["voxels"]["moved_with_jumps"], 1);
}

TEST_F(Voxels, OfAnImagingSonarShowAShip) {
  ISOBATH_NEEDS_DATA(log, "sonar3d-ship");
  const ProgramResult run = isobath_run(log, out_);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto voxels = test::json_of(out_ / "manifest.json")["voxels"];
  ASSERT_EQ(voxels["layers"].size(), 1u);
  EXPECT_EQ(voxels["layers"][0]["sensor"], "soundings");
  EXPECT_EQ(voxels["layers"][0]["pings"], 6);
  EXPECT_GT(voxels["occupied"], 4000);
  EXPECT_GT(voxels["free"], 100'000);
  EXPECT_TRUE(fs::exists(out_ / "voxels-east.png"));
}

TEST_F(Voxels, ForOpenVdbAreWrittenOrRefusedAtOnce) {
  const ProgramResult run =
      isobath_run(bridge_, out_, {"--set", "simulation.duration_s=6", "--set", "voxels.vdb=true"});
  if (run.exit_code == 0) {
    EXPECT_GT(fs::file_size(out_ / "voxels.vdb"), 10'000u);
  } else {
    EXPECT_THAT(run, ends_with_one_line(HasSubstr("voxels.vdb: this program was built without OpenVDB")));
  }
}

/// A fan of 20 m, and 120 m of way.
fs::path log_of_a_way(const fs::path& folder) {
  fs::create_directories(folder);
  NativeLogWriter log(folder / "way.mcap");
  const auto fan = test::fan_of(40, Angle::degrees(-60), Angle::degrees(3));
  for (int n = 0; n < 40; ++n) {
    Navigation fix;
    fix.time = Time(seconds(2.0 * n));
    fix.X_WB.translation = {3.0 * n, 0, 5};
    log.write(fix);
    Ping ping = test::ping_of<float>(fan, {0, 0.2, 100}, [](int beam, int bin) {
      return beam > 15 && beam < 25 && bin > 70 && bin < 74 ? 250.0 : 20.0 + (beam * 7 + bin * 13) % 5;
    });
    ping.time = fix.time;
    log.write(ping);
  }
  log.close();
  return folder / "way.mcap";
}

// ledger: S5-13 S5-60
TEST_F(Voxels, OfAWindowForgetWhatIsFarBehind) {
  const fs::path log = log_of_a_way(out_.string() + "_log");
  const auto voxels_of = [&](const char* name, const char* window) {
    const std::vector<std::string> arguments{"run",   log,   "--out", out_ / name, "--set", "echoes.method=os_cfar",
                                             "--set", window};
    const ProgramResult run = test::isobath(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return test::json_of(out_ / name / "manifest.json")["voxels"];
  };
  const auto all = voxels_of("all", "voxels.window_m=0"), near = voxels_of("near", "voxels.window_m=25");
  EXPECT_GT(all["blocks"], 0);
  EXPECT_LT(near["blocks"], all["blocks"]);
  EXPECT_LT(near["free"], all["free"]);
  EXPECT_EQ(all["voxel_m"], near["voxel_m"]);
}

}  // namespace
}  // namespace isobath
