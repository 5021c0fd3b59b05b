// MotionKernel: how the contents of a grid spread over the neighbouring cells when the vehicle moves (Ganesan 2015,
// 3.4.1, equations 3.18 and 3.19; ledger S6-20 S6-21 S6-25). Weight (i, j) is the share of a cell that arrives i cells
// farther in x and j in y. All lengths in cells; `mean` is the movement of the content, which is opposite to the
// vehicle's (S6-E11).
#pragma once

#include <array>
#include <Eigen/Core>
#include <vector>

namespace isobath {

class MotionKernel {
 public:
  /// Exact displacement: bilinear shares over at most four cells (S6-20).
  static MotionKernel bilinear(const Eigen::Vector2d& mean);
  /// Expected overlap under N(mean, covariance): sums to 1 within 2e-4, has that mean, and becomes bilinear as the
  /// covariance goes to 0. Reaches |mean| + 4 sigma + 1 cells (S6-21, S6-E10).
  static MotionKernel expected_overlap(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance);
  /// As printed: N(mean, covariance) integrated over each cell. `size` 3 is the thesis's; 0 is as large as necessary.
  static MotionKernel printed(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance, int size = 0);
  /// 3 x 3 weights of zero mean whose covariance is exactly the given one, so that repeated use adds no further blur.
  /// Variances at most 0.5; a correlation that would need a negative weight is reduced.
  static MotionKernel diffusion(const Eigen::Matrix2d& covariance);

  [[nodiscard]] int first_x() const { return first_x_; }
  [[nodiscard]] int first_y() const { return first_y_; }
  [[nodiscard]] int size_x() const { return size_x_; }
  [[nodiscard]] int size_y() const { return size_y_; }
  /// Weight for a move by (x, y) cells; 0 outside the support.
  [[nodiscard]] double weight(int x, int y) const;

 private:
  MotionKernel(int first_x, int first_y, int size_x, int size_y);
  double& at(int x, int y) { return (large_.empty() ? small_.data() : large_.data())[index(x, y)]; }
  [[nodiscard]] int index(int x, int y) const { return (x - first_x_) * size_y_ + (y - first_y_); }
  template <class Form>
  static MotionKernel gaussian(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance, int reach_x, int reach_y,
                               Form form);

  int first_x_;
  int first_y_;
  int size_x_;
  int size_y_;
  std::array<double, 9> small_{};  ///< up to 3 x 3: made without allocation
  std::vector<double> large_;
};

}  // namespace isobath
