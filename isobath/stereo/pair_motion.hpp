// PairMotion: how a pair of cameras has moved between two pairs of pictures (visual odometry on points in space; after
// Nister, Naroditsky, Bergen 2004; ledger S7-15, S8-05).
//
// A MotionKey keeps places of a rectified left picture that have texture and a disparity: their points p_K and patches.
// pair_motion looks for the patches in a later left picture, about where a guess of the motion puts them, by zero-mean
// normalised cross-correlation; a patch with a second place that is about as good is left out. With its own disparity
// each becomes a point p_N, and the rigid motion p_K = R p_N + t is fitted: by random triples against outliers, then by
// Gauss-Newton on the inliers, each weighted by the covariance of both points (z^2 (s_px / f)^2 across, sigma_Z along),
// with Huber's weights; the guess of the rotation, if it is measured, is one more residual.
//
// Frame V: that of PairGeometry (right, down, forward), K at the key, N now. Deterministic. One thread.
#pragma once

#include <isobath/base/field.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/stereo/dense_matcher.hpp>
#include <isobath/stereo/pair_geometry.hpp>
#include <isobath/stereo/patch.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct PairMotionConfig {
  int max_points = 150;
  int reach_px = 10;
  double min_correlation = 0.8;
  double uniqueness = 0.05;
  double sigma_px = 0.3;
  int min_inliers = 12;
  double min_inlier_share = 0.4;
};
std::vector<Field> fields(PairMotionConfig& config);

class MotionKey {
 public:
  /// `grey`: the rectified left picture that `map` is of.
  MotionKey(const CameraImage& grey, const DisparityMap& map, const PairGeometry& geometry,
            const PairMotionConfig& config);

  struct Point {
    Eigen::Vector2d pixel;
    Eigen::Vector3d p_K;
    Patch patch;
  };
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  /// Median distance of the points, m.
  [[nodiscard]] double median_range_m() const;

 private:
  std::vector<Point> points_;
};

struct PairMotion {
  Pose X_KN;
  Eigen::Matrix<double, 6, 6> covariance;  ///< of (translation in K, rotation vector in K), m2, m rad, rad2
  int found = 0, inliers = 0;              ///< points whose patches were found, and those that agree
};

/// What is known of the motion before it is measured.
struct MotionGuess {
  Pose X_KN;
  double sigma_rotation = 0;  ///< rad, each axis; 0: the rotation is not measured
};

/// Empty if too few points are found, or too few agree.
std::optional<PairMotion> pair_motion(const MotionKey& key, const CameraImage& grey, const DisparityMap& map,
                                      const PairGeometry& geometry, double sigma_disparity, const MotionGuess& guess,
                                      const PairMotionConfig& config);

}  // namespace isobath
