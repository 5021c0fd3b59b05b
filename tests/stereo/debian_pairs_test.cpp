// Real pairs of the Middlebury benchmark that Debian ships: python3-skimage has Motorcycle (Scharstein et al. 2014),
// opencv-doc has Aloe (Scharstein and Pal 2007); ../shared/data/stereo-debian has both.
#include <gtest/gtest.h>
#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/stereo/dense_matcher.hpp>
#include <isobath/stereo/disparity_score.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

DisparityScore score_of(const std::filesystem::path& folder, const std::string& left, const std::string& right,
                        const std::string& truth, int disparities) {
  StereoConfig config;
  config.disparities = disparities;
  DenseMatcher matcher(config);
  const DisparityMap map =
      matcher.match(grey_of(read_camera_image(folder / left)), grey_of(read_camera_image(folder / right)));
  return score_disparity(map, read_number_map(folder / truth, 1).values, disparities);
}

// OpenCV 4.6 in the same columns (docs/stereo.md): StereoBM 16.0 and 14.6 %, StereoSGBM 8.0 and 6.0 %.
// ledger: S8-01 S8-08
TEST(DebianPairs, MotorcycleIsMatchedBetterThanByBlocksAndWithinATenthOfSemiGlobalMatching) {
  ISOBATH_NEEDS_DATA(folder, "stereo-debian");
  const DisparityScore score =
      score_of(folder, "motorcycle_left.png", "motorcycle_right.png", "motorcycle_disp.pfm", 64);
  EXPECT_GT(score.pixels, 250'000u);
  EXPECT_LT(score.bad_1, 0.087);
  EXPECT_LT(score.bad_2, 0.066);
}

// StereoBM 23.6 and 20.5 %, StereoSGBM 11.4 and 6.8 %. ledger: S8-01 S8-08
TEST(DebianPairs, AloeToo) {
  ISOBATH_NEEDS_DATA(folder, "stereo-debian");
  const DisparityScore score = score_of(folder, "opencv/aloeL.jpg", "opencv/aloeR.jpg", "opencv/aloeGT.png", 256);
  EXPECT_GT(score.pixels, 700'000u);
  EXPECT_LT(score.bad_1, 0.125);
  EXPECT_LT(score.bad_2, 0.075);
}

}  // namespace
}  // namespace isobath
