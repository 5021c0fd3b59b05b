#include <isobath/stereo/optics/camera_model.hpp>

namespace isobath {

using Eigen::Vector2d;

Vector2d CameraModel::distorted(const Vector2d& n) const {
  const double x = n.x(), y = n.y(), r2 = n.squaredNorm();
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Vector2d CameraModel::pixel(const Vector2d& n) const {
  const Vector2d d = distorted(n);
  return {fx * d.x() + cx, fy * d.y() + cy};
}

Vector2d CameraModel::normalised(const Vector2d& pixel) const {
  const Vector2d d((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  Vector2d n = d;
  for (int i = 0; i < 50; ++i) {
    const Vector2d step = d - distorted(n);
    n += step;
    if (step.squaredNorm() < 1e-22) break;
  }
  return n;
}

std::vector<Field> fields(CameraModel& c) {
  return {Field::integer("width", &c.width, {16, 16384}, "pixels", "Width of its pictures."),
          Field::integer("height", &c.height, {16, 16384}, "pixels", "Height of its pictures."),
          Field::real("fx", &c.fx, {1, 1e6}, "pixels", "Focal length, horizontal."),
          Field::real("fy", &c.fy, {1, 1e6}, "pixels", "Focal length, vertical."),
          Field::real("cx", &c.cx, {-1e5, 1e5}, "pixels", "Where the optical axis meets the picture, from the left."),
          Field::real("cy", &c.cy, {-1e5, 1e5}, "pixels", "The same from the top."),
          Field::real("k1", &c.k1, {-10, 10}, "1", "Radial distortion, second order."),
          Field::real("k2", &c.k2, {-100, 100}, "1", "Radial distortion, fourth order."),
          Field::real("p1", &c.p1, {-1, 1}, "1", "Tangential distortion, vertical."),
          Field::real("p2", &c.p2, {-1, 1}, "1", "Tangential distortion, horizontal."),
          Field::real("k3", &c.k3, {-1000, 1000}, "1", "Radial distortion, sixth order.")};
}

}  // namespace isobath
