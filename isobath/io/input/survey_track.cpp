#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/input/survey_track.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kFarthestFix = 1e6;  // m from the origin: limit of the local plane
// Standard deviation of rounding to the last digit (uniform distribution).
const double kAngleRounding = Angle::degrees(0.01).radians() / std::sqrt(12.0);
const double kHeaveRounding = 0.01 / std::sqrt(12.0);

template <class Sample>
void insert_by_time(std::deque<Sample>& samples, Sample sample, Time (*time)(const Sample&)) {
  const auto after = std::upper_bound(samples.begin(), samples.end(), time(sample),
                                      [time](Time t, const Sample& s) { return t < time(s); });
  samples.insert(after, std::move(sample));
}

double share_of(Time time, Time before, Time after) {
  return after > before ? to_seconds(time - before) / to_seconds(after - before) : 0;
}

double mix(double a, double b, double share) { return a + share * (b - a); }
Angle mix(Angle a, Angle b, double share) { return a + (b - a).wrapped() * share; }

MotionSample mix(const MotionSample& a, const MotionSample& b, double share) {
  MotionSample m = share < 0.5 ? a : b;
  m.roll = mix(a.roll, b.roll, share);
  m.pitch = mix(a.pitch, b.pitch, share);
  m.heave_m = mix(a.heave_m, b.heave_m, share);
  if (a.heading && b.heading) m.heading = mix(*a.heading, *b.heading, share);
  return m;
}

double squared(double stated, double otherwise) {
  const double sigma = stated > 0 ? stated : otherwise;
  return sigma * sigma;
}

/// The memory of a ping's samples, counted in soundings.
std::size_t weight_of(const Ping& ping) {
  return static_cast<std::size_t>(ping.fan->beams()) * static_cast<std::size_t>(ping.window.bins) * sizeof(float) /
         sizeof(Sounding);
}

}  // namespace

Eigen::Vector2d along(Angle course, double speed) { return {speed * cos(course), speed * sin(course)}; }

SurveyTrack::SurveyTrack(SourceReport& report) : report_(report) {}
SurveyTrack::~SurveyTrack() = default;

// Input
// --------------------------------------------------------------------------------------------------------

void SurveyTrack::add(const MotionSample& sample) {
  const bool finite = std::isfinite(sample.roll.radians()) && std::isfinite(sample.pitch.radians()) &&
                      std::isfinite(sample.heave_m) && (!sample.heading || std::isfinite(sample.heading->radians()));
  if (!finite) {
    ++report_.rejected["attitude sample that is not finite"];
    return;
  }
  see(sample.time);
  insert_by_time<MotionSample>(motion_, sample, [](const MotionSample& s) { return s.time; });
  if (motion_.size() > kMaxHistory) motion_.pop_front();
}

void SurveyTrack::add(const PositionFix& fix) {
  const auto place = on_plane(fix.point);
  if (!place) return;
  see(fix.time);
  insert_by_time<Placed>(positions_, {fix, *place}, [](const Placed& p) { return p.fix.time; });
  if (positions_.size() > kMaxHistory) positions_.pop_front();
  wait_for({fix.time, std::nullopt});
}

void SurveyTrack::add(SwathRecord record) {
  see(record.swath.time);
  waiting_soundings_ += record.swath.soundings.size();
  const Time time = record.swath.time;
  wait_for({time, std::move(record)});
}

void SurveyTrack::add_ping(Ping ping) {
  see(ping.time);
  waiting_soundings_ += weight_of(ping);
  const Time time = ping.time;
  wait_for({time, std::nullopt, std::move(ping)});
}

/// A position on the local plane, whose origin is the first position.
std::optional<Vector2d> SurveyTrack::on_plane(const GeoPoint& point) {
  const bool unset = point.latitude_deg == 0 && point.longitude_deg == 0;
  if (!valid(point) || unset) {
    ++report_.rejected["invalid position"];
    return std::nullopt;
  }
  if (!plane_) {
    report_.origin = point;
    plane_ = std::make_unique<LocalPlane>(point);
  }
  const Vector2d place = plane_->to_plane(point);
  if (place.norm() <= kFarthestFix) return place;
  ++report_.rejected["position over 1000 km from the first"];
  return std::nullopt;
}

