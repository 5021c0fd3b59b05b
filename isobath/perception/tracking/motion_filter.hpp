// MotionFilter: where one body is and how it moves, from readings of its position (Rodin, Amin c. 1988, 2.1; ledger
// S3-15, S3-E06).
//
// An interacting multiple model of three motions (Blom, Bar-Shalom 1988):
//   still      the velocity is zero; the position wanders by `still_walk`
//   straight   constant velocity, white acceleration of deviation `straight_acceleration` at 1 Hz
//   manoeuvre  constant turn rate, which wanders, and `manoeuvre_acceleration`
// The state of each is position and velocity in W (N, E; m, m/s) and turn rate (rad/s, positive to starboard). From one
// motion to another a body changes at random, after `still_s`, `straight_s` or `manoeuvre_s` on average, so the filter
// may be asked at any times. A body that lies still is thus not given the velocity that the noise of its readings
// seems to show, and a body that turns is noticed by its innovations.
//
// Time must not run backwards: `advance` by less than zero seconds does nothing. A reading must be finite, with a
// positive definite covariance. Fixed size, no allocation.
#pragma once

#include <array>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <span>
#include <vector>

namespace isobath {

struct MotionFilterConfig {
  double still_walk = 0.02;              ///< m in a second, grows with the root of time
  double straight_acceleration = 0.05;   ///< m/s2
  double manoeuvre_acceleration = 0.15;  ///< m/s2
  double turn_walk = 0.05;               ///< rad/s in a second
  double still_s = 300;
  double straight_s = 60;
  double manoeuvre_s = 10;
  double max_speed = 3;  ///< m/s, of a body of which nothing is known: twice its standard deviation
};

std::vector<Field> fields(MotionFilterConfig& config);

class MotionFilter {
 public:
  static constexpr int kMotions = 3;
  enum Motion : int { kStill, kStraight, kManoeuvre };
  using Vector = Eigen::Matrix<double, 5, 1>;
  using Matrix = Eigen::Matrix<double, 5, 5>;
  struct Estimate {
    Vector mean = Vector::Zero();
    Matrix covariance = Matrix::Zero();
  };

  /// A body at a first reading; `share_still`: probability that it lies still.
  MotionFilter(const MotionFilterConfig& config, const Eigen::Vector2d& p_W, const Eigen::Matrix2d& covariance,
               double share_still = 0.5);

  void advance(const MotionFilterConfig& config, double seconds);
  /// Where a body was, `age_s` before the filter's time.
  struct Reading {
    Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< m2
    double age_s = 0;                                          ///< a scanning sonar meets bodies one after the other
  };
  /// Logarithm of the density of a reading, 1/m2.
  [[nodiscard]] double log_likelihood(const Reading& reading) const;
  void correct(const Reading& reading);
  /// This filter becomes the mixture of some filters of the same body, by moments; shares sum to 1.
  void mix(std::span<const MotionFilter> others, std::span<const double> shares);
  /// The frame has moved: a correction of the own position moves what was measured from it.
  void shift(const Eigen::Vector2d& by_W);

  /// The mixture of the estimates of all motions.
  [[nodiscard]] Estimate estimate() const;
  [[nodiscard]] double probability(Motion motion) const { return probability_[motion]; }
  [[nodiscard]] Eigen::Vector2d position() const;

 private:
  std::array<Estimate, kMotions> motions_;
  std::array<double, kMotions> probability_;
};

}  // namespace isobath
