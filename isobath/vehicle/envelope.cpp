#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/vehicle/envelope.hpp>

namespace isobath {
namespace {

bool is_finite(const Setpoint& s) {
  return std::isfinite(s.heading.radians()) && std::isfinite(s.depth) && std::isfinite(s.speed) &&
         std::isfinite(s.sway_speed);
}

void count(std::uint64_t& counter, double before, double after) { counter += before != after; }

}  // namespace

EnvelopeLimits limits_of(const VehicleSheet& sheet) {
  EnvelopeLimits limits;
  limits.max_depth = sheet.limits.max_depth;
  limits.min_speed = sheet.min_speed;
  limits.max_speed = sheet.limits.max_speed;
  limits.max_acceleration = sheet.limits.max_acceleration;
  limits.max_turn_rate = sheet.limits.max_yaw_rate * 2;
  return limits;
}

Envelope::Envelope(const EnvelopeLimits& limits) : limits_(limits) {
  const auto refuse = [](const char* key, const char* allowed) {
    Place place;
    place.key = key;
    throw Error("no set-point could keep this", place, allowed);
  };
  const auto in_order = [](double low, double high) {
    return std::isfinite(low) && std::isfinite(high) && low <= high;
  };
  if (!in_order(limits.min_depth, limits.max_depth) || limits.min_depth < 0) {
    refuse("min_depth, max_depth", "0 <= min_depth <= max_depth");
  }
  if (!in_order(0, limits.min_altitude)) refuse("min_altitude", "at least 0 m");
  if (!in_order(0, limits.min_speed) || !in_order(limits.min_speed, limits.max_speed)) {
    refuse("min_speed, max_speed", "0 <= min_speed <= max_speed");
  }
  if (!(limits.max_acceleration > 0)) refuse("max_acceleration", "above 0 m/s2");
  if (!(limits.max_turn_rate.radians() > 0)) refuse("max_turn_rate", "above 0");
}

Setpoint Envelope::safe(const Pose& X_WB) const {
  Setpoint hold = last_.value_or(Setpoint{});
  if (X_WB.is_finite()) {
    hold.depth = X_WB.translation.z();
    if (!last_) hold.heading = X_WB.rotation.heading();
  }
  hold.speed = limits_.min_speed;
  hold.sway_speed = 0;
  return hold;
}

double Envelope::limited_speed(double wanted, double before, double dt) {
  const double least = limits_.min_speed > 0 ? limits_.min_speed : -limits_.max_speed;
  const double allowed = std::clamp(wanted, least, limits_.max_speed);
  count(counts_.speed, wanted, allowed);
  // Towards zero at once; from there on no faster than the limit.
  const double most = limits_.max_acceleration * dt;
  const double low = std::min(before, 0.0) - most, high = std::max(before, 0.0) + most;
  const double ramped = std::max(std::clamp(allowed, low, high), least);
  count(counts_.acceleration, allowed, ramped);
  return ramped;
}

Setpoint Envelope::limit(const Setpoint& wanted, const Pose& X_WB, const std::optional<double>& bottom_depth,
                         double dt) {
  ++counts_.set_points;
  const bool good = is_finite(wanted) && std::isfinite(dt) && dt >= 0;
  counts_.not_finite += !good;
  Setpoint out = good ? wanted : safe(X_WB);
  const double elapsed = good ? dt : 0;

  const double depth = std::clamp(out.depth, limits_.min_depth, limits_.max_depth);
  count(counts_.depth, out.depth, depth);
  out.depth = depth;
  if (bottom_depth && std::isfinite(*bottom_depth)) {
    out.depth = std::min(depth, std::max(0.0, *bottom_depth - limits_.min_altitude));
    count(counts_.altitude, depth, out.depth);
  }

  const Setpoint before = last_.value_or(out);
  out.speed = limited_speed(out.speed, before.speed, elapsed);
  const double side = std::sqrt(limits_.max_speed * limits_.max_speed - out.speed * out.speed);
  const double sway = std::clamp(out.sway_speed, -side, side);
  count(counts_.speed, out.sway_speed, sway);
  out.sway_speed = sway;

  const Angle most = limits_.max_turn_rate * elapsed;
  const Angle turn = (out.heading - before.heading).wrapped();
  if (abs(turn) > most) {
    ++counts_.turn_rate;
    out.heading = (before.heading + std::clamp(turn, -most, most)).wrapped();
  }
  last_ = out;
  return out;
}

}  // namespace isobath
