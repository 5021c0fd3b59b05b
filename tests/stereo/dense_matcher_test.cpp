// Dense matching against pairs of textured planes and spheres, and the vectors against plain loops.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/stereo/dense_matcher.hpp>
#include <isobath/stereo/disparity_kernel.hpp>
#include <isobath/stereo/disparity_score.hpp>
#include <isobath/stereo/optics/water_light.hpp>
#include <tests/stereo/ray_pictures.hpp>
#include <tests/support/vector_targets.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

bool same_bits(const DisparityMap& a, const DisparityMap& b) {
  const auto bytes = [](const std::vector<float>& v) {
    return std::string(reinterpret_cast<const char*>(v.data()), 4 * v.size());
  };
  return bytes(a.disparity) == bytes(b.disparity) && bytes(a.confidence) == bytes(b.confidence) && a.state == b.state;
}

CameraImage noise_picture(int width, int height, int channels, std::uint64_t seed) {
  CameraImage image(width, height, channels);
  Random random(seed);
  for (std::uint8_t& sample : image.samples) sample = static_cast<std::uint8_t>(random.index(256));
  return image;
}

// ledger: S8-01
TEST(DenseMatcher, FindsThePlanesAndSpheresOfATexturedRoom) {
  const test::RayPair pair = test::room();
  const std::vector<float> truth = pair.truth();
  DenseMatcher matcher({});
  const DisparityMap map = matcher.match(pair.left(test::textured()), pair.right(test::textured()));
  const DisparityScore score = score_disparity(map, truth, 64);
  EXPECT_GT(score.pixels, 40'000u);
  EXPECT_LT(score.bad_1, 0.05) << "95 % of the textured pixels are within 1";
}

// A card before a wall hides a strip of it from the right camera. ledger: S8-08
TEST(DenseMatcher, MarksWhatACardHidesFromTheRightCamera) {
  test::RayPair pair;
  pair.baseline = 0.25;
  pair.scene = {test::plane({0, 0, 1}, 3), test::card({0.05, 0, 1.3}, 0.3)};
  DenseMatcher matcher({});
  const DisparityMap map = matcher.match(pair.left(test::textured()), pair.right(test::textured()));
  const DisparityScore score = score_disparity(map, pair.truth(), 64);
  EXPECT_GT(score.hidden, 4000u);
  EXPECT_GT(score.hidden_flagged, 0.9);
  EXPECT_LT(score.bad_1, 0.05);
}

// ledger: S8-08
TEST(DenseMatcher, RefinesASlantedPlaneToAQuarterOfAPixel) {
  test::RayPair pair;
  pair.scene = {test::plane(Vector3d(0.4, 0.2, 1).normalized(), 1.8)};
  DenseMatcher matcher({});
  const DisparityMap map = matcher.match(pair.left(test::textured()), pair.right(test::textured()));
  const std::vector<float> truth = pair.truth();
  double sum = 0, whole = 0;
  int valid = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!std::isfinite(map.disparity[i])) continue;
    sum += std::abs(map.disparity[i] - truth[i]);
    whole += std::abs(std::round(map.disparity[i]) - truth[i]);
    ++valid;
  }
  EXPECT_GT(valid, 55'000);
  EXPECT_LT(sum / valid, 0.25);
  EXPECT_LT(sum, 0.8 * whole) << "better than whole pixels";
}

// ledger: S8-03 S8-06 S8-12
TEST(DenseMatcher, VectorsOfEveryInstructionSetGiveTheBitsOfThePlainLoops) {
  struct Case {
    int width, height, channels, disparities, min_disparity, window;
  };
  for (const Case& c : {Case{64, 32, 1, 64, 0, 5}, Case{131, 50, 1, 64, 3, 1}, Case{97, 41, 3, 64, -5, 3},
                        Case{150, 37, 1, 128, 0, 15}, Case{200, 30, 3, 192, 0, 9}}) {
    StereoConfig config;
    config.disparities = c.disparities;
    config.min_disparity = c.min_disparity;
    config.window = c.window;
    config.speckle_pixels = 0;
    config.uniqueness = 0;
    CameraImage left = noise_picture(c.width, c.height, c.channels, 1), right = left;
    for (int y = 0; y < c.height; ++y) {  // the left picture moved by 7, with noise in places
      for (int x = 0; x + 7 < c.width; ++x) {
        for (int k = 0; k < c.channels; ++k) right(x, y, k) = left(x + 7, y, k);
      }
    }
    const DisparityMap plain = DenseMatcher(config, true).match(left, right);
    EXPECT_GT(plain.share_of(PixelState::kValid), 0.3) << c.width;
    for (const char* target : test::vector_targets()) {
      test::use_vector_target(target);
      EXPECT_TRUE(same_bits(DenseMatcher(config).match(left, right), plain)) << target << ", width " << c.width;
    }
    test::use_vector_target("");
  }
  EXPECT_THROW(test::use_vector_target("abacus"), std::runtime_error);
  test::use_vector_target("");
}

