// MotionStereo: ranges from two pictures of one moving camera whose motion is known (stereo fragment 1990; ledger
// S8-05).
//
// A pixel of the first picture at depth Z is in the second picture on its epipolar line. Inverse depth is stepped so
// that the pixel moves by half a pixel; patches of 9 x 9 are compared by zero-mean normalised cross-correlation, and a
// parabola through the best three refines it. The uncertainty of the depth is that of the place on the line, divided by
// how far a pixel moves per metre: sigma_Z = sigma_px / |du/dZ|. Near the focus of expansion, where the camera moves
// to, pixels hardly move; where sigma_Z exceeds `max_sigma_share` of Z the pixel has no depth. Frame: camera_model.hpp,
// of the first picture.
#pragma once

#include <isobath/stereo/optics/camera_image.hpp>
#include <isobath/stereo/optics/stereo_calibration.hpp>
#include <optional>

namespace isobath {

struct MotionStereoConfig {
  double min_depth_m = 0.5, max_depth_m = 15;
  double min_correlation = 0.8;
  double uniqueness = 0.05;  ///< by how much the second-best place must correlate less
  double min_contrast = 3;   ///< grey levels, standard deviation of a patch
  double sigma_px = 0.2;
  double max_sigma_share = 0.1;  ///< of the depth
  int every = 2;                 ///< columns and rows
};
std::vector<Field> fields(MotionStereoConfig& config);

struct MotionDepth {
  int width = 0, height = 0;  ///< of the grid of pixels: every `every` columns and rows
  int every = 1;
  std::vector<float> depth_m;  ///< NaN: none
  std::vector<float> sigma_m;
  std::optional<Eigen::Vector2d> focus;  ///< of expansion, pixels of the first picture; empty: beside the camera
};

MotionDepth motion_depth(const CameraImage& first, const CameraImage& second, const CameraModel& camera,
                         const Eigen::Matrix3d& R_AB, const Eigen::Vector3d& p_AB, const MotionStereoConfig& config);

}  // namespace isobath
