#include <algorithm>
#include <cmath>
#include <isobath/vehicle/navigation.hpp>

namespace isobath {

std::optional<double> sigma_m_of(const Navigation& fix) {
  if (!fix.covariance) return std::nullopt;
  return std::sqrt(std::max(0.0, (*fix.covariance)(0, 0) + (*fix.covariance)(1, 1)) / 2);
}

namespace {

constexpr double kMaxTimelineGap = 5;  // s

}  // namespace

PoseTimeline::PoseTimeline(std::span<const Navigation> fixes) {
  for (const Navigation& fix : fixes) add(fix);
}

void PoseTimeline::add(const Navigation& fix) {
  if (!fix.X_WB.is_finite() || (!times_.empty() && fix.time < times_.back())) return;
  times_.push_back(fix.time);
  poses_.push_back(fix.X_WB);
}

std::optional<Pose> PoseTimeline::at(Time time) const {
  const auto after = std::ranges::lower_bound(times_, time) - times_.begin();
  const auto i = static_cast<std::size_t>(after);
  if (i == times_.size()) return std::nullopt;
  if (times_[i] == time) return poses_[i];
  if (i == 0) return std::nullopt;
  const double gap_s = to_seconds(times_[i] - times_[i - 1]);
  if (gap_s > kMaxTimelineGap) return std::nullopt;
  return interpolate(poses_[i - 1], poses_[i], to_seconds(time - times_[i - 1]) / gap_s);
}

}  // namespace isobath
