#include <algorithm>
#include <fmt/format.h>
#include <isobath/onboard/emergency_alarms.hpp>

namespace isobath {

std::vector<Alarm> alarms_of(const EmergencyFlags& flags) {
  std::vector<Alarm> alarms;
  const EmergencyFlags::Snapshot now = flags.snapshot();
  for (int bit = 0; bit < 32; ++bit) {
    const auto first = flags.first_raise(bit);
    if (!first) continue;
    const char* name = name_of_emergency(bit);
    alarms.push_back({name ? name : fmt::format("flag {}", bit), *first, (now.raised >> bit & 1U) != 0,
                      (now.unacknowledged >> bit & 1U) == 0});
  }
  return alarms;
}

std::string to_text(const Alarm& alarm) {
  return fmt::format("{}, first at {}, {} at the end", alarm.what, to_text(alarm.first),
                     alarm.lasting ? "still raised" : "over");
}

std::string present_text(const Alarm& alarm) {
  return fmt::format("{}, first at {}, {}{}", alarm.what, to_text(alarm.first), alarm.lasting ? "lasts" : "over",
                     alarm.acknowledged ? "" : ", not acknowledged");
}

Alarms::Alarms(const ImminentCollisionConfig& collision, const StateEvaluatorConfig& state)
    : collision_(collision, SensorTable::kMax), state_(state, {}, Time{}) {}

void Alarms::on_event(const Event& event) {
  if (const auto* reading = std::get_if<RangeReading>(&event)) look(*reading);
  if (const auto* health = std::get_if<Health>(&event)) {
    state_.on_health(*health);
    state_.evaluate(health->time, flags_);
  }
}

void Alarms::look(const RangeReading& reading) {
  if (!reading.X_BS.is_finite()) return;
  const std::size_t sensor = sensors_.index_of(reading.X_BS).value_or(SensorTable::kMax - 1);
  if (collision_.update(sensor, reading, velocity_at(reading.time))) {
    flags_.set(Emergency::kImminentCollision, reading.time);
  } else {
    flags_.clear(Emergency::kImminentCollision);
  }
}

void Alarms::moved(const Navigation& fix) {
  std::optional<Eigen::Vector3d> v_W = fix.v_WB;
  const Duration since = fix_ ? fix.time - fix_->time : kFreshFix * 2;
  if (!v_W && since == Duration::zero()) return;  // a second fix of the same time carries no speed
  if (!v_W && since > Duration::zero() && since <= kFreshFix) {
    v_W = (fix.X_WB.translation - fix_->X_WB.translation) / to_seconds(since);
  }
  v_B_.reset();
  if (v_W) v_B_ = fix.X_WB.rotation.inverse() * *v_W;
  fix_ = fix;
}

void Alarms::jumped(const Eigen::Vector3d& by_W) {
  if (fix_) fix_->X_WB.translation += by_W;
}

std::optional<Eigen::Vector3d> Alarms::velocity_at(Time time) const {
  if (!fix_ || time - fix_->time > kFreshFix) return std::nullopt;
  return v_B_;
}

}  // namespace isobath