void SurveyTrack::see(Time time) {
  if (newest_ && time < *newest_ - kSetBack) {
    while (!pending_.empty()) release_front();
    motion_.clear();
    positions_.clear();
    last_navigation_.reset();
    last_stated_.reset();
    newest_.reset();
  }
  newest_ = newest_ ? std::max(*newest_, time) : time;
}

void SurveyTrack::wait_for(Pending pending) {
  auto at = std::upper_bound(pending_.begin(), pending_.end(), pending.time,
                             [](Time t, const Pending& p) { return t < p.time; });
  while (!pending.ping && at != pending_.begin() && std::prev(at)->ping && std::prev(at)->time == pending.time) --at;
  pending_.insert(at, std::move(pending));
}

void SurveyTrack::finish() {
  finished_ = true;
  tell_coverage();
}

// Output
// --------------------------------------------------------------------------------------------------------

std::optional<Event> SurveyTrack::next() {
  while (ready_.empty() && due()) release_front();
  if (ready_.empty()) {
    if (finished_) tell_coverage();
    return std::nullopt;
  }
  Event event = std::move(ready_.front());
  ready_.pop_front();
  return event;
}

bool SurveyTrack::due() const {
  if (pending_.empty()) return false;
  const Pending& front = pending_.front();
  const bool needs_position = ((front.swath && !front.swath->position) || front.ping) && positions_.empty();
  const Duration wait = needs_position ? kReach : kWait;
  return finished_ || *newest_ - front.time > wait || pending_.size() > kMaxPending || waiting_soundings_ > kMaxWaiting;
}

void SurveyTrack::release_front() {
  Pending pending = std::move(pending_.front());
  pending_.pop_front();
  if (pending.swath) waiting_soundings_ -= pending.swath->swath.soundings.size();
  if (pending.ping) waiting_soundings_ -= weight_of(*pending.ping);
  const Time time = pending.time;
  release(std::move(pending));
  forget_before(time - kReach);
}

void SurveyTrack::release(Pending pending) {
  const Time time = pending.time;
  SwathRecord* const record = pending.swath ? &*pending.swath : nullptr;
  if (!record && !pending.ping && last_stated_ && time - *last_stated_ <= kHold) return;
  Duration away{};
  auto motion = motion_at(time, away);
  const bool tilted = record && record->swath.frame == Swath::Frame::kBody;
  if (tilted && (!motion || away > kTilt)) {
    ++report_.rejected["swath without an attitude near its time"];
    return;
  }
  if (away > kHold) motion.reset();
  auto place = position_at(time);
  if (record && record->position) {
    if (const auto stated = on_plane(*record->position)) {
      if (!place) place = Placed{};
      place->north_east = *stated;
      last_stated_ = time;
    }
  }
  std::optional<Angle> heading = record ? record->swath.heading : std::nullopt;
  if (!heading && motion) heading = motion->heading;
  if (!heading && place) heading = place->fix.heading;
  if (place && heading && last_navigation_ != time) {
    Navigation fix = navigation(time, *place, motion, *heading);
    if (record && record->depth_m) fix.X_WB.translation.z() = *record->depth_m;
    ready_.emplace_back(std::move(fix));
    last_navigation_ = time;
    last_roll_ = motion ? motion->roll : Angle{};
    ++fixes_;
    if (!motion) ++without_motion_;
    if (motion && away > Duration{}) ++beyond_samples_;
  } else if (!place || !heading) {
    if (record) ++without_position_;
    if (pending.ping) ++pings_without_position_;
    if (!record && !pending.ping) ++report_.rejected["position without a heading"];
  }
  if (record) ready_.emplace_back(std::move(record->swath));
  if (pending.ping) release(std::move(*pending.ping));
}

void SurveyTrack::release(Ping ping) {
  if (last_navigation_ == ping.time) {
    ping.X_BS.rotation = Rotation::from_heading_pitch_roll({}, {}, -last_roll_) * ping.X_BS.rotation;
  }
  ready_.emplace_back(std::move(ping));
}

