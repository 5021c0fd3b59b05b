// A stream of messages of a healthy vehicle under way, ten of each a second, that a test breaks as it likes; and all
// that the Safety Officer says to it.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <isobath/mission/safety/safety_officer.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace isobath::test {

/// A vehicle that can stop and turns within 2 m.
inline VehicleParameters hovering() {
  VehicleParameters parameters;
  parameters.braking = 0.5;
  parameters.limits.turning_radius = 2;
  return parameters;
}

/// One that needs way on.
inline VehicleParameters flying() {
  VehicleParameters parameters = hovering();
  parameters.min_speed = 0.7;
  return parameters;
}

/// North for 1 km.
inline MissionPlan plan_north() {
  MissionPlan plan;
  plan.points.resize(1);
  plan.points[0].north_east = {1000, 0};
  plan.limits.max_depth_m = 20;
  plan.limits.max_position_sigma_m = 10;
  return plan;
}

class SafetyStream {
 public:
  explicit SafetyStream(const VehicleParameters& vehicle = hovering(), const SafetyConfig& config = {},
                        const MissionPlan& plan = plan_north())
      : officer(config, vehicle), parameters(vehicle), plan_(std::make_shared<const MissionPlan>(plan)) {}

  /// What a test may change at any time.
  bool pings = true, fixes = true, reports = true, altimeter = true, beats = false, obeys = true;
  std::function<void(SonarHealthSample&)> on_look;
  std::function<void(SonarEchoes&)> on_echoes;
  std::function<void(Navigation&)> on_fix;
  std::function<void(Health&)> on_health;
  std::function<void(RangeReading&)> on_range;
  double speed_ordered = 1.5;
  Eigen::Vector2d current = Eigen::Vector2d::Zero();
  double clock_off_s = 0;  ///< of all times in messages
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double heading = 0, depth = 5, speed = 1.5, altitude = 10, sigma = 0.5;

  void tell(const Message& message) {
    Outbox out;
    officer.on_message(message, now(), out);
    keep(out);
  }

  /// From where it is to this second of the run; the mission starts with the first call.
  void run_to(double end_s) {
    if (step_ == 0) {
      OperatorCommand start;
      start.kind = OperatorCommand::Kind::kStart;
      start.plan = plan_;
      tell(start);
      RoutePlanned planned;
      tell(planned);
      FollowOrder follow;
      follow.version = 1;
      follow.waypoints = {{1000, 0, depth, 1.5}};
      tell(follow);
    }
    for (; time_s() < end_s - 1e-9; ++step_) step();
  }

  [[nodiscard]] double time_s() const { return step_ * 0.1; }
  [[nodiscard]] Time now() const { return Time(seconds(1000 + time_s())); }

  struct Said {
    double at_s = 0;
    Message message;
  };
  std::vector<Said> said;

  /// When the row was raised first after `after_s`; -1: never.
  [[nodiscard]] double raised(Fault fault, double after_s = 0) const {
    return first(fault, after_s, [](const SafetyReport& r) { return r.active; });
  }
  [[nodiscard]] double over(Fault fault, double after_s = 0) const {
    return first(fault, after_s, [](const SafetyReport& r) { return !r.active; });
  }
  [[nodiscard]] double aborted(Fault fault) const {
    return first(fault, 0, [](const SafetyReport& r) { return r.abort; });
  }
  [[nodiscard]] std::optional<MissionEnd> end() const {
    for (const Said& s : said) {
      const auto* report = std::get_if<SafetyReport>(&s.message);
      if (report && report->abort) return report->end;
    }
    return std::nullopt;
  }
  [[nodiscard]] std::size_t count_reports() const {
    return static_cast<std::size_t>(std::count_if(
        said.begin(), said.end(), [](const Said& s) { return std::holds_alternative<SafetyReport>(s.message); }));
  }
  /// When this kind of action was first said after `after_s`; -1: never.
  [[nodiscard]] double acted(SafetyActionKind kind, double after_s = 0) const {
    for (const Said& s : said) {
      const auto* action = std::get_if<SafetyAction>(&s.message);
      if (action && action->kind == kind && s.at_s >= after_s) return s.at_s;
    }
    return -1;
  }
  [[nodiscard]] std::string reason(Fault fault) const {
    const std::string name = to_text(fault);
    for (const Said& s : said) {
      const auto* decision = std::get_if<Decision>(&s.message);
      if (decision && decision->reason.starts_with(name)) return decision->reason;
    }
    return {};
  }

  SafetyOfficer officer;
  VehicleParameters parameters;

