// AspectLaw: what repeated looks at one voxel say when they are not independent.
//
// Model. An occupied voxel can echo from a share a of the directions that it is looked at from, and from one direction
// either always or never: asked again from there, it says the same. With A the sum of the log-likelihood ratios of the
// looks, were it one that echoes, the evidence is
//     e = ln(1 - a + a exp(A)),                                                                                   (1)
// so silence tends to ln(1 - a) and not to minus infinity. Equation (1) can be inverted: the probability that an
// occupied voxel echoes from here follows from the evidence itself,
//     q(e) = 1 - (1 - a) exp(-e),  kept within [k a, 1 - k (1 - a)],                                              (2)
// k the share of the looks that are from a new direction. A look of likelihood ratio R adds ln(1 - q + q R): silence
// counts little against what has never echoed, and fully against what has.
//
// Echoes from one direction cannot say which voxel of the resolution cell has given them, however many they are. They
// raise the evidence of a sensor to `limit` and no farther; beyond, an echo counts by the angle that the line of sight
// has turned since the ping before, as a share of `turn_deg`.
//
// Source: (1) and (2) are derived here, a hidden Markov model of two states a direction without a memory of its own;
// ledger S5-14, S5-31. Dependence of looks is not in the paper. Accuracy: docs/three-dimensions.md. Log-odds are
// natural. Pure functions of their arguments.
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <vector>

namespace isobath {

/// Chosen on the bridge, the room and clutter together (docs/three-dimensions.md).
struct AspectConfig {
  double answers = 0.6;   ///< a
  double renewal = 0.1;   ///< k
  double silence = 0.24;  ///< weight of a ping without an echo, in independent looks
  double limit = 2.1;     ///< log-odds that echoes from one direction can give at most
  double turn_deg = 20;   ///< once the line of sight has turned by so much, the direction is another
};
std::vector<Field> fields(AspectConfig& config);

class AspectLaw {
 public:
  explicit AspectLaw(const AspectConfig& config) : config_(config) {}

  /// q of equation (2).
  [[nodiscard]] double answering(double evidence) const;
  /// Evidence of a look without an echo at a voxel of evidence 0, by the detector's p_D and f: negative or 0.
  [[nodiscard]] double silence(double p_detect, double false_alarm) const;
  /// By what share of `silence` a look counts at a voxel of this evidence; exact for a p_D of 0.8.
  [[nodiscard]] double share(double evidence) const;
  /// What an echo of likelihood ratio R adds to the evidence. `turned`: share of a new direction, 0 .. 1.
  [[nodiscard]] double echo(double evidence, double ratio, double turned) const;
  /// By how much the line of sight to p has turned while the sensor moved, as a share of `turn_deg`, 0 .. 1. Both m,
  /// along the axes of W; p from the sensor, not nearer than `near_m` for this purpose.
  [[nodiscard]] double turned(const Eigen::Vector3d& p, const Eigen::Vector3d& moved, double near_m) const;

 private:
  AspectConfig config_;
};

}  // namespace isobath