// The sums of a window against the definition. ledger: S8-03
TEST(DisparityKernel, RunningSumsGiveTheMeanOfTheWindow) {
  MatchingCosts costs;
  costs.width = 70;
  const std::size_t row = 70 * 64;
  for (const int radius : {1, 2, 7}) {
    std::vector<std::vector<std::uint8_t>> rows;
    std::vector<std::uint16_t> columns(row, 0);
    Random random(3);
    for (int y = 0; y < 2 * radius + 2; ++y) {
      rows.emplace_back(row);
      for (std::uint8_t& v : rows.back()) v = static_cast<std::uint8_t>(random.index(120));
      vector_kernel().move_columns(columns.data(), rows.back().data(), y > 2 * radius ? rows.front().data() : nullptr,
                                   row);
    }
    const int count = (2 * radius + 1) * (2 * radius + 1);
    std::vector<std::uint8_t> means(row);
    vector_kernel().window_means(costs, columns.data(), radius, static_cast<std::uint16_t>((65536 + count - 1) / count),
                                 means.data());
    for (const int x : {0, 1, 35, 69}) {
      int sum = 0;
      for (int y = 1; y < 2 * radius + 2; ++y) {
        for (int k = -radius; k <= radius; ++k) {
          sum += rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(std::clamp(x + k, 0, 69)) * 64 + 11];
        }
      }
      EXPECT_NEAR(means[static_cast<std::size_t>(x) * 64 + 11], sum / double(count), 1.0);
    }
  }
}

// Red and green change against each other, so that the brightness stays: 77 R + 150 G + 29 B is constant.
// ledger: S8-04 S8-D02
TEST(DenseMatcher, ColourMatchesATextureThatHasOneBrightness) {
  test::RayPair pair;
  pair.scene = {test::plane(Vector3d(0.2, 0, 1).normalized(), 1.9)};
  const std::vector<test::Shade> isoluminant = {
      [](const test::RayEnd& end) { return 128 + 220 * (test::waves(end.p) - 0.5); },
      [](const test::RayEnd& end) { return 128 - 220 * 77 / 150.0 * (test::waves(end.p) - 0.5); },
      [](const test::RayEnd&) { return 128.0; }};
  const CameraImage left = pair.left(isoluminant), right = pair.right(isoluminant);
  const std::vector<float> truth = pair.truth();
  DenseMatcher matcher({});
  const DisparityScore colour = score_disparity(matcher.match(left, right), truth, 64);
  const DisparityScore grey = score_disparity(matcher.match(grey_of(left), grey_of(right)), truth, 64);
  EXPECT_LT(colour.bad_1, 0.05);
  EXPECT_GT(grey.bad_1, 0.5);

  StereoConfig no_red;
  no_red.red = 0.05;
  EXPECT_LT(score_disparity(DenseMatcher(no_red).match(left, right), truth, 64).bad_1, 0.05)
      << "where red is lost, green still tells";
}

