#include <algorithm>
#include <cmath>
#include <isobath/stereo/match_features.hpp>

namespace isobath {
namespace {

constexpr int kSide = 4, kUp = 3;  // half the census window

}  // namespace

void MatchFeatures::compute(const DisparityKernel& kernel, const CameraImage& image, const double (&weights)[3],
                            bool mirrored, int front, int back) {
  stride_ = static_cast<std::size_t>(front) + static_cast<std::size_t>(image.width) + static_cast<std::size_t>(back);
  row_bytes_ = stride_ * static_cast<std::size_t>(image.channels * (kCensusBytes + 1));
  data_.resize(row_bytes_ * static_cast<std::size_t>(image.height));
  values_.resize(static_cast<std::size_t>(image.width) + MatchingCosts::kLanes);
  for (int c = 0; c < image.channels; ++c) {
    pad_channel(image, c);
    const int weight = image.channels == 1 ? 256 : static_cast<int>(std::lround(256 * weights[c]));
    for (int y = 0; y < image.height; ++y) {
      std::uint8_t* const row = data_.data() + static_cast<std::size_t>(y) * row_bytes_;
      std::uint8_t* const planes = row + stride_ * static_cast<std::size_t>(c * (kCensusBytes + 1));
      compute_row(kernel, image.width, y, weight, mirrored, front, planes);
    }
  }
}

void MatchFeatures::pad_channel(const CameraImage& image, int channel) {
  const auto width = static_cast<std::size_t>(image.width), channels = static_cast<std::size_t>(image.channels);
  padded_ = width + 2 * kSide;
  channel_.resize(padded_ * static_cast<std::size_t>(image.height + 2 * kUp) + MatchingCosts::kLanes);
  for (int y = -kUp; y < image.height + kUp; ++y) {
    std::uint8_t* const to = channel_.data() + static_cast<std::size_t>(y + kUp) * padded_;
    const std::uint8_t* const from =
        image.samples.data() + image.index(0, std::clamp(y, 0, image.height - 1)) + channel;
    if (channels == 1) {
      std::copy_n(from, width, to + kSide);
    } else {
      for (std::size_t x = 0; x < width; ++x) to[kSide + x] = from[x * channels];
    }
    std::fill_n(to, kSide, to[kSide]);
    std::fill_n(to + kSide + width, kSide, to[kSide + width - 1]);
  }
}

void MatchFeatures::compute_row(const DisparityKernel& kernel, int width, int y, int weight, bool mirrored, int front,
                                std::uint8_t* planes) {
  const auto put = [&] {
    const std::uint8_t* const values = values_.data();
    std::uint8_t* const begin = planes + front;
    if (mirrored) {
      std::reverse_copy(values, values + width, begin);
    } else {
      std::copy_n(values, width, begin);
    }
    std::fill(planes, begin, begin[0]);
    std::fill(begin + width, planes + stride_, begin[width - 1]);
    planes += stride_;
  };
  const std::uint8_t* const top = channel_.data() + static_cast<std::size_t>(y) * padded_;
  int pair = 0;
  for (int byte = 0; byte < kCensusBytes; ++byte) {
    const std::uint8_t *first[8], *second[8];
    int pairs = 0;
    for (; pairs < 8 && pair < kPairs; ++pairs, ++pair) {
      const auto row = static_cast<std::size_t>(pair / (2 * kSide + 1)),
                 column = static_cast<std::size_t>(pair % (2 * kSide + 1));
      first[pairs] = top + row * padded_ + column;
      second[pairs] = top + (2 * kUp - row) * padded_ + (2 * kSide - column);
    }
    kernel.census_byte(first, second, pairs, width, values_.data());
    put();
  }
  const std::uint8_t* const middle = top + kUp * padded_ + kSide;
  for (int x = 0; x < width; ++x)
    values_[static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(std::min(middle[x] * weight >> 8, 255));
  put();
}

}  // namespace isobath
