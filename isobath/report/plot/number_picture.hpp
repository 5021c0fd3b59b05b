// number_picture: a map of numbers by pixel (disparity, depth, confidence) as a picture with a scale of colours.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>

namespace isobath {

struct NumberPictureLabels {
  std::string title;
  std::string unit;  ///< beside the scale: "depth (m)"
};

/// PNG. Values by row from the top; NaN is grey. Without `limits` the scale reaches from the 1st to the 99th
/// percentile. A map wider or narrower than 640 pixels is drawn with whole pixels, up to 4 x 4 for one.
std::string number_picture(std::span<const float> values, int width, int height, const NumberPictureLabels& labels,
                           std::optional<std::pair<double, double>> limits = {});

}  // namespace isobath