void SurveyTrack::forget_before(Time time) {
  while (motion_.size() > 1 && motion_[1].time < time) motion_.pop_front();
  while (positions_.size() > 1 && positions_[1].fix.time < time) positions_.pop_front();
}

// Poses
// ----------------------------------------------------------------------------------------------------------------

std::optional<SurveyTrack::Placed> SurveyTrack::position_at(Time time) const {
  const auto after = std::lower_bound(positions_.begin(), positions_.end(), time,
                                      [](const Placed& p, Time t) { return p.fix.time < t; });
  const Placed* const b = after != positions_.end() ? &*after : nullptr;
  const Placed* const a = after != positions_.begin() ? &*std::prev(after) : nullptr;
  if (b && b->fix.time == time) return *b;
  if (a && b && b->fix.time - a->fix.time <= kReach) {
    const double share = share_of(time, a->fix.time, b->fix.time);
    Placed place = share < 0.5 ? *a : *b;
    place.north_east = a->north_east + share * (b->north_east - a->north_east);
    if (a->fix.heading && b->fix.heading) place.fix.heading = mix(*a->fix.heading, *b->fix.heading, share);
    return place;
  }
  const Placed* const nearest = !a || (b && b->fix.time - time < time - a->fix.time) ? b : a;
  if (!nearest) return std::nullopt;
  const Duration away = std::max(time - nearest->fix.time, nearest->fix.time - time);
  if (away > (nearest->fix.velocity ? kReach : kHold)) return std::nullopt;
  Placed place = *nearest;
  if (place.fix.velocity) place.north_east += to_seconds(time - place.fix.time) * *place.fix.velocity;
  return place;
}

std::optional<MotionSample> SurveyTrack::motion_at(Time time, Duration& away) const {
  away = {};
  const auto after =
      std::lower_bound(motion_.begin(), motion_.end(), time, [](const MotionSample& s, Time t) { return s.time < t; });
  const MotionSample* const b = after != motion_.end() ? &*after : nullptr;
  const MotionSample* const a = after != motion_.begin() ? &*std::prev(after) : nullptr;
  if (b && b->time == time) return *b;
  if (a && b && b->time - a->time <= kHold) return mix(*a, *b, share_of(time, a->time, b->time));
  const MotionSample* const nearest = !a || (b && b->time - time < time - a->time) ? b : a;
  if (!nearest) return std::nullopt;
  away = std::max(time - nearest->time, nearest->time - time);
  return *nearest;
}

Navigation SurveyTrack::navigation(Time time, const Placed& place, const std::optional<MotionSample>& motion,
                                   Angle heading) const {
  const MotionSample m = motion.value_or(MotionSample{});
  Navigation fix;
  fix.time = time;
  fix.X_WB.rotation = Rotation::from_heading_pitch_roll(heading, m.pitch, m.roll);
  fix.X_WB.translation << place.north_east, m.heave_m - water_line_m_;
  if (place.fix.velocity) fix.v_WB = {place.fix.velocity->x(), place.fix.velocity->y(), 0};
  if (place.fix.sigma_m > 0) {
    const double p = place.fix.sigma_m * place.fix.sigma_m, z = squared(m.sigma_heave_m, kHeaveRounding);
    const double tilt = squared(m.sigma_tilt, kAngleRounding), turn = squared(m.sigma_heading, kAngleRounding);
    fix.covariance = Eigen::Matrix<double, 6, 1>(p, p, z, tilt, tilt, turn).asDiagonal();
  }
  return fix;
}

void SurveyTrack::tell_coverage() {
  std::string text = "interpolated to the time of each fix";
  if (beyond_samples_ > 0) {
    text += fmt::format("; from the nearest sample for {} of {} fixes", beyond_samples_, fixes_);
  }
  if (without_motion_ > 0)
    text += fmt::format("; missing for {} of {} fixes, taken to be level", without_motion_, fixes_);
  if (fixes_ > 0) report_.details["roll and pitch"] = text;
  if (pings_without_position_ > 0)
    report_.details["pings"] = fmt::format("{} without a position", pings_without_position_);
  if (without_position_ > 0) report_.details["swaths"] = fmt::format("{} without a position", without_position_);
}

}  // namespace isobath
