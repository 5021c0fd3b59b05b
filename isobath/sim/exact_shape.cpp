#include <cmath>
#include <isobath/sim/exact_shape.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

std::optional<Meeting> meet_sphere(const ExactShape& s, const Vector3d& p, const Vector3d& u, double near, double far) {
  const Vector3d m = p - s.centre;
  const double b = m.dot(u), c = m.squaredNorm() - s.radius * s.radius, d = b * b - c;
  if (d < 0) return std::nullopt;
  for (const double t : {-b - std::sqrt(d), -b + std::sqrt(d)}) {
    if (t > near && t < far) return Meeting{t, (m + t * u) / s.radius};
  }
  return std::nullopt;
}

std::optional<Meeting> meet_cylinder(const ExactShape& s, const Vector3d& p, const Vector3d& u, double near,
                                     double far) {
  const Vector3d m = p - s.centre;
  const double along_m = m.dot(s.axis), along_u = u.dot(s.axis);
  const Vector3d across_m = m - along_m * s.axis, across_u = u - along_u * s.axis;
  std::optional<Meeting> best;
  const auto take = [&](double t, const Vector3d& normal) {
    if (t > near && t < far && (!best || t < best->range)) best = Meeting{t, normal};
  };
  const double a = across_u.squaredNorm();
  if (a > 1e-14) {
    const double b = across_m.dot(across_u), c = across_m.squaredNorm() - s.radius * s.radius, d = b * b - a * c;
    if (d >= 0) {
      for (const double t : {(-b - std::sqrt(d)) / a, (-b + std::sqrt(d)) / a}) {
        if (std::abs(along_m + t * along_u) <= s.half) take(t, (across_m + t * across_u) / s.radius);
      }
    }
  }
  if (std::abs(along_u) > 1e-12) {
    for (const double end : {-s.half, s.half}) {
      const double t = (end - along_m) / along_u;
      if ((across_m + t * across_u).squaredNorm() <= s.radius * s.radius) take(t, end > 0 ? s.axis : -s.axis);
    }
  }
  return best;
}

std::optional<Meeting> meet_plane(const ExactShape& s, const Vector3d& p, const Vector3d& u, double near, double far) {
  if (std::abs(u.z()) < 1e-12) return std::nullopt;
  const double t = (s.centre.z() - p.z()) / u.z();
  if (!(t > near && t < far)) return std::nullopt;
  if (std::abs(p.x() + t * u.x() - s.centre.x()) > s.half || std::abs(p.y() + t * u.y() - s.centre.y()) > s.half) {
    return std::nullopt;
  }
  return Meeting{t, Vector3d::UnitZ()};
}

}  // namespace

Eigen::AlignedBox3d ExactShape::box() const {
  Vector3d reach = Vector3d::Constant(radius);
  if (kind == Kind::kCylinder) {
    for (int i = 0; i < 3; ++i)
      reach[i] = half * std::abs(axis[i]) + radius * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i]));
  }
  if (kind == Kind::kPlane) reach = {half, half, 0.01};
  return {centre - reach, centre + reach};
}

std::optional<Meeting> meet(const ExactShape& s, const Vector3d& p, const Vector3d& u, double near, double far) {
  switch (s.kind) {
    case ExactShape::Kind::kSphere: return meet_sphere(s, p, u, near, far);
    case ExactShape::Kind::kCylinder: return meet_cylinder(s, p, u, near, far);
    case ExactShape::Kind::kPlane: return meet_plane(s, p, u, near, far);
  }
  return std::nullopt;
}

}  // namespace isobath
