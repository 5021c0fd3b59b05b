#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/stereo/pair_geometry.hpp>

namespace isobath {

using Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

PairGeometry::PairGeometry(const StereoCalibration& calibration) : calibration_(calibration) {
  const StereoCalibration& c = calibration;
  const Vector3d right_in_left = -c.R_RL.transpose() * c.p_RL;  // p_LR
  if (!(right_in_left.x() > 0.5 * right_in_left.norm()))
    throw Error("the calibration puts the right camera to the left of the left one, or before it", {}, {},
                "exchange the cameras in the calibration");
  // x along the baseline; z as near as possible to the mean of both optical axes.
  const Vector3d x = right_in_left.normalized();
  const Vector3d forward = (Vector3d::UnitZ() + c.R_RL.transpose() * Vector3d::UnitZ()).normalized();
  const Vector3d y = forward.cross(x).normalized();
  R_V_[0].row(0) = x;
  R_V_[0].row(1) = y;
  R_V_[0].row(2) = x.cross(y);
  R_V_[1] = R_V_[0] * c.R_RL.transpose();
  pair_.focal_px = 0.5 * (c.left.fy + c.right.fy) * (c.in_water ? c.port.water_index : 1);
  pair_.cx = 0.5 * (c.left.width - 1);
  pair_.cy = 0.5 * (c.left.height - 1);
  pair_.baseline_m = right_in_left.norm();
}

Vector2d PairGeometry::in_air(Eye eye, double column, double row) const {
  const Vector3d ray((column - pair_.cx) / pair_.focal_px, (row - pair_.cy) / pair_.focal_px, 1);
  const Vector3d p = R_V_[static_cast<int>(eye)].transpose() * ray;
  if (!calibration_->in_water) return p.head<2>() / p.z();
  return calibration_->port.project(p * calibration_->nominal_range_m);
}

CameraImage PairGeometry::rectify(Eye eye, const CameraImage& image) const {
  if (!calibration_) return image;
  const CameraModel& model = camera(eye);
  CameraImage out(calibration_->left.width, calibration_->left.height, image.channels);
  for (int row = 0; row < out.height; ++row) {
    for (int column = 0; column < out.width; ++column) {
      const Vector2d from = model.pixel(in_air(eye, column, row));
      if (!(from.x() >= 0 && from.y() >= 0 && from.x() <= image.width - 1 && from.y() <= image.height - 1)) continue;
      const int x = std::min(static_cast<int>(from.x()), image.width - 2);
      const int y = std::min(static_cast<int>(from.y()), image.height - 2);
      const double u = from.x() - x, v = from.y() - y;
      for (int k = 0; k < image.channels; ++k) {
        const double upper = (1 - u) * image(x, y, k) + u * image(x + 1, y, k);
        const double lower = (1 - u) * image(x, y + 1, k) + u * image(x + 1, y + 1, k);
        out(column, row, k) = static_cast<std::uint8_t>(std::lround((1 - v) * upper + v * lower));
      }
    }
  }
  return out;
}

std::optional<Vector3d> PairGeometry::point(double column, double row, double disparity) const {
  if (pair_.focal_px <= 0 || pair_.baseline_m <= 0) return {};
  if (calibration_ && calibration_->in_water) return refracted_point(column, row, disparity);
  const double d = disparity + pair_.offset_px;
  if (!(d > 0)) return {};
  const double z = pair_.focal_px * pair_.baseline_m / d;
  return Vector3d((column - pair_.cx) / pair_.focal_px * z, (row - pair_.cy) / pair_.focal_px * z, z);
}

FlatPort::Ray PairGeometry::ray(Eye eye, double column, double row) const {
  const Vector3d from(eye == Eye::kLeft ? 0 : pair_.baseline_m, 0, 0);
  if (!calibration_ || !calibration_->in_water) {
    const Vector3d along((column - pair_.cx) / pair_.focal_px, (row - pair_.cy) / pair_.focal_px, 1);
    return {from, along.normalized()};
  }
  const FlatPort::Ray in_camera = calibration_->port.ray(in_air(eye, column, row));
  const Matrix3d& R = R_V_[static_cast<int>(eye)];
  return {R * in_camera.origin + from, R * in_camera.direction};
}

std::optional<Vector3d> PairGeometry::refracted_point(double column, double row, double disparity) const {
  const FlatPort::Ray left = ray(Eye::kLeft, column, row), right = ray(Eye::kRight, column - disparity, row);
  const Vector3d &a = left.origin, &u = left.direction, &b = right.origin, &v = right.direction;
  // The points a + s u and b + t v that are nearest to each other.
  const Vector3d apart = b - a;
  const double uv = u.dot(v), det = 1 - uv * uv;
  if (!(det > 1e-12)) return {};
  const double s = (apart.dot(u) - apart.dot(v) * uv) / det, t = (apart.dot(u) * uv - apart.dot(v)) / det;
  if (!(s > 0 && t > 0)) return {};
  return Vector3d(0.5 * (a + s * u + b + t * v));
}

}  // namespace isobath
