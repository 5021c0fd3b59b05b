#include <cmath>
#include <isobath/onboard/event_gate.hpp>

namespace isobath {
namespace {

const char* content_fault(const Ping& ping) {
  const PingFault fault = check(ping);
  return fault == PingFault::kNone ? nullptr : to_text(fault);
}

const char* content_fault(const Navigation& fix) {
  const bool finite = fix.X_WB.is_finite() && fix.X_WB.translation.norm() < 1e8 &&
                      (!fix.v_WB || fix.v_WB->allFinite()) && (!fix.covariance || fix.covariance->allFinite());
  return finite ? nullptr : EventGate::kBadNavigation;
}

constexpr double kFarthestSensor = 1e4;  // m from the vehicle's reference, as for pings

const char* content_fault(const RangeReading& reading) {
  const auto range = [](double r) { return std::isfinite(r) && r >= 0; };
  const double width = reading.width.degrees();
  const bool possible = reading.X_BS.is_finite() && reading.X_BS.translation.norm() < kFarthestSensor &&
                        range(reading.max_range_m) && range(reading.range_m.value_or(0)) && width >= 0 && width <= 360;
  return possible ? nullptr : EventGate::kBadRange;
}

const char* content_fault(const Health& health) {
  return health.battery_share >= 0 && health.battery_share <= 1 ? nullptr : EventGate::kBadHealth;
}

const char* content_fault(const Swath& swath) {
  const SwathFault fault = check(swath);
  return fault == SwathFault::kNone ? nullptr : to_text(fault);
}

const char* content_fault(const PassiveBearing& heard) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  const double elevation = heard.elevation.value_or(Angle{}).degrees();
  const bool possible = heard.X_BS.is_finite() && heard.X_BS.translation.norm() < kFarthestSensor &&
                        std::isfinite(heard.bearing.radians()) && positive(heard.sigma.radians()) &&
                        heard.sigma.degrees() <= 180 && elevation >= -90 && elevation <= 90 &&
                        positive(heard.frequency_hz) && positive(heard.resolution_hz) && std::isfinite(heard.snr_db);
  return possible ? nullptr : EventGate::kBadBearing;
}

/// The end of the link skips bytes that are no frame.
const char* content_fault(const OperatorFrame&) { return nullptr; }

}  // namespace

std::vector<Field> fields(EventGateConfig& c) {
  return {Field::real("max_age_s", &c.max_age_s, {0, 3600}, "s",
                      "Events that are older than the newest one by more than this are rejected."),
          Field::integer("restart_after", &c.restart_after, {2, 1000000}, "1",
                         "Late events in a row, in order among themselves, that count as a clock set back."),
          Field::real("max_speed", &c.max_speed, {0.1, 1000}, "m/s",
                      "Maximum speed of the vehicle from one fix to the next.")
              .was("most_speed"),
          Field::real("max_jump_m", &c.max_jump_m, {0, 1e6}, "m",
                      "Largest correction of the position at once; a fix farther off is rejected as a jump.")
              .was("leap_m"),
          Field::integer("accept_jump_after", &c.accept_jump_after, {1, 1000000}, "1",
                         "Fixes in a row, in agreement among themselves, after which a jump is accepted.")
              .was("believe_leap_after")};
}

EventGate::Verdict EventGate::judge(const Event& event) {
  const char* fault = std::visit([](const auto& e) { return content_fault(e); }, event);
  if (fault) {
    count(fault);
    return Verdict::kRejected;
  }
  Stream& stream = streams_[event.index()];
  const Time time = time_of(event);
  fault = order_fault(stream, time);
  const auto* fix = std::get_if<Navigation>(&event);
  if (!fault && fix) {
    fault = leap_fault(*fix);
    if (fault) {
      count(fault);
      return Verdict::kRejected;
    }
  }
  if (!fault) {
    stream.newest = time;
    stream.late_in_order = 0;
    newest_ = std::max(newest_, time);
    return Verdict::kAdmitted;
  }
  if (stream.late_in_order >= config_.restart_after) {
    for (Stream& s : streams_) s = {};
    stream.newest = newest_ = time;
    last_.reset();
    if (fix) last_ = Place{fix->time, fix->X_WB.translation};
    return Verdict::kRestarted;
  }
  count(fault);
  return Verdict::kRejected;
}

const char* EventGate::order_fault(Stream& stream, Time time) {
  const bool backwards = time < stream.newest;
  const bool old = newest_ != Time::min() && time < newest_ - seconds(config_.max_age_s);
  if (!backwards && !old) return nullptr;
  stream.late_in_order = time >= stream.late_newest ? stream.late_in_order + 1 : 1;
  stream.late_newest = time;
  return backwards ? kBackwards : kTooOld;
}

bool EventGate::in_reach(const Place& from, const Place& to) const {
  const double time_s = std::abs(to_seconds(to.time - from.time));
  return (to.p_WB - from.p_WB).norm() <= config_.max_jump_m + config_.max_speed * time_s;
}

const char* EventGate::leap_fault(const Navigation& fix) {
  const Place here{fix.time, fix.X_WB.translation};
  if (last_ && !in_reach(*last_, here)) {
    leaps_ = leapt_ && in_reach(*leapt_, here) ? leaps_ + 1 : 1;
    leapt_ = here;
    if (leaps_ < config_.accept_jump_after) return kLeap;
  }
  last_ = here;
  leapt_.reset();
  leaps_ = 0;
  return nullptr;
}

}  // namespace isobath
