#include <algorithm>
#include <cmath>
#include <isobath/vehicle/depth_keeper.hpp>

namespace isobath {
namespace {

constexpr double kLevel = 0.3;  // m: samples nearer than this along the path say nothing about a slope
const double kMinDown = std::cos(Angle::degrees(45).radians());

double median(double* first, int count) {
  std::nth_element(first, first + count / 2, first + count);
  return first[count / 2];
}

// Positions along the path and depths of samples.
struct Along {
  double a[16];
  double z[16];
  int count = 0;
};

// Median of the slopes of all pairs from sample `first` on (Theil-Sen).
double slope_of(const Along& p, int first) {
  double slopes[120];
  int count = 0;
  for (int i = first; i < p.count; ++i) {
    for (int k = first; k < i; ++k) {
      const double apart = p.a[i] - p.a[k];
      if (std::abs(apart) > kLevel) slopes[count++] = (p.z[i] - p.z[k]) / apart;
    }
  }
  return count > 0 ? median(slopes, count) : 0;
}

}  // namespace

std::vector<Field> fields(DepthKeeperConfig& c) {
  return {
      Field::real("min_depth", &c.min_depth, {0, 10000}, "m", "Minimum depth, unless the bottom requires less."),
      Field::real("max_depth", &c.max_depth, {0, 12000}, "m", "Maximum depth."),
      Field::real("min_altitude", &c.min_altitude, {0, 1000}, "m", "Minimum altitude above the bottom, in both modes."),
      Field::real("safe_depth", &c.safe_depth, {0, 10000}, "m", "Depth in altitude mode while the bottom is lost."),
      Field::real("hold", &c.hold, {0, 600}, "s", "How long the last bottom counts after its echoes stop."),
      Field::real("look_ahead", &c.look_ahead, {0, 120}, "s", "How far ahead the vehicle climbs for a rising bottom."),
      Field::real("spacing", &c.spacing, {0.1, 100}, "m", "Distance between samples of the bottom profile."),
      Field::real("climb_share", &c.climb_share, {0.1, 1}, "1", "Share of the maximum climb rate that is relied on."),
  };
}

DepthKeeper::DepthKeeper(const DepthKeeperConfig& config, const VehicleParameters& parameters)
    : config_(config),
      climb_rate_(std::max(config.climb_share * parameters.limits.max_climb_rate, 1e-3)),
      lag_(parameters.depth_lag_s),
      deepest_(std::min(config.max_depth, parameters.limits.max_depth)) {}

bool DepthKeeper::on_altimeter(const AltimeterReading& reading, const Pose& X_WB) {
  const Pose X_WS = X_WB * reading.X_BS;
  const double range = reading.range_m.value_or(reading.max_range_m);
  if (!X_WS.is_finite() || !std::isfinite(range) || range < 0 || !std::isfinite(reading.width.radians())) {
    ++refused_;
    return false;
  }
  const Eigen::Vector3d axis = X_WS.rotation * Eigen::Vector3d::UnitX();
  if (axis.z() < kMinDown) return false;
  // The first echo of a level bottom comes from the part of the cone that points down most steeply.
  const double tilt = std::acos(std::min(axis.z(), 1.0));
  const double off = std::max(0.0, tilt - 0.5 * reading.width.radians());
  const double depth = X_WS.translation.z() + range * std::cos(off);
  if (!reading.range_m) {
    if (tilt < 0.5) seen_empty_ = depth;
    return true;
  }
  Eigen::Vector2d place = X_WS.translation.head<2>();
  if (tilt > 0) place += range * std::sin(off) / std::max(std::sin(tilt), 1e-12) * axis.head<2>();
  add({place, depth});
  last_echo_ = std::max(last_echo_.value_or(reading.time), reading.time);
  seen_empty_.reset();
  return true;
}

void DepthKeeper::add(const Sample& sample) {
  recent_[static_cast<std::size_t>(recent_count_++ % kRecent)] = sample;
  const int count = std::min(recent_count_, kRecent);
  if (count < 3) return;
  double depths[kRecent];
  std::transform(recent_.begin(), recent_.begin() + count, depths, [](const Sample& s) { return s.depth; });
  const double middle = median(depths, count);
  const auto typical =
      std::find_if(recent_.begin(), recent_.begin() + count, [middle](const Sample& s) { return s.depth == middle; });
  if (profile_count_ > 0) {
    const Sample& newest = profile_[static_cast<std::size_t>((profile_count_ - 1) % kProfile)];
    if ((typical->north_east - newest.north_east).norm() < config_.spacing) return;
  }
  profile_[static_cast<std::size_t>(profile_count_++ % kProfile)] = *typical;
}

// Finds the bottom and its slope along the vehicle's present course.
void DepthKeeper::look(const Eigen::Vector2d& here, const Eigen::Vector2d& ahead) {
  Along p;
  const int stored = std::min(profile_count_, kProfile);
  for (int i = profile_count_ - stored; i < profile_count_; ++i) {
    const Sample& s = profile_[static_cast<std::size_t>(i % kProfile)];
    p.a[p.count] = ahead.dot(s.north_east - here);
    p.z[p.count++] = s.depth;
  }
  double recent_a[kRecent], recent_z[kRecent];
  const int recent = std::min(recent_count_, kRecent);
  for (int i = 0; i < recent; ++i) {
    const Sample& s = recent_[static_cast<std::size_t>(i)];
    recent_a[i] = ahead.dot(s.north_east - here);
    recent_z[i] = s.depth;
  }
  const double now_a = median(recent_a, recent), now_z = median(recent_z, recent);
  p.a[p.count] = now_a;
  p.z[p.count++] = now_z;
  slope_ = std::min(slope_of(p, 0), slope_of(p, std::max(0, p.count - kNewest)));
  bottom_ = now_z - std::max(slope_, 0.0) * std::max(now_a, 0.0) - std::min(slope_, 0.0) * std::min(now_a, 0.0);
}

double DepthKeeper::deepest_allowed(double speed) const {
  const double below = *bottom_ - config_.min_altitude;
  // Piecewise linear, with a break at the lag: the minimum is at the break or at an end.
  const double rise = slope_ * speed;
  return below + std::min(0.0, rise * lag_ + std::min(0.0, config_.look_ahead * (rise + climb_rate_)));
}

DepthOrder DepthKeeper::step(const DepthWish& wish, const Pose& X_WB, const Eigen::Vector3d& v_W, Time now) {
  const Eigen::Vector2d here = X_WB.translation.head<2>();
  const double speed = v_W.allFinite() ? v_W.head<2>().norm() : 0;
  const Angle heading = X_WB.rotation.heading();
  const Eigen::Vector2d ahead =
      speed > 0.1 ? Eigen::Vector2d(v_W.head<2>() / speed) : Eigen::Vector2d(cos(heading), sin(heading));
  const bool known = last_echo_ && to_seconds(now - *last_echo_) <= config_.hold && recent_count_ >= 3;
  bottom_.reset();
  slope_ = 0;
  if (known) look(here, ahead);

  DepthOrder order;
  double allowed = deepest_;
  if (known) {
    allowed = deepest_allowed(speed);
    if (slope_ < 0) order.max_speed = climb_rate_ / -slope_;
  } else if (last_allowed_) {
    allowed = *last_allowed_;
    if (seen_empty_) allowed = std::max(allowed, *seen_empty_ - config_.min_altitude);
  }
  double wanted = wish.depth;
  if (wish.altitude_m) {
    order.lost = !known;
    const double bottom_ahead = known ? *bottom_ + std::min(slope_, 0.0) * speed * lag_ : 0;
    wanted = known ? bottom_ahead - std::max(*wish.altitude_m, config_.min_altitude) : config_.safe_depth;
  }
  wanted = std::clamp(wanted, config_.min_depth, std::max(config_.min_depth, deepest_));
  order.raised = allowed < wanted;
  order.depth = std::max(0.0, std::min(wanted, allowed));
  if (known) last_allowed_ = allowed;
  return order;
}

}  // namespace isobath
