// StereoStudy: what a pair of pictures says about ranges, and how right it is (stereo fragment 1990; ledger S8).
// `isobath stereo` prints it.
//
// The pair comes from files or from a simulated scene. It is rectified if there is a calibration, matched, checked
// (rows that miss each other, exchanged eyes), turned into points, and compared with the truth if that is known. If the
// calibration has a motion, both pictures are of one moving camera, and MotionStereo takes the place of the matcher.
#pragma once

#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/stereo/dense_matcher.hpp>
#include <isobath/stereo/disparity_score.hpp>
#include <isobath/stereo/motion_stereo.hpp>
#include <isobath/stereo/stereo_ranges.hpp>
#include <isobath/stereo/vertical_residual.hpp>
#include <string>

namespace isobath {

struct StereoRequest {
  std::filesystem::path left, right;
  std::vector<std::filesystem::path> calibration;
  std::filesystem::path truth;  ///< disparities of the left picture
  double truth_scale = 1;       ///< pixels of disparity per grey level of a PNG
  std::filesystem::path scene;  ///< instead of pictures; needs a calibration
  int seed = 1;                 ///< of simulated pictures
  bool in_air = false;          ///< ranges as if there were no port
  bool plain = false;           ///< plain loops instead of vectors
  bool colour = false;          ///< matches colour, not brightness
  double max_vertical_px = 1;
  StereoConfig matching;
  MotionStereoConfig motion;
};
std::vector<Section> sections(StereoRequest& request);

/// What is matched.
struct StereoPair {
  CameraImage left, right;  ///< rectified; the pictures themselves if the camera moves
  StereoCalibration calibration;
  PairGeometry geometry{RectifiedPair{}};
  std::vector<float> truth;    ///< disparities; empty: unknown
  std::vector<float> truth_z;  ///< m; of a simulated pair
  bool simulated = false;
};

/// True ranges against those that were found, over pixels that have both.
struct RangeScore {
  std::size_t pixels = 0;
  double bias = 0;            ///< median of z / true z - 1
  double axis_bias = 0;       ///< the same within a tenth of the width about the optical axis
  double median_error = 0;    ///< median of |z / true z - 1|
  double within_5cm = 0;      ///< share
  double usable_range_m = 0;  ///< farthest half metre of true z of whose pixels at least half are valid
};

struct StereoStudy {
  DisparityMap map;  ///< empty if the camera moves
  std::optional<MotionDepth> motion;
  std::vector<StereoPoint> points;
  std::size_t readings = 0;
  std::optional<VerticalResidual> vertical;
  std::optional<DisparityScore> score;
  std::optional<RangeScore> ranges;
  std::optional<RangeScore> ranges_off_focus;  ///< motion: more than 10 degrees off the focus of expansion
};

/// Reads or simulates the pair, and rectifies it. Throws Error.
StereoPair prepare_pair(const StereoRequest& request);
/// The settings of the matcher for this pair.
StereoConfig matching_of(const StereoRequest& request);
/// Throws Error where the eyes are exchanged, or the rows miss each other.
StereoStudy study_pair(const StereoPair& pair, DisparityMap map, const StereoRequest& request);
StereoStudy study_motion(const StereoPair& pair, const StereoRequest& request);

/// Writes pictures, maps and points; returns the names of the files.
std::vector<std::filesystem::path> write_stereo(const StereoPair& pair, const StereoStudy& study,
                                                const std::filesystem::path& folder);

}  // namespace isobath
