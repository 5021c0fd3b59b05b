// Whatever comes, in any order and with any values: the Safety Officer lives, and asks for no more speed than ordered,
// or than an escape needs.
#include <bit>
#include <gtest/gtest.h>
#include <isobath/mission/safety/safety_officer.hpp>
#include <limits>
#include <rapidcheck/gtest.h>
#include <tests/mission/safety_stream.hpp>

namespace isobath {
namespace {

/// Draws in the order of the calls, one a statement: argument order is the compiler's.
class Draw {
 public:
  explicit Draw(const std::vector<std::uint64_t>& bits) : bits_(bits) {}
  std::uint64_t bits() {
    const std::uint64_t drawn = (bits_[next_ % bits_.size()] + next_) * 0x9E3779B97F4A7C15ULL;
    ++next_;
    return drawn ^ drawn >> 29U;
  }
  int below(int n) { return static_cast<int>((bits() >> 33U) % static_cast<std::uint64_t>(n)); }
  /// Plausible, extreme, or no number at all.
  double number(double scale) {
    switch (below(8)) {
      case 0: return std::numeric_limits<double>::quiet_NaN();
      case 1: return std::numeric_limits<double>::infinity();
      case 2: return std::bit_cast<double>(bits());
      case 3: return 0;
      default: break;
    }
    const double share = static_cast<double>(bits() >> 11U) / 9007199254740992.0;
    return scale * (2 * share - 1);
  }
  Time time(Time now) {
    switch (below(6)) {
      case 0: return Time(Duration(std::numeric_limits<std::int64_t>::max()));
      case 1: return Time(Duration(std::numeric_limits<std::int64_t>::min()));
      case 2: return Time(Duration(static_cast<std::int64_t>(bits())));
      default: return now;
    }
  }
  Eigen::Vector2d place(double scale) {
    const double x = number(scale);
    const double y = number(scale);
    return {x, y};
  }
  Rotation turn() {
    const double heading = number(4);
    const double pitch = number(2);
    return Rotation::from_heading_pitch_roll(Angle::radians(heading), Angle::radians(pitch), {});
  }
  template <class Enum>
  Enum one_of(int n) {
    return static_cast<Enum>(below(n));
  }

