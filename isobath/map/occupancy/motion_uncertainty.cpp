#include <algorithm>
#include <isobath/map/occupancy/motion_uncertainty.hpp>

namespace isobath {

std::vector<Field> fields(MotionConfig& c) {
  return {
      Field::choice("kind", &c.kind,
                    {{"auto", MotionKind::kAuto},
                     {"deterministic", MotionKind::kDeterministic},
                     {"probabilistic", MotionKind::kProbabilistic},
                     {"none", MotionKind::kIgnored}},
                    "Whether displacements count as exact; auto: exact with a position fix or a velocity log."),
      Field::real("along", &c.along, {0, 10}, "m/sqrt(s)",
                  "Standard deviation of dead reckoning along the heading after one second."),
      Field::real("across", &c.across, {0, 10}, "m/sqrt(s)", "The same across the heading."),
  };
}

MotionKind motion_kind(const MotionConfig& config, const DisplacementSource& source) {
  if (config.kind != MotionKind::kAuto) return config.kind;
  return source.position_fix || source.velocity_log ? MotionKind::kDeterministic : MotionKind::kProbabilistic;
}

double TurnVariance::since_last(const MotionConfig& config, const DisplacementSource& source) {
  const double variance = std::max(0.0, source.heading_variance);
  const MotionKind kind = config.kind;
  const bool counts = kind == MotionKind::kAuto || kind == MotionKind::kProbabilistic;
  const double grown = largest_ < 0 || !counts ? 0 : std::max(0.0, variance - largest_);
  largest_ = variance < largest_ / 2 ? variance : std::max(variance, largest_);
  return grown;
}

Eigen::Matrix2d displacement_covariance(const MotionConfig& config, const DisplacementSource& source,
                                        Duration elapsed) {
  if (motion_kind(config, source) != MotionKind::kProbabilistic) return Eigen::Matrix2d::Zero();
  const double t = std::max(0.0, to_seconds(elapsed));
  return Eigen::Vector2d(config.along * config.along * t, config.across * config.across * t).asDiagonal();
}

}  // namespace isobath