 private:
  template <class Which>
  [[nodiscard]] double first(Fault fault, double after_s, Which which) const {
    for (const Said& s : said) {
      const auto* report = std::get_if<SafetyReport>(&s.message);
      if (report && report->fault == to_text(fault) && which(*report) && s.at_s >= after_s) return s.at_s;
    }
    return -1;
  }

  void keep(Outbox& out) {
    for (Message& message : out.said()) said.push_back({time_s(), std::move(message)});
  }

  /// As the gate at the helm would: the action stands above the order; braking as the sheet says.
  void obey() {
    if (!obeys) return;
    const SafetyAction& action = officer.action();
    double wanted = speed_ordered, towards = 0;
    switch (action.kind) {
      case SafetyActionKind::kNone: break;
      case SafetyActionKind::kSlow: wanted = std::min(wanted, action.setpoint.speed); break;
      case SafetyActionKind::kStop: wanted = 0; break;
      case SafetyActionKind::kTurn:
        wanted = action.setpoint.speed;
        towards = action.setpoint.heading.radians();
        depth += std::clamp(action.setpoint.depth - depth, -0.03, 0.03);
        break;
      case SafetyActionKind::kSurface:
        wanted = parameters.min_speed > 0 ? action.setpoint.speed : 0;
        towards = action.setpoint.heading.radians();
        depth = std::max(0.0, depth - 0.03);
        break;
    }
    speed += std::clamp(wanted - speed, -0.1 * parameters.braking, 0.1 * parameters.braking);
    const double rate = 0.1 * std::min(parameters.limits.max_yaw_rate.radians(),
                                       speed / std::max(parameters.limits.turning_radius, 0.1) + 0.3);
    heading += std::clamp(std::remainder(towards - heading, 2 * std::numbers::pi), -rate, rate);
  }

  void step() {
    obey();
    const Eigen::Vector2d v = speed * Eigen::Vector2d(std::cos(heading), std::sin(heading)) + current;
    place += 0.1 * v;
    const Time said_at = now() + seconds(clock_off_s);
    if (fixes) tell_fix(said_at, v);
    if (pings) tell_look(said_at);
    if (altimeter) tell_altitude(said_at);
    if (reports && step_ % 10 == 0) {
      Health health{said_at, "vehicle", HealthState::kOk, 0.9F, false, {}};
      if (on_health) on_health(health);
      tell(health);
    }
    if (beats && step_ % 10 == 5) tell(OperatorCommand{});
    HelmOrder order;
    order.setpoint = {Angle{}, 5, speed_ordered, 0};
    tell(order);
    Outbox out;
    officer.tick(now(), out);
    keep(out);
  }

  void tell_fix(Time at, const Eigen::Vector2d& v) {
    Navigation fix;
    fix.time = at;
    // An estimate is never still, not even that of a vehicle that is.
    fix.X_WB = {Rotation::from_heading(Angle::radians(heading)), {place.x(), place.y(), depth + 1e-4 * (step_ % 7)}};
    fix.v_WB = Eigen::Vector3d(v.x(), v.y(), 0);
    fix.covariance = Eigen::Matrix<double, 6, 6>::Identity() * sigma * sigma;
    if (on_fix) on_fix(fix);
    tell(fix);
    fix_ = fix;
  }

  void tell_look(Time at) {
    SonarHealthSample look;
    look.time = at;
    look.sonar = "sonar";
    look.digest = static_cast<std::uint64_t>(step_) * 7919 + 1;
    look.mean = 0.15;
    look.full_scale = 0.05;
    look.silent = 0.01;
    look.roughness = 0.06;
    // A head that steps through 90 degrees and back.
    const int at_step = step_ % 60 < 30 ? step_ % 60 - 15 : 45 - step_ % 60;
    look.bearing = Angle::degrees(3.0 * at_step);
    if (at_step < 0) look.port = 0.15;
    if (at_step > 0) look.starboard = 0.15;
    if (on_look) on_look(look);
    tell(look);
    SonarEchoes echoes;
    echoes.time = look.time;
    echoes.X_WL = level(fix_.X_WB);
    if (on_echoes) on_echoes(echoes);
    tell(echoes);
  }

  void tell_altitude(Time at) {
    RangeReading reading;
    reading.time = at;
    reading.range_m = altitude;
    reading.max_range_m = 50;
    reading.width = Angle::degrees(10);
    reading.X_BS.rotation = Rotation::from_heading_pitch_roll({}, Angle::degrees(-90), {});
    if (on_range) on_range(reading);
    tell(reading);
  }

  std::shared_ptr<const MissionPlan> plan_;
  Navigation fix_;  ///< the last one told
  int step_ = 0;
};

}  // namespace isobath::test
