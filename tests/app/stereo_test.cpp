// `isobath stereo` on simulated pairs, and on pairs that are wrong.
#include <fmt/format.h>
#include <fstream>
#include <isobath/io/frames/camera_pictures.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using Words = std::vector<std::string>;

std::string camera(const std::string& name) {
  return (test::source_folder() / "scenarios" / "cameras" / (name + ".toml")).string();
}

class StereoProgram : public testing::Test {
 protected:
  test::ProgramResult stereo(Words words, Words more = {}) {
    words.insert(words.begin(), "stereo");
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"--out", (folder_ / "out").string()});
    return test::isobath(words);
  }
  json of_scene(const std::string& rig, const Words& more = {}) {
    Words words = {"--scene", camera("reef_wall"), "--calibration", camera(rig), "--json"};
    const auto result = stereo(words, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  }
  std::string picture(const std::string& name, const CameraImage& image) {
    write_camera_image(folder_ / name, image);
    return (folder_ / name).string();
  }
  const std::filesystem::path folder_ = test::scratch_folder();
};

// ledger: S8-01 S8-D01
TEST_F(StereoProgram, ASimulatedPairIsMatchedAndRanged) {
  const json pair = of_scene("pair_256");
  EXPECT_LT(pair["truth"]["bad_1"], 0.05);
  EXPECT_LT(pair["vertical"]["median_absolute_px"], 0.3);
  EXPECT_LT(pair["ranges"]["median_error"], 0.02);
  EXPECT_GT(pair["readings"], 100);
  for (const char* name : {"disparity.png", "confidence.png", "depth.png", "uncertainty.png"}) {
    EXPECT_EQ(test::content_of(folder_ / "out" / name).substr(1, 3), "PNG") << name;
  }
  EXPECT_THAT(test::content_of(folder_ / "out/points.ply"),
              HasSubstr(fmt::format("element vertex {}\n", pair["points"].get<int>())));
  const NumberMap map = read_number_map(folder_ / "out/disparity.pfm", 1);
  EXPECT_EQ(map.width, 256);
  // The plain loops give the same map.
  const std::string before = test::content_of(folder_ / "out/disparity.pfm");
  of_scene("pair_256", {"--plain"});
  EXPECT_EQ(test::content_of(folder_ / "out/disparity.pfm"), before) << "S8-06";
}

// ledger: S8-10 S8-13
TEST_F(StereoProgram, ThroughAPortRangesAreRightWithItsModelAndAQuarterShortWithout) {
  const json with = of_scene("pair_in_water");
  EXPECT_LT(std::abs(with["ranges"]["axis_bias"].get<double>()), 0.02);
  EXPECT_GT(with["ranges"]["within_5cm"], 0.9);
  const json without = of_scene("pair_in_water", {"--in-air"});
  EXPECT_NEAR(without["ranges"]["axis_bias"], 1 / 1.34 - 1, 0.03);
}

// ledger: S8-11
TEST_F(StereoProgram, TheUsableRangeShrinksWithTurbidity) {
  const std::string clear = test::content_of(camera("pair_in_water"));
  const std::size_t light = clear.find("[light]");
  const auto usable = [&](double attenuation) {
    test::write(folder_ / "rig.toml",
                clear.substr(0, light) + fmt::format("[light]\nattenuation_per_m = [{0}, {0}, {0}]\n"
                                                     "backscatter_per_m = [{0}, {0}, {0}]\nveil = [90, 90, 90]\n",
                                                     attenuation));
    const auto result = stereo({"--scene", camera("reef_wall"), "--calibration", (folder_ / "rig.toml").string(),
                                "--json", "--set", "stereo.min_contrast=0.8"});
    return json::parse(result.out)["ranges"]["usable_range_m"].get<double>();
  };
  const double far = usable(0.1), near = usable(2.5);
  EXPECT_GE(far, 3);
  EXPECT_LE(near, 2.5);
}

// ledger: S8-04 S8-D02
TEST_F(StereoProgram, ColourMatchesWhatBrightnessDoesNot) {
  EXPECT_LT(of_scene("pair_isoluminant", {"--set", "stereo.colour=true"})["truth"]["bad_1"], 0.1);
  EXPECT_GT(of_scene("pair_isoluminant")["truth"]["bad_1"], 0.5);
}

