// StereoCalibration: two cameras, how they stand, and the port that they look through; from TOML or from the YAML files
// of OpenCV's stereo calibration (ledger S8-09 S8-10).
//
// TOML has [left], [right], [pair], [port] and [motion], or [rectified] for a pair that is rectified already. OpenCV
// writes M1, D1, M2, D2 (intrinsics.yml) and R, T (extrinsics.yml); both files are given, or one that holds all.
// The cameras' frames L and R: camera_model.hpp. Errors: throws Error with file, line and key.
#pragma once

#include <filesystem>
#include <isobath/base/config.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/stereo/optics/camera_model.hpp>
#include <isobath/stereo/optics/flat_port.hpp>
#include <isobath/stereo/optics/water_light.hpp>
#include <span>

namespace isobath {

/// A rectified pair: Z = focal baseline / (d + offset).
struct RectifiedPair {
  double focal_px = 0;  ///< 0: unknown
  double cx = 0, cy = 0;
  double baseline_m = 0;
  double offset_px = 0;
};

struct StereoCalibration {
  CameraModel left, right;
  Eigen::Matrix3d R_RL = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p_RL = {-0.12, 0, 0};  ///< origin of L in R, m
  bool in_water = false;                 ///< both cameras look through a port like `port`
  FlatPort port;
  double nominal_range_m = 2;        ///< distance for which rows match exactly through a port
  WaterLight light;                  ///< of simulated pictures
  bool isoluminant = false;          ///< simulated textures have one brightness and differ in hue
  bool moves = false;                ///< one camera, left, that moves by `motion` from the first picture to the second
  Eigen::Vector3d p_AB = {0, 0, 0};  ///< origin of the second camera in the first, m
  Eigen::Matrix3d R_AB = Eigen::Matrix3d::Identity();
  /// The pose of the right camera in the left one; if the camera moves, that of the second picture in the first.
  [[nodiscard]] Pose X_LR() const;
  RectifiedPair rectified;  ///< if its focal length is not 0, the pair is rectified already
};

/// From the files of OpenCV, which do not state it, the width of the pictures is 0.
StereoCalibration read_stereo_calibration(std::span<const std::filesystem::path> files);
/// As TOML, which read_stereo_calibration reads.
std::string stereo_calibration_toml(const StereoCalibration& calibration);
/// The format in TOML, annotated.
std::string stereo_calibration_template();

}  // namespace isobath
