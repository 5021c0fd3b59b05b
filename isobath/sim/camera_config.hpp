// CameraPairConfig: a pair of cameras that a simulated vehicle carries ([[camera]] of a scene).
//
// The cameras are those of a calibration (stereo_calibration.hpp), which `isobath stereo` reads, too. They stand at
// `position` in B, the left camera's optical axis along x of the mount. Units: SI.
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/stereo/optics/stereo_calibration.hpp>
#include <string>
#include <vector>

namespace isobath {

struct CameraPairConfig {
  Place place = {};
  std::string name = "cameras";
  bool on = true;
  std::string calibration = {};
  double rate_hz = 2;
  Eigen::Vector3d position = {0, 0, 0};  ///< of the left camera in B, m
  Angle heading = {}, pitch = {}, roll = {};
  double noise = 1;  ///< standard deviation of the sensor, grey levels

  /// The pose in B of axes forward, starboard, down of the left camera.
  [[nodiscard]] Pose X_BL() const { return {Rotation::from_heading_pitch_roll(heading, pitch, roll), position}; }
};
std::vector<Field> fields(CameraPairConfig& config);

/// Throws Error if the calibration is missing.
void check(const CameraPairConfig& camera);
/// The cameras of the calibration. Throws Error if they are not two side by side.
StereoCalibration cameras_of(const CameraPairConfig& camera);

}  // namespace isobath
