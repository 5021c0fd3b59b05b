// BearingPosterior: where a sound comes from, given bearings to it: from one of the known obstacles, or from elsewhere
// (ledger S4-54).
//
// The sound sits at one unknown point s. Bearing i was taken at p_i; its error has a part of its own and a part b that
// is the same in all (the bias of the array and of the heading), both normal:
//
//   z_i = direction(s - p_i) + e_i + b,  e_i ~ N(0, v_i),  v_i = sigma_i^2 + (position_sigma_i / |s - p_i|)^2
//   log L(s) = -1/2 [ sum r_i^2 / v_i - B (sum r_i / v_i)^2 / (1 + B sum 1 / v_i)
//                     + sum log(2 pi v_i) + log(1 + B sum 1 / v_i) ],  b ~ N(0, B) integrated out
//
// with r_i = z_i - direction(s - p_i). The evidence for an obstacle is the mean of L over its region: all points within
// `reach_m` of one of its convex pieces. The evidence for "none" is the mean of L over a disc of radius max_range_m
// about the best bearing's position: uniform in direction. So bearings from one place count as one bearing: for a
// single place the evidence is the mass of the region's angular extent under the normal error, over that extent. More
// bearings from there sharpen the direction down to the bias, and no further; only a vehicle that moves past the sound
// separates what lies behind one another.
//
// Both means are taken on a grid that is made finer around the likely points. Accuracy, held against a plain sum over
// 2 million points: log evidence within 0.05. Lengths in m, angles in rad, clockwise from north; plane of W. Nothing
// allocates. Not modelled: sounds that move, and paths that bend or bounce.
#pragma once

#include <array>
#include <Eigen/Core>
#include <isobath/geometry/polygon.hpp>
#include <span>

namespace isobath {

/// One bearing, or the mean of several from one place.
struct BearingFrom {
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
  double bearing = 0;           ///< rad, clockwise from north
  double sigma = 0;             ///< rad, without the common part
  double position_sigma_m = 0;  ///< of p_W relative to the obstacles, each axis
};

/// An obstacle that a sound may come from.
struct SoundRegion {
  std::span<const Polygon* const> pieces;  ///< convex, in W
  double reach_m = 0;                      ///< beyond the pieces
};

/// Mean and covariance of the place of a sound, in W.
struct SoundPlace {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

class BearingPosterior {
 public:
  /// At least one bearing; they must outlive it. `bias_sigma`: of the common part.
  BearingPosterior(std::span<const BearingFrom> bearings, double bias_sigma, double max_range_m);

  /// log L(s).
  [[nodiscard]] double log_likelihood(const Eigen::Vector2d& s) const;
  /// Log of the evidence for an obstacle; minus infinity where it lies in no likely direction.
  [[nodiscard]] double log_evidence(const SoundRegion& region);
  /// Log of the evidence for a sound anywhere in the disc, and the moments of its place there.
  double log_evidence_of_none(SoundPlace& place);

 private:
  static constexpr int kSide = 40;
  using Values = std::array<double, static_cast<std::size_t>(kSide) * kSide>;
  struct Box {
    double low_x, low_y, step_x, step_y;
  };
  /// Fills values_ over the box; points where `weight` is not positive count as impossible. Returns the largest.
  template <class Weight, class Point>
  double fill(const Box& box, const Weight& weight, const Point& point);
  [[nodiscard]] Box around_the_likely(const Box& box, double largest) const;
  [[nodiscard]] bool is_in_no_likely_direction(const Eigen::AlignedBox2d& box) const;

  std::span<const BearingFrom> bearings_;
  double bias_variance_;
  double max_range_m_;
  const BearingFrom* best_;  ///< with the smallest deviation
  double half_width_;        ///< rad; directions farther from best_ are not likely
  Values values_;            ///< log of likelihood times weight
};

}  // namespace isobath
