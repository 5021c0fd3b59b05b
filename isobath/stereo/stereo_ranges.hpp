// Stereo ranges: points and range readings from a disparity map (ledger S8-07). Maps take them as they take sonar
// ranges.
//
// The picture is divided into cells. Of a cell that is half valid the point with the median distance becomes a reading:
// a cone as wide as the cell, from the camera, with the standard deviation of its range.
#pragma once

#include <isobath/sonar/range_reading.hpp>
#include <isobath/sonar/swath.hpp>
#include <isobath/stereo/dense_matcher.hpp>
#include <isobath/stereo/pair_geometry.hpp>

namespace isobath {

struct StereoPoint {
  int column = 0, row = 0;
  Eigen::Vector3d p_V = {0, 0, 0};
  double sigma_z_m = 0;  ///< Z^2 sigma_d / (f B)
};
/// One point a valid pixel, row by row.
std::vector<StereoPoint> stereo_points(const DisparityMap& map, const PairGeometry& geometry, double sigma_disparity);

struct StereoReading {
  RangeReading reading;
  double sigma_m = 0;  ///< of the range, of one pixel
};
/// Its cone has the width of a cell. `X_BV`: the pose of V's axes as forward, starboard, down (x of that frame is z of
/// V). Times are `time`. Cells have `cell` x `cell` pixels; ranges beyond `max_range_m` are left out.
std::vector<StereoReading> stereo_readings(const DisparityMap& map, const PairGeometry& geometry,
                                           double sigma_disparity, const Pose& X_BV, Time time, int cell = 16,
                                           double max_range_m = 20);

/// The same as one swath in the body frame, a sounding a cell. Range readings of many directions would each count as a
/// sensor of its own; a swath is what the maps take from a sonar that resolves elevation.
Swath stereo_swath(const DisparityMap& map, const PairGeometry& geometry, double sigma_disparity, const Pose& X_BV,
                   Time time, int cell, double max_range_m);

}  // namespace isobath
