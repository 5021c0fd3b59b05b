// AspectLaw: the evidence of repeated looks at one voxel that are not independent.
//
// Model. An occupied voxel can echo towards a share a of the directions from which it is looked at. From one direction
// it echoes either always or never: a repeated look from there gives the same result. With A the sum of the
// log-likelihood ratios of the looks, given that the voxel echoes, the evidence is
//     e = ln(1 - a + a exp(A)),                                                                                   (1)
// so silence tends to ln(1 - a) and not to minus infinity. Equation (1) can be inverted: the probability that an
// occupied voxel echoes from here follows from the evidence itself,
//     q(e) = 1 - (1 - a) exp(-e),  clamped to [k a, 1 - k (1 - a)],                                               (2)
// with k the share of the looks that are from a new direction. A look of likelihood ratio R adds ln(1 - q + q R):
// silence counts little against a voxel that has never echoed, and fully against one that has.
//
// Echoes from one direction, however many, cannot tell which voxel of the resolution cell has given them. They raise
// the evidence of a sensor to at most `max_log_odds`. Beyond it, an echo counts by the angle that the line of sight has
// turned since the previous ping, as a share of `turn_deg`.
//
// Source: (1) and (2) are derived here. They are a hidden Markov model of two states per direction, without a memory of
// its own; ledger S5-14, S5-31. The paper does not treat dependent looks. Accuracy: docs/three-dimensions.md. Log-odds
// are natural. Pure functions of their arguments.
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <vector>

namespace isobath {

/// Defaults are tuned on the bridge, room and clutter scenarios together (docs/three-dimensions.md).
struct AspectConfig {
  double visibility = 0.6;       ///< a
  double renewal = 0.1;          ///< k
  double no_echo_weight = 0.35;  ///< weight of a ping without an echo, in independent looks
  double max_log_odds = 1.9;     ///< maximum log-odds from echoes of one direction
  double turn_deg = 20;          ///< turn of the line of sight after which the direction counts as new
};
std::vector<Field> fields(AspectConfig& config);

class AspectLaw {
 public:
  explicit AspectLaw(const AspectConfig& config) : config_(config) {}

  /// q of equation (2).
  [[nodiscard]] double answering(double evidence) const;
  /// Evidence of a look without an echo at a voxel of evidence 0, by the detector's p_D and f: negative or 0.
  [[nodiscard]] double silence(double p_detect, double false_alarm) const;
  /// The share of `silence` that a look adds at a voxel of this evidence; exact for a p_D of 0.8.
  [[nodiscard]] double share(double evidence) const;
  /// Evidence that an echo of likelihood ratio R adds. `turned`: share of a new direction, 0 .. 1.
  [[nodiscard]] double echo(double evidence, double ratio, double turned) const;
  /// Turn of the line of sight to p due to the sensor's motion `moved`, as a share of `turn_deg`, 0 .. 1. Both in m,
  /// along the axes of W. p is relative to the sensor; its distance counts as at least `near_m`.
  [[nodiscard]] double turned(const Eigen::Vector3d& p, const Eigen::Vector3d& moved, double near_m) const;

 private:
  AspectConfig config_;
};

}  // namespace isobath
