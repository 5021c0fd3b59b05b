// MotionConfig: how uncertain the vehicle's displacement is, by the sensor that measured it (Ganesan 2015, 3.4.1;
// ledger S6-22).
//
// With a position fix or a velocity log the motion counts as deterministic: no covariance. Without either, it is dead
// reckoning on the thruster model, whose error grows as a random walk along and across the vehicle.
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
};

struct MotionConfig {
  MotionKind kind = MotionKind::kAuto;
  double along = 0.05;  ///< standard deviation of the thruster model after one second, m / sqrt(s)
  double across = 0.03;
};

std::vector<Field> fields(MotionConfig& config);

/// The kind in force; never kAuto.
MotionKind motion_kind(const MotionConfig& config, const DisplacementSource& source);

/// Covariance of a displacement over `elapsed`, in the level body frame, m2.
Eigen::Matrix2d displacement_covariance(const MotionConfig& config, const DisplacementSource& source, Duration elapsed);

}  // namespace isobath
