// DisparityScore: a disparity map against the truth, as the Middlebury benchmark counts (Scharstein et al. 2014): over
// pixels whose match is not hidden in the right picture, the share that is off by more than 1 and 2 pixels.
//
// Hidden pixels follow from the truth itself: another pixel with a larger disparity meets the same right pixel, or the
// match is outside of the right picture. A pixel without a disparity counts as bad in `bad`, and not in `wrong`, which
// is the share among the valid ones.
#pragma once

#include <isobath/stereo/dense_matcher.hpp>
#include <span>

namespace isobath {

struct DisparityScore {
  std::size_t pixels = 0;  ///< with truth, not hidden
  double valid = 0;        ///< share of them
  double bad_1 = 0, bad_2 = 0;
  double wrong_1 = 0, wrong_2 = 0;
  double mean_error_px = 0;  ///< mean absolute error of the valid ones that are off by up to 2 pixels
  std::size_t hidden = 0;
  double hidden_flagged = 0;  ///< share of the hidden pixels that are not valid
};

/// Truth by pixel; not finite or not positive: unknown.
std::vector<std::uint8_t> hidden_pixels(std::span<const float> truth, int width, int height);
/// Leaves out the first `margin` columns, where a matcher with that many disparities has no full choice.
DisparityScore score_disparity(const DisparityMap& map, std::span<const float> truth, int margin = 0);

}  // namespace isobath
