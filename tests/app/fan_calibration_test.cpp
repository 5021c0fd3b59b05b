// isobath calibrate on an ordinary recording of a fan, and a run that starts from what it learnt, as a user meets them.
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::HasSubstr;
using testing::Not;

/// A minute past a pile, two pings a second.
std::string scene(const std::string& sonar) {
  return "[scene]\ntitle = \"a minute\"\nduration_s = 60\n[vehicle]\nstart = [0, 0, 5]\nspeed = 0.3\n"
         "[[waypoint]]\nnorth = 18\ndepth = 5\n[bottom]\nkind = \"terrain\"\nmaterial = \"sand\"\ndepth = 12\n"
         "extent_m = 80\ncell_m = 2\nrelief_m = 0.2\n[[cylinder]]\nname = \"pile\"\ncentre = [26, 6, 5]\nradius = 0.4\n"
         "length = 14\n[[sonar]]\n" +
         sonar;
}
const std::string kBlueView = "preset = \"p450_horizontal\"\nrange_m = 20\nbins = 240\ninterval_s = 0.5\n";

fs::path recorded(const fs::path& folder, const std::string& name, const std::string& sonar) {
  const ProgramResult made =
      test::isobath({"sim", write(folder / (name + ".toml"), scene(sonar)), "--out", folder / (name + ".mcap")});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  return folder / (name + ".mcap");
}

// ledger: S6-06 S6-09
TEST(FanCalibration, OfASimulatedMinuteStartsARun) {
  const fs::path folder = scratch_folder(), log = recorded(folder, "blueview", kBlueView);
  const ProgramResult made = test::isobath({"calibrate", log, "--out", folder / "sonar", "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  for (const char* name : {"fan_model.json", "fan_level.png", "fan_gains.png", "sensor_model.json"})
    EXPECT_TRUE(fs::exists(folder / "sonar" / name)) << name;
  const auto fan = nlohmann::json::parse(made.out)["fan"];
  EXPECT_GE(fan["pings"], 100);
  EXPECT_NEAR(fan["quality"][0]["whole"]["ratio"], 1, 0.5);

  const fs::path model = folder / "sonar" / "fan_model.json";
  const ProgramResult run = isobath_run(log, folder / "run", {"--model", model, "--set", "voxels.sonars=none"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto used = nlohmann::json::parse(run.out)["fan_model"];
  EXPECT_EQ(used["source"], "blueview.mcap");
  EXPECT_EQ(used["same_setting"], true);
  EXPECT_EQ(used["laws_dropped"], false);
  EXPECT_NEAR(used["level_db"], 0, 0.5);
  EXPECT_EQ(json_of(folder / "run" / "manifest.json")["fan_model"]["source"], "blueview.mcap");
  EXPECT_THAT(content_of(folder / "run" / "report.html"), HasSubstr("fan model of blueview.mcap"));
}

TEST(FanCalibration, OfAnotherSonarIsRefusedAndOfAnotherSettingHalfUsed) {
  const fs::path folder = scratch_folder(), log = recorded(folder, "blueview", kBlueView);
  const ProgramResult made = test::isobath({"calibrate", log, "--out", folder / "sonar"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  for (const char* line : {"sonar: ", "recording: ", "blind zone: ", "gains: ", "dead beams: none", "correlation of ",
                           "false alarms at 0.0001, measured over nominal: "}) {
    EXPECT_THAT(made.out, HasSubstr(line));
  }
  const fs::path model = folder / "sonar" / "fan_model.json";
  const fs::path far =
      recorded(folder, "far", "preset = \"p450_horizontal\"\nrange_m = 30\nbins = 240\ninterval_s = 2\n");
  const ProgramResult other_setting = test::isobath({"run", far, "--out", folder / "run", "--model", model});
  EXPECT_EQ(other_setting.exit_code, 0) << other_setting.err;
  EXPECT_THAT(other_setting.out, HasSubstr("another setting, so only its tail laws were used"));
  const fs::path didson = recorded(folder, "didson", "preset = \"didson\"\nbins = 200\ninterval_s = 5\n");
  EXPECT_THAT(isobath_run(didson, folder / "refused", {"--model", model}),
              ends_with_one_line(HasSubstr("the fan model is of another sonar")));
}

// 87 frames of a DIDSON, water without targets.
TEST(FanCalibration, OfAFolderOfRealFrames) {
  ISOBATH_NEEDS_DATA(frames, "didson-hull/background");
  const fs::path folder = scratch_folder();
  const ProgramResult made = test::isobath({"calibrate", frames, "--out", folder, "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto fan = nlohmann::json::parse(made.out)["fan"];
  EXPECT_EQ(fan["beams"], 96);
  EXPECT_EQ(fan["pings"], 87);
  EXPECT_NEAR(fan["quality"][0]["whole"]["ratio"], 1, 0.5);
}

}  // namespace
}  // namespace isobath
