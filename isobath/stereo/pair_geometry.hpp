// PairGeometry: from a pair of cameras to a rectified pair of pictures, and from a disparity to a point in space
// (ledger S8-01 S8-07 S8-09 S8-10).
//
// Rectification turns both cameras about their centres, so that rows are along the baseline (Fusiello et al. 2000); the
// mean of both focal lengths is kept. Pictures are resampled bilinearly; what neither camera saw is black.
//
// Through a flat port no pinhole camera sees what the camera sees. The rectified picture is that of a pinhole camera
// with n_water times the focal length, exact at `nominal_range_m`; a disparity becomes a point by tracing both rays
// through air, glass and water, and taking the middle of where they pass each other.
//
// Frame V of points: the left camera after rectification, x along the baseline, z forward, metres.
#pragma once

#include <isobath/stereo/optics/camera_image.hpp>
#include <isobath/stereo/optics/stereo_calibration.hpp>
#include <optional>

namespace isobath {

enum class Eye : std::uint8_t { kLeft, kRight };

class PairGeometry {
 public:
  /// Throws Error if the calibration says that the right camera stands to the left.
  explicit PairGeometry(const StereoCalibration& calibration);
  explicit PairGeometry(const RectifiedPair& pair) : pair_(pair) {}

  [[nodiscard]] CameraImage rectify(Eye eye, const CameraImage& image) const;
  /// The point of a pixel of the left picture; empty where the disparity gives no range.
  [[nodiscard]] std::optional<Eigen::Vector3d> point(double column, double row, double disparity) const;
  /// Where a pixel of the rectified picture comes from: normalised coordinates in air, in the camera's frame.
  [[nodiscard]] Eigen::Vector2d in_air(Eye eye, double column, double row) const;
  /// The line of sight of a pixel of the rectified picture, in V.
  [[nodiscard]] FlatPort::Ray ray(Eye eye, double column, double row) const;
  /// Standard deviation of z: Z^2 sigma / (f B).
  [[nodiscard]] double sigma_z(double z, double sigma_disparity) const {
    return z * z * sigma_disparity / (pair_.focal_px * pair_.baseline_m);
  }
  [[nodiscard]] const RectifiedPair& pair() const { return pair_; }
  [[nodiscard]] bool rectifies() const { return calibration_.has_value(); }
  /// R_VL: turns components in the left camera's frame into those in V.
  [[nodiscard]] const Eigen::Matrix3d& R_VL() const { return R_V_[0]; }

 private:
  [[nodiscard]] const CameraModel& camera(Eye eye) const {
    return eye == Eye::kLeft ? calibration_->left : calibration_->right;
  }
  [[nodiscard]] std::optional<Eigen::Vector3d> refracted_point(double column, double row, double disparity) const;

  RectifiedPair pair_;
  std::optional<StereoCalibration> calibration_;
  Eigen::Matrix3d R_V_[2];  ///< R_VL, R_VR
};

}  // namespace isobath
