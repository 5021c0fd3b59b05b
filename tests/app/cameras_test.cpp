// Cameras as an input and as a sensor, as a user meets them.
#include <gmock/gmock.h>
#include <isobath/io/frames/camera_pictures.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using nlohmann::json;
using test::ends_with_one_line;
using test::isobath_run;
using testing::HasSubstr;

std::string camera_scene(const std::string& name) {
  return (test::source_folder() / "scenarios" / "cameras" / (name + ".toml")).string();
}

// ledger: S8-07 S1-79
TEST(Cameras, TheirPairsAreWrittenBySimAndMappedByRun) {
  const auto folder = test::scratch_folder();
  const auto sim = test::isobath(
      {"sim", camera_scene("survey_by_cameras"), "--pairs", (folder / "pairs").string(), "--duration", "6", "--json"});
  ASSERT_EQ(sim.exit_code, 0) << sim.err;
  EXPECT_EQ(json::parse(sim.out)["counts"]["pairs"], 13);
  const auto info = test::isobath({"info", (folder / "pairs").string()});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("folder of camera pairs"));
  EXPECT_THAT(info.out, HasSubstr("13 pairs, 13 with ranges"));
  const auto run = isobath_run(folder / "pairs", folder / "out", {});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json result = json::parse(run.out);
  EXPECT_GT(result["depth"]["applied"], 2000) << "soundings in the depth map";
  EXPECT_GT(result["voxels"]["occupied"], 100);
  EXPECT_EQ(result["voxels"]["layers"][0]["pings"], 13);
  EXPECT_GT(result["sphere"]["occupied"], 100);
  // Without texture there is nothing to see.
  const auto blind = isobath_run(folder / "pairs", folder / "blind", {"--set", "cameras.min_contrast=50"});
  EXPECT_THAT(blind.out, HasSubstr("pair without a range"));
  // Eyes that changed places are noticed.
  std::filesystem::rename(folder / "pairs/left_0.png", folder / "pairs/other.png");
  std::filesystem::rename(folder / "pairs/right_0.png", folder / "pairs/left_0.png");
  std::filesystem::rename(folder / "pairs/other.png", folder / "pairs/right_0.png");
  EXPECT_THAT(isobath_run(folder / "pairs", folder / "wrong", {}),
              ends_with_one_line(HasSubstr("left and right exchanged")));
}

TEST(Cameras, APairsFolderNeedsAScenesCameras) {
  const auto folder = test::scratch_folder();
  EXPECT_THAT(test::isobath({"sim", "--pairs", (folder / "pairs").string()}),
              ends_with_one_line(HasSubstr("the scene has no cameras")));
}

// In a current of 0.3 m/s, with no velocity log and no fixes. ledger: S7-15 S8-07 S8-13
TEST(Cameras, AVehicleHoldsItsStationInACurrentOnPicturesAlone) {
  const auto folder = test::scratch_folder();
  (void)isobath_run(camera_scene("station_by_cameras"), folder / "with", {"--set", "simulation.duration_s=25"});
  const json with = test::json_of(folder / "with/mission.json")["truth"]["held"][0];
  EXPECT_LT(with["largest_m"], 0.2);
  (void)isobath_run(camera_scene("station_by_cameras"), folder / "without",
                    {"--set", "simulation.duration_s=25", "--set", "cameras.navigation=false"});
  const json without = test::json_of(folder / "without/mission.json")["truth"]["held"][0];
  EXPECT_GT(without["largest_m"], 0.5) << "dead reckoning alone is carried off";
}

}  // namespace
}  // namespace isobath
