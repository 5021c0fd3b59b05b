// MotionConfig: how uncertain the vehicle's displacement and turn are, by the sensors that measured them (Ganesan 2015,
// 3.4.1 and 3.4.2; ledger S6-22, S6-68).
//
// With a position fix or a velocity log the motion counts as deterministic: no covariance. Without either, it is dead
// reckoning on the thruster model, whose error grows as a random walk along and across the vehicle. The heading is as
// uncertain as the navigation states: what its variance has grown by between two pings is the variance of the turn.
// With a compass it does not grow.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/base/time.hpp>
#include <vector>

namespace isobath {

/// kIgnored leaves the contents in place, as if the vehicle stood still; it shows what the motion model contributes.
enum class MotionKind : std::uint8_t { kAuto, kDeterministic, kProbabilistic, kIgnored };

/// The sensors that measured the displacement since the last ping.
struct DisplacementSource {
  bool position_fix = true;
  bool velocity_log = true;
  double heading_variance = 0;  ///< rad2, of the heading as the navigation states it; 0: not stated
};

struct MotionConfig {
  MotionKind kind = MotionKind::kAuto;
  double along = 0.05;  ///< standard deviation of the thruster model after one second, m / sqrt(s)
  double across = 0.03;
};

std::vector<Field> fields(MotionConfig& config);

/// The kind in force; never kAuto.
MotionKind motion_kind(const MotionConfig& config, const DisplacementSource& source);

/// TurnVariance: the variance of each turn, from those of the headings before and after it. A variance that goes to and
/// fro between the readings of a compass adds up to nothing; below half of its largest value it starts anew.
class TurnVariance {
 public:
  /// rad2, of the turn since the last call; 0 where the motion counts as exact, and at the first heading.
  double since_last(const MotionConfig& config, const DisplacementSource& source);

 private:
  double largest_ = -1;  ///< rad2; below 0: no heading yet
};

/// Covariance of a displacement over `elapsed`, in the level body frame, m2.
Eigen::Matrix2d displacement_covariance(const MotionConfig& config, const DisplacementSource& source, Duration elapsed);

}  // namespace isobath
