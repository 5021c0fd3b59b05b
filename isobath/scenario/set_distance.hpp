// The distance of two sets of points, such as tracks and true bodies (ledger S3-15): OSPA of Schuhmacher, Vo and Vo
// 2008 (IEEE Trans. Signal Processing 56, 3447-3457), of order 1. The points of one set are assigned to those of the
// other so that the sum is least: a pair costs its distance, at most the cut-off; a point without a partner costs the
// cut-off. The distance is this sum over the number of points of the larger set.
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

namespace isobath {

/// Pairs of rows and columns of least total cost; each row has one if there are at least as many columns. By the
/// Hungarian method, O(rows^2 columns). Needs rows <= columns.
std::vector<std::size_t> least_assignment(const Eigen::MatrixXd& cost);

struct SetDistance {
  double ospa_m = 0;                                       ///< 0: both sets are empty
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< of both sets, nearer than the cut-off
};

/// Points in m; the cut-off is above 0.
SetDistance set_distance(std::span<const Eigen::Vector2d> a, std::span<const Eigen::Vector2d> b, double cut_off_m);

}  // namespace isobath
