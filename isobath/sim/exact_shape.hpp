// ExactShape: closed-form ray intersection with spheres, cylinders and the flat bottom.
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace isobath {

/// A shape with a closed-form intersection.
struct ExactShape {
  enum class Kind { kSphere, kCylinder, kPlane } kind;
  Eigen::Vector3d centre, axis = Eigen::Vector3d::UnitZ();
  double radius = 0, half = 0;  ///< half: half the length of a cylinder, half the side of a plane

  [[nodiscard]] Eigen::AlignedBox3d box() const;
};

struct Meeting {
  double range;
  Eigen::Vector3d normal;
};

/// The first intersection of the ray from p along the unit vector u between two ranges; the normal points outwards.
std::optional<Meeting> meet(const ExactShape& shape, const Eigen::Vector3d& p, const Eigen::Vector3d& u, double near,
                            double far);

}  // namespace isobath
