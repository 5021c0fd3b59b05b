// Patch: 9 x 9 pixels of a grey picture about any place in it, for zero-mean normalised cross-correlation.
#pragma once

#include <Eigen/Core>
#include <isobath/stereo/optics/camera_image.hpp>

namespace isobath {

struct Patch {
  static constexpr int kHalf = 4, kPixels = (2 * kHalf + 1) * (2 * kHalf + 1);

  double values[kPixels];  ///< less their mean
  double norm = 0;         ///< root of the sum of their squares

  void settle();
};

/// Interpolated bilinearly; false if the patch does not lie within the picture.
bool patch_at(const CameraImage& grey, const Eigen::Vector2d& at, Patch& patch);
/// -1 to 1.
double correlation(const Patch& a, const Patch& b);

}  // namespace isobath
