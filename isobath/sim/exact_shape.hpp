// ExactShape: spheres, cylinders and the flat bottom, met by rays in closed form.
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace isobath {

/// A shape with an intersection of its own.
struct ExactShape {
  enum class Kind { kSphere, kCylinder, kPlane } kind;
  Eigen::Vector3d centre, axis = Eigen::Vector3d::UnitZ();
  double radius = 0, half = 0;  ///< of a plane: half is half its side

  [[nodiscard]] Eigen::AlignedBox3d box() const;
};

struct Meeting {
  double range;
  Eigen::Vector3d normal;
};

/// Where a ray from p along the unit vector u first meets the shape between two ranges; the normal points outwards.
std::optional<Meeting> meet(const ExactShape& shape, const Eigen::Vector3d& p, const Eigen::Vector3d& u, double near,
                            double far);

}  // namespace isobath
