#include <algorithm>
#include <cmath>
#include <isobath/onboard/altitude_estimator.hpp>
#include <isobath/sonar/beam_cone.hpp>

namespace isobath {
namespace {

constexpr double kDown = 0.7071;  // sensors that look more than 45 degrees down measure the bottom
constexpr Angle kWidest = Angle::degrees(170);

}  // namespace

void AltitudeEstimator::update(const RangeReading& reading, const Pose& X_WB) {
  if (!reading.range_m || !std::isfinite(*reading.range_m)) return;
  if (reading.max_range_m > 0 && *reading.range_m >= reading.max_range_m) return;
  if (!(reading.width < kWidest)) return;
  const BeamCone cone(reading, X_WB);
  if (!(cone.axis().z() > kDown)) return;
  // Slant range per metre of depth below the sensor.
  const double slant = cone.range_to_level(cone.apex().z() + 1).value_or(1);
  last_[next_] = {reading.time, cone.apex().z() + *reading.range_m / slant};
  next_ = (next_ + 1) % last_.size();
}

std::optional<double> AltitudeEstimator::depth(Time now) const {
  const auto fresh = [&](const Heard& heard) { return heard.time != Time::min() && now - heard.time <= kFresh; };
  const Heard& newest = last_[(next_ + last_.size() - 1) % last_.size()];
  if (!fresh(newest)) return std::nullopt;
  if (!std::all_of(last_.begin(), last_.end(), fresh)) return newest.depth_m;
  const auto [a, b, c] = std::array{last_[0].depth_m, last_[1].depth_m, last_[2].depth_m};
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace isobath
