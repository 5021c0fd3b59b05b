// Folders of camera pairs: names, times, and what is wrong with them.
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/io/frames/pair_reader.hpp>
#include <isobath/io/frames/pair_writer.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <tests/support/data.hpp>
#include <tests/support/events.hpp>

namespace isobath::pair_folder {
namespace {

using testing::HasSubstr;

constexpr const char* kCameras = "[left]\nwidth = 64\nheight = 48\n[right]\nwidth = 64\nheight = 48\n";

class PairFolderTest : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  void picture(const std::string& name) const { write_camera_image(folder_ / name, CameraImage(64, 48, 1)); }
  void describe(const std::string& lines) const {
    put("rig.toml", kCameras);
    put("pairs.toml", "[pairs]\ncalibration = \"rig.toml\"\n" + lines);
  }
  [[nodiscard]] PairRig rig() const { return read_pair_rig(folder_ / "pairs.toml"); }
  /// Seconds of all pairs.
  std::vector<double> times() {
    report_ = {};
    const auto reader = open_pair_folder(folder_, rig(), report_);
    std::vector<double> times;
    while (const auto pair = reader->next(report_)) times.push_back(to_seconds(pair->time.time_since_epoch()));
    return times;
  }
  [[nodiscard]] std::string error_of_rig() const {
    try {
      (void)rig();
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }
  const std::filesystem::path folder_ = test::scratch_folder();
  SourceReport report_;
};

// ledger: S8-07
TEST_F(PairFolderTest, TimesAreInTheNamesInATableOrFollowFromTheRate) {
  for (const char* name : {"left_10000000.png", "right_10000000.png", "left_9500000.png", "right_9500000.png"}) {
    picture(name);
  }
  describe("");
  EXPECT_TRUE(looks_like_pair_folder(folder_));
  EXPECT_THAT(times(), testing::ElementsAre(9.5, 10)) << "numbers, not texts";
  EXPECT_EQ(report_.format, "folder of camera pairs");
  EXPECT_EQ(report_.bytes_read, report_.bytes_total);
  describe("rate_hz = 4\nstart_s = 100\n");
  EXPECT_THAT(times(), testing::ElementsAre(100, 100.25));
  put("times.csv", "name,t_s\n10000000,7\n9500000,8\n");
  describe("times = \"times.csv\"\n");
  EXPECT_THAT(times(), testing::ElementsAre(7, 8)) << "in the order of time";
}

TEST_F(PairFolderTest, PicturesWithoutPartnerOrTimeAndUnreadableOnesAreCounted) {
  describe("left = \"L*.png\"\nright = \"R*.png\"\n");
  for (const char* name : {"L1.png", "R1.png", "L2.png", "R3.png", "Lx.png", "Rx.png", "L4.png", "other.png"}) {
    picture(name);
  }
  put("R4.png", "no picture");
  EXPECT_EQ(times().size(), 1u);
  EXPECT_EQ(report_.rejected.at("picture without its partner"), 2u);
  EXPECT_EQ(report_.rejected.at("pair whose time is not stated"), 1u);
  EXPECT_EQ(report_.rejected.at("pair with an unreadable picture"), 1u);
  ASSERT_EQ(report_.damages.size(), 1u);
  EXPECT_THAT(report_.damages[0].reason, HasSubstr("R4.png"));
}

TEST_F(PairFolderTest, AFolderWithoutPairsIsAnError) {
  describe("");
  picture("left_1.png");
  EXPECT_THROW(times(), Error);
}

TEST_F(PairFolderTest, EachMistakeOfTheFileIsOneSentence) {
  put("rig.toml", kCameras);
  put("pairs.toml", "[pairs]\n");
  EXPECT_THAT(error_of_rig(), HasSubstr("pairs.calibration: is missing"));
  describe("left = \"left.png\"\n");
  EXPECT_THAT(error_of_rig(), HasSubstr("no name with one *"));
  describe("left_topic = \"/left\"\n");
  EXPECT_THAT(error_of_rig(), HasSubstr("one topic is no pair"));
  describe("rate_hz = 2\ntimes = \"times.csv\"\n");
  EXPECT_THAT(error_of_rig(), HasSubstr("both a rate and a file of times"));
  describe("rate = 2\n");
  EXPECT_THAT(error_of_rig(), HasSubstr("rate_hz")) << "the nearest known key";
  describe("");
  put("rig.toml", std::string(kCameras) + "[motion]\ntranslation_m = [0.1, 0, 0]\n");
  EXPECT_THAT(error_of_rig(), HasSubstr("one camera that moves"));
}

// ledger: S8-07
TEST_F(PairFolderTest, AWrittenFolderIsReadAsItWasWritten) {
  const auto out = folder_ / "pairs";
  PairRig rig;
  rig.position = {0.5, 0, 0.1};
  rig.pitch = Angle::degrees(-60);
  PairFolderWriter writer(out, rig, kCameras);
  CameraPair pair{Time(seconds(1.5)), CameraImage(64, 48, 3), CameraImage(64, 48, 3)};
  pair.right.samples[100] = 200;
  const Navigation fix = test::fix_at(1.25, 3, 40);
  writer.write(fix);
  writer.write(pair);
  writer.close();
  const PairRig read = read_pair_rig(out / "pairs.toml");
  EXPECT_NEAR(read.pitch.degrees(), -60, 1e-9);
  EXPECT_EQ(read.position, rig.position);
  EXPECT_EQ(read.cameras.left.width, 64);
  const auto again = open_pair_folder(out, read, report_)->next(report_);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->time, pair.time);
  EXPECT_EQ(again->right, pair.right);
  const auto pose = open_pose_track(read.poses)->next();
  ASSERT_TRUE(pose && std::holds_alternative<Navigation>(*pose));
  EXPECT_NEAR((std::get<Navigation>(*pose).X_WB.translation - fix.X_WB.translation).norm(), 0, 1e-8);
  EXPECT_NEAR(std::get<Navigation>(*pose).X_WB.rotation.heading().degrees(), 40, 1e-6);
}

}  // namespace
}  // namespace isobath::pair_folder
