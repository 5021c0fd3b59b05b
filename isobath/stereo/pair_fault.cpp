#include <algorithm>
#include <isobath/stereo/pair_fault.hpp>

namespace isobath {
namespace {

constexpr double kFewMatches = 0.4;  // share of valid pixels below which exchanged eyes are looked for
constexpr double kManyMore = 1.5, kEnoughMatches = 0.2;

bool has_size(const CameraImage& image, const CameraModel& camera) {
  return camera.width == 0 || (image.width == camera.width && image.height == camera.height);
}

}  // namespace

const char* to_text(PairFault fault) {
  switch (fault) {
    case PairFault::kNone: return "no fault";
    case PairFault::kSizesDiffer: return "pair whose pictures differ in size";
    case PairFault::kTooSmall: return "pair of fewer than 64 x 32 pixels";
    case PairFault::kOtherSize: return "pair of another size than the calibration's";
    case PairFault::kBlank: return "black or blank picture";
    case PairFault::kExchanged: return "pair that fits better with left and right exchanged";
    case PairFault::kRowsMiss: return "pair whose rows miss each other: the calibration is of other cameras";
    case PairFault::kNoRange: return "pair without a range: turbid, without texture, or too far";
  }
  return "unknown";
}

bool is_blank(const CameraImage& image) {
  const auto [low, high] = std::minmax_element(image.samples.begin(), image.samples.end());
  return image.samples.empty() || *high - *low < kMinContrast;
}

PairFault check(const CameraImage& left, const CameraImage& right, const StereoCalibration* calibration) {
  if (left.width != right.width || left.height != right.height) return PairFault::kSizesDiffer;
  if (left.width < kMinPairWidth || left.height < kMinPairHeight) return PairFault::kTooSmall;
  if (calibration && calibration->rectified.focal_px <= 0 &&
      (!has_size(left, calibration->left) || !has_size(right, calibration->right)))
    return PairFault::kOtherSize;
  return is_blank(left) || is_blank(right) ? PairFault::kBlank : PairFault::kNone;
}

std::optional<ExchangedEyes> exchanged_eyes(const CameraImage& left, const CameraImage& right, const DisparityMap& map,
                                            const StereoConfig& config) {
  const double valid = map.share_of(PixelState::kValid);
  if (valid >= kFewMatches) return {};
  DenseMatcher matcher(config);
  const double exchanged = matcher.match(right, left).share_of(PixelState::kValid);
  if (exchanged < kManyMore * valid || exchanged < kEnoughMatches) return {};
  return ExchangedEyes{valid, exchanged};
}

}  // namespace isobath
