// StereoConfig: the settings of dense matching (dense_matcher.hpp).
#pragma once

#include <isobath/base/field.hpp>
#include <string>
#include <vector>

namespace isobath {

struct StereoConfig {
  static constexpr int kMaxDisparities = 256, kMaxWindow = 15;

  int disparities = 64;
  int min_disparity = 0;
  int window = 5;
  double bit = 2;
  double difference_cap = 24;
  double step_penalty = 16;
  double jump_penalty = 60;
  double jump_at_edge = 24;
  double red = 1, green = 1, blue = 1;
  double min_contrast = 0.3;
  double uniqueness = 0.01;
  double left_right = 2;
  int occlusion_margin = 1;
  int speckle_pixels = 60;
  double sigma_disparity = 0.25;
  int threads = 1;
};

std::vector<Field> fields(StereoConfig& config);
/// Throws Error for values that do not fit each other; `section`: where they stand.
void check(const StereoConfig& config, const std::string& section);

}  // namespace isobath
