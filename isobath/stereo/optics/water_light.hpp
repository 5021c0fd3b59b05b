// WaterLight: how water dims and veils what a camera sees (ledger S8-11):
//   I = J exp(-c Z) + B (1 - exp(-b Z)),
// J: without water, Z: distance, c: attenuation, b: backscatter coefficient, B: brightness of the veil far away. Red,
// green and blue each have their own.
#pragma once

#include <Eigen/Core>
#include <isobath/base/field.hpp>
#include <vector>

namespace isobath {

struct WaterLight {
  Eigen::Vector3d attenuation_per_m = {0, 0, 0};  ///< red, green, blue
  Eigen::Vector3d backscatter_per_m = {0, 0, 0};
  Eigen::Vector3d veil = {0, 0, 0};  ///< grey levels

  /// Grey levels at a distance; channel 0..2.
  [[nodiscard]] double seen(double without_water, double distance_m, int channel) const;
};

std::vector<Field> fields(WaterLight& light);

}  // namespace isobath
