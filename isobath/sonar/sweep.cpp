#include <algorithm>
#include <cmath>
#include <isobath/sonar/sweep.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kStill = 1e-6;  // rad: steps below it are the same bearing

}  // namespace

std::optional<Scan> SweepSegmenter::add(const Ping& ping) {
  if (ping.fan->beams() > 1) return add_fan(ping);
  begun_ ? advance(ping) : begin_at(ping);
  last_azimuth_ = ping.fan->azimuth[0];
  ++pings_;
  if (ping.sweep == SweepMark::kEnd) return end_marked(ping);
  follow_extreme(ping);
  if (ping.sweep == SweepMark::kInside || direction_ == 0) return std::nullopt;
  // The last ping of a turn is one step before its first.
  if (std::abs(position_ - start_) > kTurn - 1.5 * typical_step()) return end_turn(ping);
  if ((extreme_ - position_) * direction_ >= 1.5 * typical_step()) return end_reversed(ping);
  return std::nullopt;
}

/// Allows a tenth of the time for unevenly spaced pings.
std::optional<Scan> SweepSegmenter::add_fan(const Ping& ping) {
  if (pings_++ == 0) begin_ = ping.time;
  const bool backwards = fan_ended_ && ping.time < *fan_ended_;
  if (fan_ended_ && !backwards && ping.time - *fan_ended_ < fan_scan_ * 9 / 10) return std::nullopt;
  const Scan scan{pings_, begin_, ping.time, false, true};
  fan_ended_ = ping.time;
  pings_ = 0;
  return scan;
}

void SweepSegmenter::begin_at(const Ping& ping) {
  begun_ = true;
  pings_ = since_extreme_ = direction_ = 0;
  begin_ = extreme_time_ = ping.time;
  start_ = extreme_ = position_;
}

void SweepSegmenter::advance(const Ping& ping) {
  const double step = (ping.fan->azimuth[0] - last_azimuth_).wrapped().radians();
  position_ += step;
  if (std::abs(step) > kStill) steps_[step_count_++ % static_cast<int>(steps_.size())] = std::abs(step);
  if (pings_ == 0) begin_ = ping.time;
}

void SweepSegmenter::follow_extreme(const Ping& ping) {
  if (direction_ == 0 && std::abs(position_ - start_) > kStill) direction_ = position_ > start_ ? 1 : -1;
  if (direction_ == 0 || (position_ - extreme_) * direction_ > kStill) {
    extreme_ = position_;
    extreme_time_ = ping.time;
    since_extreme_ = 0;
  } else if (since_extreme_++ == 0) {
    after_extreme_ = ping.time;
  }
}

double SweepSegmenter::typical_step() const {
  const int count = std::min(step_count_, static_cast<int>(steps_.size()));
  if (count == 0) return 0;
  auto sorted = steps_;
  std::nth_element(sorted.begin(), sorted.begin() + (count - 1) / 2, sorted.begin() + count);
  return sorted[(count - 1) / 2];
}

Scan SweepSegmenter::end_marked(const Ping& ping) {
  const bool whole = std::abs(position_ - start_) > kTurn - 1.5 * typical_step();
  const Scan scan{pings_, begin_, ping.time, whole, position_ >= start_};
  begun_ = false;
  pings_ = 0;
  return scan;
}

Scan SweepSegmenter::end_turn(const Ping& ping) {
  const Scan scan{pings_, begin_, ping.time, true, direction_ > 0};
  pings_ = since_extreme_ = 0;
  start_ += direction_ * kTurn;  // turns stay aligned even if bearings are skipped at their end
  extreme_ = position_;
  return scan;
}

Scan SweepSegmenter::end_reversed(const Ping& ping) {
  const Scan scan{pings_ - since_extreme_, begin_, extreme_time_, false, direction_ > 0};
  const bool flies_back = since_extreme_ == 1 && std::abs(extreme_ - position_) > 5 * typical_step();
  pings_ = since_extreme_;
  begin_ = after_extreme_;
  start_ = flies_back ? position_ : extreme_;
  if (!flies_back) direction_ = -direction_;
  extreme_ = position_;
  extreme_time_ = ping.time;
  since_extreme_ = 0;
  return scan;
}

}  // namespace isobath
