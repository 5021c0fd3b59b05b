// FlatPort: a camera that looks through a flat window into water (ledger S8-10).
//
// The window is perpendicular to the optical axis. A ray leaves the camera in air, crosses the glass and goes on in the
// water, by Snell's law sin(air) = n_glass sin(glass) = n_water sin(water). Near the axis the camera acts as one with
// n_water times its focal length: a range from the calibration in air is too short by 1 - 1/n_water, a quarter. Off the
// axis rays meet in no common point, so each is traced: closed form, exact. `project` is the inverse for a point,
// found by Newton's method to 1e-12. Frame C as camera_model.hpp, metres.
#pragma once

#include <Eigen/Core>
#include <isobath/base/field.hpp>
#include <vector>

namespace isobath {

struct FlatPort {
  double distance_m = 0.03;   ///< from the camera's centre to the inner face
  double thickness_m = 0.01;  ///< of the glass
  double glass_index = 1.5;
  double water_index = 1.34;

  struct Ray {
    Eigen::Vector3d origin;     ///< on the outer face
    Eigen::Vector3d direction;  ///< unit vector, in the water
  };
  /// The ray in water of a direction in air, in normalised coordinates.
  [[nodiscard]] Ray ray(const Eigen::Vector2d& normalised) const;
  /// In which direction, in normalised coordinates in air, the camera sees a point in the water, p.z beyond the port.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_C) const;
  [[nodiscard]] double face_m() const { return distance_m + thickness_m; }
};

std::vector<Field> fields(FlatPort& port);

}  // namespace isobath
