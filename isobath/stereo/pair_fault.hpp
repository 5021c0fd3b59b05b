// PairFault: why a pair of pictures gives no ranges (ledger S8-08 S8-09 S8-11). `isobath stereo`, folders of pairs and
// simulated cameras all use these checks.
#pragma once

#include <isobath/stereo/dense_matcher.hpp>
#include <isobath/stereo/optics/stereo_calibration.hpp>
#include <optional>

namespace isobath {

enum class PairFault : std::uint8_t {
  kNone,
  kSizesDiffer,
  kTooSmall,
  kOtherSize,
  kBlank,
  kExchanged,
  kRowsMiss,
  kNoRange
};
const char* to_text(PairFault fault);

/// Whether a picture shows nothing: less than kMinContrast grey levels between its darkest and its brightest sample.
bool is_blank(const CameraImage& image);
constexpr int kMinContrast = 8;
constexpr int kMinPairWidth = 64, kMinPairHeight = 32;  ///< pixels

/// Faults of pictures as they were taken: sizes that differ from each other or from the calibration, blank ones.
PairFault check(const CameraImage& left, const CameraImage& right, const StereoCalibration* calibration);

/// Few pixels match, and more match with left and right exchanged. `left` and `right` as `map` was matched.
struct ExchangedEyes {
  double valid = 0, exchanged = 0;  ///< shares of pixels
};
std::optional<ExchangedEyes> exchanged_eyes(const CameraImage& left, const CameraImage& right, const DisparityMap& map,
                                            const StereoConfig& config);

}  // namespace isobath