// ledger: S8-05 S8-D03
TEST_F(StereoProgram, AMovingCameraRanges) {
  const json motion = of_scene("moving_camera", {"--set", "motion_stereo.every=4"});
  EXPECT_GT(motion["ranges_off_focus"]["pixels"], 3000);
  EXPECT_LT(motion["ranges_off_focus"]["median_error"], 0.05);
}

// The 13 pairs that OpenCV ships; Debian's opencv-doc. ledger: S8-09
TEST_F(StereoProgram, CalibratesFromAChessboardSoThatRowsMeet) {
  ISOBATH_NEEDS_DATA(data, "stereo-debian");
  Words words = {"--calibrate"};
  for (const char* eye : {"left", "right"}) {
    for (const int i : {1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14})
      words.push_back((data / "opencv" / fmt::format("{}{:02}.jpg", eye, i)).string());
  }
  const auto result = stereo(words, {"--json"});
  if (result.exit_code == 2 && result.err.find("without OpenCV") != std::string::npos) GTEST_SKIP() << result.err;
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json found = json::parse(result.out);
  EXPECT_EQ(found["used"], 13);
  EXPECT_LT(found["rms_px"], 0.6);
  std::filesystem::copy(folder_ / "out/rig.toml", folder_ / "rig.toml");
  EXPECT_THAT(test::content_of(folder_ / "rig.toml"), testing::ContainsRegex("fx = 53[56]\\."))
      << "OpenCV's own left_intrinsics.yml has 535.9";
  const json pair = json::parse(stereo({words[1], words[14], "--calibration", (folder_ / "rig.toml").string(), "--json",
                                        "--set", "stereo.disparities=128"})
                                    .out);
  EXPECT_LT(pair["vertical"]["median_absolute_px"], 0.3);
}

// ledger: S8-09
TEST_F(StereoProgram, PicturesThatCannotBeAPairAreRefusedInOneSentence) {
  of_scene("pair_256");
  std::filesystem::copy(folder_ / "out", folder_ / "pair");
  const std::string l = (folder_ / "pair/left.png").string(), r = (folder_ / "pair/right.png").string();
  EXPECT_EQ(stereo({l, r}).exit_code, 0);
  EXPECT_THAT(stereo({l, r}).out, HasSubstr("no ranges: the pair has no calibration"));
  EXPECT_THAT(stereo({r, l}), test::ends_with_one_line(HasSubstr("left and right are exchanged")));
  EXPECT_THAT(stereo({l, picture("black.png", CameraImage(256, 256, 1))}),
              test::ends_with_one_line(HasSubstr("black.png: shows nothing")));
  EXPECT_THAT(stereo({l, picture("small.png", halved(read_camera_image(r)))}),
              test::ends_with_one_line(HasSubstr("the pictures differ in size: 256 x 256 and 128 x 128")));
  // The right camera moved by two pixels since the calibration.
  const CameraImage whole = read_camera_image(r);
  CameraImage lower(256, 256, 3);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      for (int c = 0; c < 3; ++c) lower(x, y, c) = whole(x, std::max(0, y - 2), c);
    }
  }
  EXPECT_THAT(stereo({l, picture("lower.png", lower), "--calibration", camera("pair_256")}),
              test::ends_with_one_line(HasSubstr("the rows of the pair miss each other by")));
  EXPECT_THAT(stereo({l, r, "--calibration", camera("pair_in_water")}),
              test::ends_with_one_line(HasSubstr("is of pictures of 400 x 300 pixels; these have 256 x 256")));
  std::ofstream(folder_ / "text.png") << "no picture";
  EXPECT_THAT(stereo({l, (folder_ / "text.png").string()}),
              test::ends_with_one_line(HasSubstr("is no picture that can be read; allowed: PNG, JPEG")));
  EXPECT_THAT(stereo({l}), test::ends_with_one_line(HasSubstr("needs two pictures, or --scene")));
  EXPECT_THAT(stereo({l, r, "--set", "stereo.window=4"}), test::ends_with_one_line(HasSubstr("4 is even")));
  EXPECT_THAT(stereo({l, r, "--set", "stereo.disparities=100"}),
              test::ends_with_one_line(HasSubstr("100 is not a multiple of 64")));
}

}  // namespace
}  // namespace isobath
