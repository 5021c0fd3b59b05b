#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/stereo/disparity_score.hpp>

namespace isobath {

std::vector<std::uint8_t> hidden_pixels(std::span<const float> truth, int width, int height) {
  std::vector<std::uint8_t> hidden(truth.size(), 0);
  std::vector<float> nearest(static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) {
    const std::span<const float> row =
        truth.subspan(static_cast<std::size_t>(y) * static_cast<std::size_t>(width), static_cast<std::size_t>(width));
    std::fill(nearest.begin(), nearest.end(), 0.0f);
    const auto meets = [&](std::size_t x) { return std::lround(static_cast<double>(x) - row[x]); };
    const auto known = [&](std::size_t x) { return std::isfinite(row[x]) && row[x] > 0; };
    for (std::size_t x = 0; x < row.size(); ++x) {
      if (!known(x) || meets(x) < 0) continue;
      float& best = nearest[static_cast<std::size_t>(meets(x))];
      best = std::max(best, row[x]);
    }
    for (std::size_t x = 0; x < row.size(); ++x) {
      if (!known(x)) continue;
      hidden[static_cast<std::size_t>(y) * row.size() + x] =
          meets(x) < 0 || nearest[static_cast<std::size_t>(meets(x))] > row[x] + 1;
    }
  }
  return hidden;
}

DisparityScore score_disparity(const DisparityMap& map, std::span<const float> truth, int margin) {
  ISOBATH_ASSERT(truth.size() == map.disparity.size());
  const std::vector<std::uint8_t> hidden = hidden_pixels(truth, map.width, map.height);
  DisparityScore score;
  std::size_t valid = 0, over_1 = 0, over_2 = 0, near = 0, flagged = 0;
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (static_cast<int>(i % static_cast<std::size_t>(map.width)) < margin) continue;
    if (!std::isfinite(truth[i]) || truth[i] <= 0) continue;
    const bool known = std::isfinite(map.disparity[i]);
    if (hidden[i]) {
      ++score.hidden;
      flagged += !known;
      continue;
    }
    ++score.pixels;
    if (!known) continue;
    ++valid;
    const double off = std::abs(map.disparity[i] - truth[i]);
    over_1 += off > 1;
    over_2 += off > 2;
    if (off <= 2) sum += off, ++near;
  }
  const auto share = [](std::size_t count, std::size_t of) {
    return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : 0;
  };
  score.valid = share(valid, score.pixels);
  score.wrong_1 = share(over_1, valid);
  score.wrong_2 = share(over_2, valid);
  score.bad_1 = share(over_1 + score.pixels - valid, score.pixels);
  score.bad_2 = share(over_2 + score.pixels - valid, score.pixels);
  score.mean_error_px = near > 0 ? sum / static_cast<double>(near) : 0;
  score.hidden_flagged = share(flagged, score.hidden);
  return score;
}

}  // namespace isobath
