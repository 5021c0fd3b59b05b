// PairRanger: from pairs of pictures of two cameras to swaths of ranges (ledger S8-07 S8-09 S1-79): checked, rectified,
// matched, and divided into blocks, each of which is a sounding with the standard deviation of its range,
//   sigma_R = R / Z sigma_Z, sigma_Z = Z^2 sigma_d / (f B).
// A block is a sounding if half of its pixels are valid: turbid, untextured and hidden ones give none.
//
// X_BL: the pose in B of axes forward, starboard, down of the left camera as it stands, before rectification.
// One thread; keeps its buffers. Cost: that of DenseMatcher, and of rectifying both pictures.
#pragma once

#include <isobath/base/field.hpp>
#include <isobath/sonar/swath.hpp>
#include <isobath/stereo/optics/camera_pair.hpp>
#include <isobath/stereo/pair_fault.hpp>
#include <isobath/stereo/pair_geometry.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct PairRangerConfig {
  StereoConfig matching;
  int block_px = 8;
  double max_range_m = 8;
  double max_vertical_px = 1;
  bool colour = false;
};
std::vector<Field> fields(PairRangerConfig& config);

class PairRanger {
 public:
  /// Throws Error for settings that do not fit each other, and for a calibration of one moving camera.
  PairRanger(const PairRangerConfig& config, const StereoCalibration& calibration, const Pose& X_BL);

  /// Matches the pair. After kNone, and after kNoRange, the results below are those of this pair.
  PairFault update(const CameraPair& pair);
  [[nodiscard]] const Swath& swath() const { return swath_; }
  [[nodiscard]] const DisparityMap& map() const { return map_; }
  /// The left picture, rectified, and its brightness where it is matched in grey.
  [[nodiscard]] const CameraImage& left() const { return left_; }
  [[nodiscard]] const PairGeometry& geometry() const { return geometry_; }
  /// The pose in B of axes forward, starboard, down of the rectified left camera.
  [[nodiscard]] const Pose& X_BV() const { return X_BV_; }
  [[nodiscard]] const PairRangerConfig& config() const { return config_; }

 private:
  [[nodiscard]] PairFault check_match();

  PairRangerConfig config_;
  StereoCalibration calibration_;
  PairGeometry geometry_;
  Pose X_BL_, X_BV_;
  DenseMatcher matcher_;
  CameraImage left_, right_;
  DisparityMap map_;
  Swath swath_;
  bool rows_known_ = false;  ///< whether the rows of a pair of this rig have met once
};

}  // namespace isobath
