#include <cmath>
#include <isobath/stereo/optics/flat_port.hpp>

namespace isobath {

using Eigen::Vector2d, Eigen::Vector3d;

namespace {

/// Tangent in a medium of refractive index n, of a tangent t in air; and its slope by t.
double tangent_in(double n, double t) { return t / std::sqrt(n * n + (n * n - 1) * t * t); }
double slope_in(double n, double t) { return n * n / std::pow(n * n + (n * n - 1) * t * t, 1.5); }

}  // namespace

FlatPort::Ray FlatPort::ray(const Vector2d& n) const {
  const double t = n.norm(), water = tangent_in(water_index, t);
  const Vector2d out = t > 0 ? Vector2d(n / t) : Vector2d(0, 0);
  const double radius = distance_m * t + thickness_m * tangent_in(glass_index, t);
  return {{radius * out.x(), radius * out.y(), face_m()},
          Vector3d(water * out.x(), water * out.y(), 1) / std::hypot(water, 1.0)};
}

Vector2d FlatPort::project(const Vector3d& p) const {
  const double radius = p.head<2>().norm(), beyond = p.z() - face_m();
  if (radius == 0) return {0, 0};
  double t = radius / (distance_m + thickness_m / glass_index + beyond / water_index);
  for (int i = 0; i < 30; ++i) {  // the radius at depth z grows with t and bends downwards: Newton's steps converge
    const double off =
        distance_m * t + thickness_m * tangent_in(glass_index, t) + beyond * tangent_in(water_index, t) - radius;
    const double step = off / (distance_m + thickness_m * slope_in(glass_index, t) + beyond * slope_in(water_index, t));
    t -= step;
    if (std::abs(step) < 1e-13 * t) break;
  }
  return p.head<2>() * (t / radius);
}

std::vector<Field> fields(FlatPort& p) {
  return {
      Field::real("distance_m", &p.distance_m, {0, 1}, "m", "From the camera's centre to the inner face of the port."),
      Field::real("thickness_m", &p.thickness_m, {0, 0.5}, "m", "Thickness of the glass."),
      Field::real("glass_index", &p.glass_index, {1, 2.5}, "1", "Refractive index of the glass."),
      Field::real("water_index", &p.water_index, {1, 1.5}, "1", "Refractive index of the water; sea water 1.34.")};
}

}  // namespace isobath