 private:
  const std::vector<std::uint64_t>& bits_;
  std::size_t next_ = 0;
};

Polygon polygon(Draw& draw) {
  Polygon p;
  const int corners = draw.below(6);
  for (int i = 0; i < corners; ++i) p.push_back(draw.place(50));
  return p;
}

std::shared_ptr<const MissionPlan> plan(Draw& draw) {
  if (draw.below(8) == 0) return nullptr;
  auto made = std::make_shared<MissionPlan>();
  made->points.resize(static_cast<std::size_t>(draw.below(3)));
  for (MissionPoint& point : made->points) {
    if (draw.below(2) == 0) point.altitude_m = draw.number(10);
  }
  made->fence = polygon(draw);
  made->limits.max_depth_m = draw.number(50);
  made->limits.min_altitude_m = draw.number(5);
  made->limits.max_position_sigma_m = draw.number(50);
  made->limits.max_duration_s = draw.number(50);
  made->limits.low_battery_share = draw.number(1);
  made->at_end = draw.one_of<MissionEnd>(3);
  return made;
}

Navigation fix(Draw& draw, Time now) {
  Navigation n;
  n.time = draw.time(now);
  n.X_WB.rotation = draw.turn();
  n.X_WB.translation.head<2>() = draw.place(100);
  n.X_WB.translation.z() = draw.number(30);
  if (draw.below(2) == 0) {
    const Eigen::Vector2d v = draw.place(3);
    n.v_WB = Eigen::Vector3d(v.x(), v.y(), 0);
  }
  if (draw.below(2) == 0) n.covariance = Eigen::Matrix<double, 6, 6>::Identity() * draw.number(100);
  return n;
}

SonarHealthSample look(Draw& draw, Time now) {
  SonarHealthSample s;
  s.time = draw.time(now);
  s.sonar = draw.below(3) == 0 ? "sonar" : "sonar." + std::to_string(draw.below(100));
  s.digest = static_cast<std::uint64_t>(draw.below(2));
  s.full_scale = draw.number(1);
  s.silent = draw.number(1);
  s.roughness = draw.number(1);
  if (draw.below(2) == 0) s.port = draw.number(1);
  if (draw.below(2) == 0) s.starboard = draw.number(1);
  return s;
}

SonarEchoes echoes(Draw& draw, Time now) {
  SonarEchoes s;
  s.time = draw.time(now);
  s.blanking_m = draw.number(5);
  const int count = draw.below(5);
  for (int i = 0; i < count; ++i) s.echoes_L.push_back(draw.place(10));
  if (draw.below(2) == 0) s.X_WL = Pose{draw.turn(), Eigen::Vector3d(draw.number(100), 0, 0)};
  return s;
}

RangeReading range(Draw& draw, Time now) {
  RangeReading r;
  r.time = draw.time(now);
  if (draw.below(4) != 0) r.range_m = draw.number(20);
  r.max_range_m = draw.number(50);
  r.width = Angle::radians(draw.number(1));
  r.X_BS.rotation = draw.turn();
  r.confidence = static_cast<float>(draw.number(1));
  return r;
}

Message command(Draw& draw) {
  OperatorCommand c;
  c.kind = draw.one_of<OperatorCommand::Kind>(5);
  if (draw.below(3) != 0) c.plan = plan(draw);
  return c;
}

Message order(Draw& draw) {
  HelmOrder o;
  o.setpoint.heading = Angle::radians(draw.number(4));
  o.setpoint.depth = draw.number(20);
  o.setpoint.speed = draw.number(3);
  o.setpoint.sway_speed = draw.number(3);
  return o;
}

Message route(Draw& draw) {
  switch (draw.below(5)) {
    case 0: return RoutePlanned{};
    case 1: return RouteRefused{draw.one_of<RouteRefused::Reason>(6), 0, 0, {}, "no"};
    case 2: {
      WaypointPassed passed;
      passed.version = static_cast<std::uint32_t>(draw.below(2));
      passed.index = draw.below(3) == 0 ? std::size_t{1} << 40U : static_cast<std::size_t>(draw.below(4));
      return passed;
    }
    case 3: {
      MissionReport report;
      report.phase = draw.one_of<MissionPhase>(5);
      return report;
    }
    default: break;
  }
  FollowOrder follow;
  follow.version = static_cast<std::uint32_t>(draw.below(2));
  const int points = draw.below(4);
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector2d p = draw.place(100);
    follow.waypoints.push_back({p.x(), p.y(), draw.number(10), 1});
  }
  if (draw.below(2) == 0) follow.altitude_m = draw.number(5);
  return follow;
}

Message any_message(Draw& draw, Time now) {
  switch (draw.below(11)) {
    case 0:
    case 1: return fix(draw, now);
    case 2: return look(draw, now);
    case 3: return range(draw, now);
    case 4: {
      static const std::vector<std::string> kSources = {"vehicle", "depth", "thruster.2", "disk", "sonar", "altimeter"};
      Health health;
      health.time = draw.time(now);
      health.source = kSources[static_cast<std::size_t>(draw.below(6))];
      health.state = draw.one_of<HealthState>(3);
      health.battery_share = static_cast<float>(draw.number(1));
      health.leak = draw.below(20) == 0;
      return health;
    }
    case 5: return command(draw);
    case 6: return order(draw);
    case 7: return route(draw);
    case 8: return echoes(draw, now);
    case 9: {
      ObstacleScan scan;
      Hazard hazard;
      hazard.outline = polygon(draw);
      scan.hazards = {hazard};
      return scan;
    }
    default: break;
  }
  if (draw.below(10) == 0) return AgentLost{draw.below(2) == 0 ? "pilot" : "", true, "gone"};
  return MissionOrder{MissionOrder::Kind::kStart, plan(draw), MissionEnd::kHold, {}};
}

/// The highest speed that was ordered last, of what is a number.
struct Ordered {
  double speed = 0;
  void on_message(const Message& message) {
    const auto* o = std::get_if<HelmOrder>(&message);
    if (!o) return;
    const Setpoint& s = o->setpoint;
    if (std::isfinite(s.speed) && std::isfinite(s.depth) && std::isfinite(s.heading.radians())) speed = s.speed;
  }
};

// ledger: S6-39
RC_GTEST_PROP(SafetyProperty, NeverAsksForMoreSpeedThanWasOrderedWhateverComes, ()) {
  const auto bits = *rc::gen::nonEmpty<std::vector<std::uint64_t>>();
  Draw draw(bits);
  VehicleParameters vehicle = draw.below(2) == 0 ? test::hovering() : test::flying();
  if (vehicle.min_speed > 0) vehicle.limits.turning_radius = draw.below(2) == 0 ? 0 : 4.5;
  const VehicleLimits& limits = vehicle.limits;
  const double turns_fastest = limits.max_yaw_rate.radians() * limits.turning_radius;
  const double escape = vehicle.min_speed > 0 ? std::min(turns_fastest, limits.max_speed) : 0;
  SafetyOfficer officer({}, vehicle);
  Time now = Time(seconds(1000));
  Ordered ordered;
  for (int i = 0; i < 400; ++i) {
    Outbox out;
    if (draw.below(3) == 0) {
      now += draw.below(50) == 0 ? seconds(1e5) : seconds(0.1);
      officer.tick(now, out);
    } else {
      const Message message = any_message(draw, now);
      ordered.on_message(message);
      officer.on_message(message, now, out);
    }
    for (const Message& said : out.said()) {
      const auto* action = std::get_if<SafetyAction>(&said);
      if (!action) continue;
      const Setpoint& s = action->setpoint;
      RC_ASSERT(std::isfinite(s.heading.radians()));
      RC_ASSERT(std::isfinite(s.depth));
      RC_ASSERT(std::isfinite(s.speed));
      RC_ASSERT(s.sway_speed == 0);
      if (action->kind == SafetyActionKind::kTurn || action->kind == SafetyActionKind::kSurface) {
        RC_ASSERT(s.speed <= std::max({0.0, ordered.speed, escape}));
      }
      if (action->kind == SafetyActionKind::kStop) RC_ASSERT(s.speed == 0);
      if (action->kind == SafetyActionKind::kSlow) RC_ASSERT(s.speed == SafetyConfig().slow_speed);
      if (action->kind != SafetyActionKind::kNone) RC_ASSERT(!action->fault.empty());
    }
  }
}

// The same messages give the same words.
RC_GTEST_PROP(SafetyProperty, IsAFunctionOfWhatItHears, ()) {
  const auto bits = *rc::gen::nonEmpty<std::vector<std::uint64_t>>();
  const auto words = [&] {
    Draw draw(bits);
    SafetyOfficer officer({}, test::hovering());
    std::string all;
    for (int i = 0; i < 200; ++i) {
      Outbox out;
      const Time now = Time(seconds(0.1 * i));
      officer.on_message(any_message(draw, now), now, out);
      officer.tick(now, out);
      for (const Message& said : out.said()) {
        if (const auto* decision = std::get_if<Decision>(&said)) all += decision->what + decision->reason;
      }
    }
    return all;
  };
  const std::string first = words();
  const std::string second = words();
  RC_ASSERT(first == second);
}

}  // namespace
}  // namespace isobath
