// CameraModel: a pinhole camera with the distortion of OpenCV (Brown 1966: k1, k2, p1, p2, k3).
//
// Frame C of a camera: x to the right, y down, z forward, metres. Normalised coordinates are x/z and y/z. Pixels: the
// centre of the upper left pixel is (0, 0). Ledger S8-09.
#pragma once

#include <Eigen/Core>
#include <isobath/base/field.hpp>
#include <vector>

namespace isobath {

struct CameraModel {
  int width = 640, height = 480;
  double fx = 500, fy = 500, cx = 319.5, cy = 239.5;  ///< px
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;

  /// From normalised coordinates to the pixel, through the lens.
  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector2d& normalised) const;
  /// Its inverse, to 1e-9 where the distortion can be inverted.
  [[nodiscard]] Eigen::Vector2d normalised(const Eigen::Vector2d& pixel) const;

 private:
  [[nodiscard]] Eigen::Vector2d distorted(const Eigen::Vector2d& normalised) const;
};

std::vector<Field> fields(CameraModel& camera);

}  // namespace isobath
