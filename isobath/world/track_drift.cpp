#include <algorithm>
#include <cmath>
#include <isobath/world/track_drift.hpp>

namespace isobath {
namespace {

constexpr double kMinPath = 5;  // m, of a share

/// The value below which a share of the values lies; 0 without values.
double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// In the plan: level, at depth 0.
Pose in_plan(const Pose& X) {
  Pose plan = level(X);
  plan.translation.z() = 0;
  return plan;
}

}  // namespace

const TrackDrift::Place* TrackDrift::place_at(Time time) const {
  const auto found = std::ranges::lower_bound(places_, time, {}, &Place::time);
  return found != places_.end() ? &*found : nullptr;
}

void TrackDrift::add(Time time, const Pose& X_WL, std::span<const KnownObstacle> known) {
  const auto reference = reference_.at(time);
  if (!reference || (!places_.empty() && time <= places_.back().time)) return;
  Place reached{time, in_plan(X_WL), in_plan(*reference), 0};
  if (!places_.empty()) {
    reached.path_m = places_.back().path_m + (reached.X.translation - places_.back().X.translation).norm();
  }
  const Place& now = places_.emplace_back(reached);
  for (const KnownObstacle& o : known) {
    const Place* const then = place_at(o.last_echo);
    if (!then || then == &now) continue;
    const Eigen::Vector3d q(o.middle.x(), o.middle.y(), 0), really = then->Y * (then->X.inverse() * q);
    moved_m_.push_back((now.X.inverse() * q - now.Y.inverse() * really).head<2>().norm());
    margin_m_.push_back(o.margin_m);
    const double path_m = now.path_m - then->path_m;
    if (path_m >= kMinPath) shares_.push_back(moved_m_.back() / path_m);
  }
}

std::optional<DriftOutcome> TrackDrift::outcome(std::span<const KnownObstacle> known) const {
  if (places_.empty()) return std::nullopt;
  DriftOutcome drift;
  drift.scans = places_.size();
  double squares = 0;
  for (const Place& place : places_) {
    drift.last_m = (place.X.translation - place.Y.translation).norm();
    drift.max_m = std::max(drift.max_m, drift.last_m);
    squares += drift.last_m * drift.last_m;
    const Eigen::Vector2d reference = place.Y.translation.head<2>();
    if (!drift.reference.empty()) drift.travelled_m += (reference - drift.reference.back()).norm();
    drift.reference.push_back(reference);
    drift.estimate.emplace_back(place.X.translation.head<2>());
  }
  drift.rms_m = std::sqrt(squares / static_cast<double>(places_.size()));
  std::vector<double> placed;
  for (const KnownObstacle& o : known) {
    const Place* const then = place_at(o.last_echo);
    if (!then) continue;
    const Eigen::Vector3d q(o.middle.x(), o.middle.y(), 0);
    placed.push_back((q - then->Y * (then->X.inverse() * q)).head<2>().norm());
  }
  drift.remembered = known.size();
  drift.placed_median_m = quantile_of(placed, 0.5);
  drift.placed_max_m = quantile_of(placed, 1);
  drift.sightings = moved_m_.size();
  drift.moved_median_m = quantile_of(moved_m_, 0.5);
  drift.moved_95_m = quantile_of(moved_m_, 0.95);
  drift.margin_median_m = quantile_of(margin_m_, 0.5);
  drift.share_median = quantile_of(shares_, 0.5);
  drift.share_95 = quantile_of(shares_, 0.95);
  std::size_t covered = 0;
  for (std::size_t i = 0; i < moved_m_.size(); ++i) covered += moved_m_[i] <= margin_m_[i] ? 1 : 0;
  if (!moved_m_.empty()) drift.covered = static_cast<double>(covered) / static_cast<double>(moved_m_.size());
  return drift;
}

}  // namespace isobath
