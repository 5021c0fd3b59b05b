#include <cmath>
#include <isobath/runtime/event_gate.hpp>

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

const char* content_fault(const RangeReading& reading) {
  const bool finite =
      reading.X_BS.is_finite() && (!reading.range_m || (std::isfinite(*reading.range_m) && *reading.range_m >= 0));
  return finite ? nullptr : EventGate::kBadRange;
}

const char* content_fault(const Health& health) {
  return health.battery_share >= 0 && health.battery_share <= 1 ? nullptr : EventGate::kBadHealth;
}

}  // namespace

std::vector<Field> fields(EventGateConfig& c) {
  return {Field::real("max_age_s", &c.max_age_s, {0, 3600}, "s",
                      "Events that lie further than this behind the newest one are rejected."),
          Field::integer("restart_after", &c.restart_after, {2, 1000000}, "1",
                         "Late events in a row, in order among themselves, after which the clock counts as set back.")};
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
  if (!fault) {
    stream.newest = time;
    stream.late_in_order = 0;
    newest_ = std::max(newest_, time);
    return Verdict::kAdmitted;
  }
  if (stream.late_in_order >= config_.restart_after) {
    for (Stream& s : streams_) s = {};
    stream.newest = newest_ = time;
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

std::uint64_t EventGate::rejected_total() const {
  std::uint64_t total = 0;
  for (const auto& [reason, count] : rejected_) total += count;
  return total;
}

}  // namespace isobath
