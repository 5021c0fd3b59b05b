// Dense matching on several threads.
#include <gtest/gtest.h>
#include <isobath/stereo/dense_matcher.hpp>
#include <tests/stereo/ray_pictures.hpp>

namespace isobath {
namespace {

// ledger: S8-06 S8-12
TEST(DenseMatcherThreads, TwoThreadsGiveTheBitsOfOne) {
  const test::RayPair pair = test::room();
  const CameraImage left = pair.left(test::textured()), right = pair.right(test::textured());
  StereoConfig config;
  const DisparityMap one = DenseMatcher(config).match(left, right);
  for (const int threads : {2, 3}) {
    config.threads = threads;
    const DisparityMap more = DenseMatcher(config).match(left, right);
    EXPECT_EQ(more.state, one.state);
    for (std::size_t i = 0; i < one.disparity.size(); ++i) {
      if (one.state[i] == PixelState::kValid) {
        ASSERT_EQ(more.disparity[i], one.disparity[i]);
      }
      ASSERT_EQ(more.confidence[i], one.confidence[i]);
    }
  }
}

}  // namespace
}  // namespace isobath
