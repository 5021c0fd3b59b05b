// PairRig: pairs.toml, which says what the pictures of two cameras are: their calibration, where they stand in the
// body, their names or topics, their times, and the poses of the vehicle.
//
// Paths are relative to the file. Errors: throws Error with file, line and key.
#pragma once

#include <filesystem>
#include <isobath/base/config.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/stereo/optics/stereo_calibration.hpp>
#include <string>
#include <string_view>

namespace isobath {

struct PairRig {
  static constexpr const char* kFile = "pairs.toml";

  std::string calibration, extrinsics;  ///< TOML, or the two YAML files of OpenCV
  std::string left = "left_*.png", right = "right_*.png";
  std::string times;   ///< CSV; empty: `rate_hz`, or what * stands for
  double rate_hz = 0;  ///< 0: not stated
  double start_s = 0;
  std::string poses;  ///< CSV; empty: none
  std::string left_topic, right_topic;
  Eigen::Vector3d position = {0, 0, 0};
  Angle heading, pitch, roll;

  StereoCalibration cameras;  ///< what `calibration` holds

  /// The pose in B of axes forward, starboard, down of the left camera.
  [[nodiscard]] Pose X_BL() const { return {Rotation::from_heading_pitch_roll(heading, pitch, roll), position}; }
};
/// Without the cameras: no file is opened. `file`: for messages and as the start of relative paths.
PairRig parse_pair_rig(std::string_view text, const std::string& file);
PairRig read_pair_rig(const std::filesystem::path& file);
/// As TOML, which read_pair_rig reads; without the cameras themselves.
std::string pair_rig_toml(const PairRig& rig);
/// The format, annotated.
std::string pair_rig_template();

}  // namespace isobath