// ledger: S8-11
TEST(DenseMatcher, TurbidWaterMakesPixelsInvalidNotWrong) {
  test::RayPair pair;
  pair.baseline = 0.3;
  pair.scene = {test::plane({0, 1, 0}, 0.7), test::plane({0, 0, 1}, 9)};  // a floor that goes away to 9 m
  const std::vector<float> truth = pair.truth();
  double valid_before = 2;
  for (const double c : {0.05, 0.4, 0.8, 1.6}) {
    WaterLight light;
    light.attenuation_per_m = light.backscatter_per_m = Vector3d::Constant(c);
    light.veil = Vector3d::Constant(110);
    const std::vector<test::Shade> murky = {
        [light](const test::RayEnd& end) { return light.seen(20 + 210 * test::waves(end.p), end.along, 0); }};
    StereoConfig config;
    config.min_contrast = 0.8;  // the noise alone gives 0.5
    DenseMatcher matcher(config);
    const DisparityScore score = score_disparity(matcher.match(pair.left(murky, 1), pair.right(murky, 1)), truth, 64);
    EXPECT_LE(score.valid, valid_before + 0.01) << c;
    EXPECT_LT(score.wrong_2 * score.valid, 0.02) << "attenuation " << c;
    valid_before = score.valid;
  }
  EXPECT_LT(valid_before, 0.4);
}

// ledger: S8-11
TEST(DenseMatcher, ASurfaceWithoutTextureHasNoDisparity) {
  test::RayPair pair;
  pair.scene = {test::plane({0, 0, 1}, 2)};
  const std::vector<test::Shade> flat = {[](const test::RayEnd&) { return 120.0; }};
  StereoConfig config;
  config.min_contrast = 0.8;
  const DisparityMap map = DenseMatcher(config).match(pair.left(flat, 1), pair.right(flat, 1));
  EXPECT_LT(map.share_of(PixelState::kValid), 0.01);
  EXPECT_GT(map.share_of(PixelState::kUntextured), 0.7);
}

TEST(DenseMatcher, ConfidenceIsLowerWhereDisparitiesAreWrong) {
  const test::RayPair pair = test::room();
  const std::vector<float> truth = pair.truth();
  StereoConfig config;
  config.uniqueness = 0;
  config.left_right = 256;
  config.speckle_pixels = 0;
  const DisparityMap map = DenseMatcher(config).match(pair.left(test::textured()), pair.right(test::textured()));
  double right = 0, wrong = 0;
  int rights = 0, wrongs = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (!std::isfinite(map.disparity[i])) continue;
    const bool good = std::abs(map.disparity[i] - truth[i]) < 1;
    (good ? right : wrong) += map.confidence[i];
    ++(good ? rights : wrongs);
  }
  ASSERT_GT(wrongs, 100);
  EXPECT_GT(right / rights, 2 * wrong / wrongs);
}

TEST(Speckles, SmallIslandsGoLargeOnesStay) {
  DisparityMap map;
  map.width = 20;
  map.height = 10;
  map.disparity.assign(200, 5);
  map.confidence.assign(200, 1);
  map.state.assign(200, PixelState::kValid);
  for (const int at : {43, 44, 64}) map.disparity[static_cast<std::size_t>(at)] = 30;  // an island of three, bent
  remove_speckles(4, map);
  for (const int at : {43, 44, 64}) EXPECT_EQ(map.state[static_cast<std::size_t>(at)], PixelState::kSpeckle);
  EXPECT_EQ(std::ranges::count(map.state, PixelState::kValid), 197);
  EXPECT_TRUE(std::isnan(map.disparity[43]));
}

// By hand: the near pixel of column 5 (disparity 3) meets right pixel 2, as the far one of column 3 (disparity 1) does.
TEST(DisparityScore, HiddenPixelsAreThoseBehindANearerOne) {
  const std::vector<float> truth = {0, 1, 0, 1, 3, 3};
  // columns 1, 3, 4, 5 meet right pixels 0, 2, 1, 2: at 2 the nearer is column 5
  EXPECT_THAT(hidden_pixels(truth, 6, 1), testing::ElementsAre(0, 0, 0, 1, 0, 0));
  DisparityMap map;
  map.width = 6;
  map.height = 1;
  const float none = std::numeric_limits<float>::quiet_NaN();
  map.disparity = {none, 1.5f, none, 1, 6, none};
  const DisparityScore score = score_disparity(map, truth);
  EXPECT_EQ(score.pixels, 3u) << "columns 1, 4, 5";
  EXPECT_DOUBLE_EQ(score.valid, 2 / 3.0);
  EXPECT_DOUBLE_EQ(score.bad_1, 2 / 3.0) << "one is off by 3, one has no disparity";
  EXPECT_DOUBLE_EQ(score.wrong_2, 0.5);
  EXPECT_DOUBLE_EQ(score.hidden_flagged, 0);
}

}  // namespace
}  // namespace isobath
