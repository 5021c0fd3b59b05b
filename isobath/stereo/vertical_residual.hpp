// vertical_residual: by how much the rows of a pair miss each other (ledger S8-09). In a rectified pair it is zero; if
// the calibration is of other cameras, or a lens has moved, it is not.
//
// At pixels with a disparity and with vertical detail, patches of 9 x 9 pixels are moved up and down in the right
// picture by up to kReach pixels; a parabola through the least sum of squared differences gives the offset.
#pragma once

#include <isobath/stereo/dense_matcher.hpp>
#include <optional>

namespace isobath {

struct VerticalResidual {
  static constexpr int kReach = 6;  ///< pixels

  std::size_t patches = 0;
  double median_px = 0;  ///< positive: the right picture is lower
  double median_absolute_px = 0;
};

/// Empty if fewer than 50 patches tell.
std::optional<VerticalResidual> vertical_residual(const CameraImage& left, const CameraImage& right,
                                                  const DisparityMap& map);

}  // namespace isobath
