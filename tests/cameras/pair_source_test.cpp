// Folders of pairs and logs of ROS with two image topics as sources of events.
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/cameras/pair_source.hpp>
#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/io/frames/pair_writer.hpp>
#include <tests/io/ros_logs.hpp>
#include <tests/stereo/simulated_pairs.hpp>
#include <tests/support/data.hpp>
#include <tests/support/events.hpp>

namespace isobath::pair_source {
namespace {

using testing::HasSubstr;

constexpr const char* kCameras =
    "[left]\nwidth = 160\nheight = 120\nfx = 140\nfy = 140\ncx = 79.5\ncy = 59.5\n"
    "[right]\nwidth = 160\nheight = 120\nfx = 140\nfy = 140\ncx = 79.5\ncy = 59.5\n"
    "[pair]\ntranslation_m = [-0.12, 0, 0]\n";

Pose at(double t) { return {{}, {0.1 * t, 0, 5}}; }

class PairSourceTest : public testing::Test {
 protected:
  /// Three pairs and seven fixes.
  void write_folder() {
    PairFolderWriter writer(folder_ / "pairs", {}, kCameras);
    for (int i = 0; i < 7; ++i) {
      Navigation fix = test::fix_at(0.25 * i, 0);
      fix.X_WB = at(0.25 * i);
      writer.write(fix);
    }
    for (const double t : {0.0, 0.5, 1.0}) writer.write(pairs_.at(at(t), t));
    writer.close();
  }
  [[nodiscard]] std::unique_ptr<Source> open(const InputConfig& config = {}) const {
    return open_input(folder_ / "pairs", config, {});
  }
  [[nodiscard]] std::string error_of_opening() const {
    try {
      (void)open();
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }
  void put(const std::string& name, const CameraImage& image) const {
    write_camera_image(folder_ / "pairs" / name, image);
  }
  [[nodiscard]] CameraImage picture(const std::string& name) const {
    return read_camera_image(folder_ / "pairs" / name);
  }
  const std::filesystem::path folder_ = test::scratch_folder();
  test::SimulatedPairs pairs_;
};

// ledger: S8-07 S1-79
TEST_F(PairSourceTest, AFolderGivesASwathAPairBetweenTheFixes) {
  write_folder();
  const auto source = open();
  std::string order;
  std::size_t soundings = 0;
  Time last{};
  while (const auto event = source->next()) {
    EXPECT_GE(time_of(*event), last);
    last = time_of(*event);
    const auto* swath = std::get_if<Swath>(&*event);
    order += swath ? 'S' : std::holds_alternative<Navigation>(*event) ? 'n' : '?';
    if (swath) soundings += swath->soundings.size();
  }
  EXPECT_EQ(order, "nSnnSnnSnn") << "a fix of the time of a pair comes first";
  EXPECT_GT(soundings, 300u);
  EXPECT_EQ(source->report().format, "folder of camera pairs");
  EXPECT_THAT(source->report().details.at("cameras"), HasSubstr("3 pairs, 3 with ranges"));
}

// ledger: S8-11
TEST_F(PairSourceTest, ABlackPictureGivesNothingAndIsCounted) {
  write_folder();
  put("left_500000.png", CameraImage(160, 120, 3));
  const auto source = open();
  int swaths = 0;
  while (const auto event = source->next()) swaths += std::holds_alternative<Swath>(*event) ? 1 : 0;
  EXPECT_EQ(swaths, 2);
  EXPECT_EQ(source->report().rejected.at("black or blank picture"), 1u);
}

// ledger: S8-08 S8-09
TEST_F(PairSourceTest, AWrongRigIsRefusedInOneSentence) {
  write_folder();
  const CameraImage left = picture("left_0.png"), right = picture("right_0.png");
  put("left_0.png", right);
  put("right_0.png", left);
  EXPECT_THAT(error_of_opening(), HasSubstr("left and right exchanged"));
  put("left_0.png", left);
  put("right_0.png", halved(right));
  EXPECT_THAT(error_of_opening(), HasSubstr("differ in size"));
  put("left_0.png", halved(left));
  EXPECT_THAT(error_of_opening(), HasSubstr("another size than the calibration's"));
  put("left_0.png", left);
  put("right_0.png", right);
  EXPECT_EQ(error_of_opening(), "");
  std::string nodded = kCameras;
  nodded += "rotation = [1, 0, 0, 0, 0.9995500, -0.0299955, 0, 0.0299955, 0.9995500]\n";
  std::ofstream(folder_ / "pairs/rig.toml") << nodded;
  EXPECT_THAT(error_of_opening(), HasSubstr("rows miss each other: the calibration is of other cameras"));
}

TEST_F(PairSourceTest, PosesOfAnotherFileReplaceThoseOfTheFolder) {
  write_folder();
  std::ofstream(folder_ / "other.csv") << "t_s,north_m,east_m,depth_m,heading_deg\n0,50,0,5,0\n2,50,0,5,0\n";
  InputConfig config;
  config.navigation = (folder_ / "other.csv").string();
  const auto event = open(config)->next();
  ASSERT_TRUE(event && std::holds_alternative<Navigation>(*event));
  EXPECT_EQ(std::get<Navigation>(*event).X_WB.translation.x(), 50);
}

/// A log of ROS with two image topics and a pose; every third picture of the right eye is missing.
test::RosLog ros_log(test::SimulatedPairs& pairs, bool cdr) {
  test::RosLog log;
  const char* const image =
      "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] "
      "data\n";
  log.topics = {{"/left/image_raw", "sensor_msgs/Image", image}, {"/right/image_raw", "sensor_msgs/Image", image}};
  for (int i = 0; i < 3; ++i) {
    const double t = 100 + 0.5 * i;
    const CameraPair pair = pairs.at(at(0.5 * i), t);
    for (const std::size_t eye : {std::size_t{0}, std::size_t{1}}) {
      if (i == 2 && eye == 1) continue;
      const CameraImage& picture = eye == 0 ? pair.left : pair.right;
      test::RosBytes bytes(cdr);
      bytes.header(t + 0.001 * static_cast<double>(eye), "camera")
          .number(static_cast<std::uint32_t>(picture.height))
          .number(static_cast<std::uint32_t>(picture.width))
          .text("rgb8")
          .number(std::uint8_t{0})
          .number(static_cast<std::uint32_t>(3 * picture.width))
          .bytes(std::string(picture.samples.begin(), picture.samples.end()));
      log.messages.push_back({eye, t, bytes.done()});
    }
  }
  return log;
}

// ledger: S8-07
TEST_F(PairSourceTest, LogsOfRosGiveTheSwathsOfTheirImageTopics) {
  std::ofstream(folder_ / "one.bag", std::ios::binary) << test::ros1_bag(ros_log(pairs_, false));
  test::write_ros_mcap(folder_ / "one.mcap", ros_log(pairs_, true), true);
  test::write_ros2_database(folder_ / "one.db3", ros_log(pairs_, true), false);
  std::ofstream(folder_ / "rig.toml") << kCameras;
  std::ofstream(folder_ / "pairs.toml") << "[pairs]\ncalibration = \"rig.toml\"\nleft_topic = \"/left/image_raw\"\n"
                                        << "right_topic = \"/right/image_raw\"\n";
  InputConfig config;
  config.cameras = (folder_ / "pairs.toml").string();
  for (const char* name : {"one.bag", "one.mcap", "one.db3"}) {
    const auto source = open_input(folder_ / name, config, {});
    std::vector<Time> times;
    while (const auto event = source->next()) {
      if (std::holds_alternative<Swath>(*event)) times.push_back(time_of(*event));
    }
    EXPECT_THAT(times, testing::ElementsAre(Time(seconds(100)), Time(seconds(100.5)))) << name;
  }
  std::ofstream(folder_ / "pairs.toml") << "[pairs]\ncalibration = \"rig.toml\"\nleft_topic = \"/left\"\n"
                                        << "right_topic = \"/right/image_raw\"\n";
  try {
    (void)open_input(folder_ / "one.bag", config, {});
    ADD_FAILURE() << "a topic that is not there";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no pictures on the topic /left"));
    EXPECT_THAT(error.what(), HasSubstr("/left/image_raw, /right/image_raw")) << "those that are";
  }
}

}  // namespace
}  // namespace isobath::pair_source
