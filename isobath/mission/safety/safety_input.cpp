// The Safety Officer's processing of its input; its ticks judge the result (safety_checks.cpp).
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/safety/safety_officer.hpp>
#include <utility>

namespace isobath {
namespace {

constexpr double kFarthest = 1e8;      // m
constexpr double kNextFix = 5;         // s: fixes farther apart say nothing about each other
constexpr double kDown = 0.7071;       // a sensor that looks more than 45 degrees down measures the bottom
constexpr double kFreshSpeed = 3;      // s
constexpr double kSmooth = 0.3;        // share of the newest turn
constexpr std::size_t kMaxNames = 64;  // of sonars and of health sources; further ones are not kept
constexpr double kBeside = 0.5;        // s: sources with messages this recent are compared
constexpr double kApart = 1;           // m, between the points that stand for an outline
constexpr double kInTraffic_s = 120;   // without progress, while the Goal Selector steers
constexpr double kMapped = 40;         // m: farther obstacles do not matter to an escape
constexpr double kBeyondReach = 20;    // m: echoes are kept up to this far beyond the stopping distance

bool usable(const Navigation& fix) {
  return fix.X_WB.is_finite() && fix.X_WB.translation.cwiseAbs().maxCoeff() < kFarthest &&
         (!fix.v_WB || (fix.v_WB->allFinite() && fix.v_WB->norm() < kFarthest));
}

double sigma_of(const Navigation& fix) {
  if (!fix.covariance) return 0;
  const double variance = std::max((*fix.covariance)(0, 0), (*fix.covariance)(1, 1));
  return variance > 0 && std::isfinite(variance) ? std::sqrt(variance) : 0;
}

bool same_place(const Navigation& a, const Navigation& b) {
  return a.X_WB.translation == b.X_WB.translation &&
         a.X_WB.rotation.quaternion().coeffs() == b.X_WB.rotation.quaternion().coeffs();
}

/// Agents without which the vehicle is not controlled; compared by the letters of their names.
bool leads(const std::string& agent) {
  std::string letters;
  for (const char c : agent) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  for (const char* name : {"captain", "executiveofficer", "navigator", "pilot", "flsdetector"}) {
    if (letters == name) return true;
  }
  return false;
}

/// Points along an outline, at most `apart_m` apart.
std::vector<Eigen::Vector2d> points_round(const Polygon& outline, double apart_m) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& from = outline[i];
    const Eigen::Vector2d side = outline[(i + 1) % outline.size()] - from;
    if (!from.allFinite() || !(side.norm() < kFarthest)) continue;
    const int pieces = 1 + static_cast<int>(std::min(side.norm() / apart_m, 1000.0));
    for (int k = 0; k < pieces; ++k) points.emplace_back(from + side * k / pieces);
  }
  return points;
}

}  // namespace

void SafetyOfficer::set_clock(Time now) {
  if (!now_) {
    now_ = now;
    return;
  }
  const double gap = to_seconds(now) - to_seconds(*now_);
  if (!(gap > 0)) return;
  if (gap > config_.clock_jump_s) {
    jumped_ = fmt::format("the logical clock jumped by {:.1f} s", gap);
    clock_s_ += to_seconds(kTick);
  } else {
    clock_s_ += gap;
  }
  now_ = now;
}

/// False where a message is so much later than those of other sensors that it does not count.
bool SafetyOfficer::in_time(Speaker speaker, Time said, Time now) {
  static constexpr std::array<const char*, kSpeakers> kNames = {"navigation", "the sonar", "ranges", "health reports"};
  const double off = to_seconds(said) - to_seconds(now);
  Offset& own = offsets_[speaker];
  if (own.known && std::abs(off - own.s) > config_.clock_jump_s) {
    jumped_ = fmt::format("the times of {} jumped by {:.1f} s", kNames[speaker], off - own.s);
  }
  own = {true, off, clock_s_};
  double newest = off;
  for (const Speaker sensor : {kNavigator, kSonar, kRanger}) {
    const Offset& other = offsets_[sensor];
    if (other.known && clock_s_ - other.heard_s < kBeside) newest = std::max(newest, other.s);
  }
  const double limit = speaker == kNavigator ? config_.navigation_silent_s : config_.sonar_silent_s;
  return off >= newest - limit;
}

void SafetyOfficer::on_message(const Message& message, Time now, Outbox&) {
  set_clock(now);
  if (const auto* fix = std::get_if<Navigation>(&message)) on_fix(*fix, now);
  if (const auto* look = std::get_if<SonarHealthSample>(&message)) on_sonar_health(*look, now);
  if (const auto* echoes = std::get_if<SonarEchoes>(&message)) on_echoes(*echoes, now);
  if (const auto* reading = std::get_if<RangeReading>(&message)) on_range(*reading, now);
  if (const auto* health = std::get_if<Health>(&message)) on_health(*health, now);
  if (const auto* command = std::get_if<OperatorCommand>(&message)) on_command(*command);
  if (const auto* sweep = std::get_if<Sweep>(&message)) on_sweep(*sweep);
  if (const auto* scan = std::get_if<ObstacleScan>(&message)) on_scan(*scan);
  if (const auto* chart = std::get_if<ChartedHazards>(&message)) on_chart(*chart);
  if (const auto* world = std::get_if<WorldSnapshot>(&message)) on_world(*world);
  if (const auto* lost = std::get_if<AgentLost>(&message)) on_lost(*lost);
  if (const auto* order = std::get_if<FollowOrder>(&message)) follow(*order);
  if (const auto* wait = std::get_if<PassageWait>(&message)) waits_for_turn_ = wait->waits;
  if (std::holds_alternative<RouteRequest>(message)) wants_route_ = true;
  if (const auto* report = std::get_if<PointReport>(&message)) on_point(*report);
  if (std::holds_alternative<MotionOrder>(message)) wait_for_traffic();
  if (const auto* report = std::get_if<MissionReport>(&message)) phase_ = report->phase;
  if (const auto* refused = std::get_if<RouteRefused>(&message)) refusal_ = Refusal{refused->reason, refused->why};
  if (std::holds_alternative<RoutePlanned>(message)) {
    refusal_.reset();
    ever_planned_ = true;
    inside_.clear();
  }
  if (const auto* order = std::get_if<MissionOrder>(&message)) {
    if (order->kind == MissionOrder::Kind::kStart) start(order->plan);
  }
  if (const auto* passed = std::get_if<WaypointPassed>(&message)) {
    if (way_ && passed->version == way_->version && passed->index + 2 > way_->next) {
      way_->next = std::min(passed->index + 2, way_->points.size());
      way_->nearest_m = std::numeric_limits<double>::infinity();
      way_->progress_s = clock_s_;
      way_->in_traffic_s = 0;
    }
  }
  if (const auto* order = std::get_if<HelmOrder>(&message)) {
    const Setpoint& s = order->setpoint;
    if (std::isfinite(s.heading.radians()) && std::isfinite(s.depth) && std::isfinite(s.speed)) order_ = s;
  }
}

void SafetyOfficer::on_point(const PointReport& report) {
  if (report.kind == PointReport::Kind::kDropped) wants_route_ = false;
  if (report.kind != PointReport::Kind::kTaken || report.point == tried_point_) return;
  tried_point_ = report.point;
  Row& no_path = row(Fault::kNoPath);
  if (no_path.raised && !no_path.aborted) no_path.since_s = clock_s_;
}

void SafetyOfficer::on_fix(const Navigation& fix, Time now) {
  if (!usable(fix)) {
    jump_ = "a fix that is not finite";
    return;
  }
  if (!in_time(kNavigator, fix.time, now)) return;
  Fix next{fix, clock_s_, Eigen::Vector2d::Zero(), 0, sigma_of(fix)};
  if (fix.v_WB) next.v_W = fix.v_WB->head<2>();
  if (!fix_ || !same_place(fix, fix_->navigation)) moved_s_ = clock_s_;
  const double dt = fix_ ? to_seconds(fix.time) - to_seconds(fix_->navigation.time) : 0;
  if (fix_ && dt > 0 && dt <= kNextFix) {
    const Eigen::Vector2d from = fix_->navigation.X_WB.translation.head<2>(), to = fix.X_WB.translation.head<2>();
    const Eigen::Vector2d off = to - (from + fix_->v_W * dt);
    const double allowed = config_.jump_m + 4 * std::max(fix_->sigma_m, next.sigma_m) +
                           0.5 * std::max(0.0, vehicle_.limits.max_speed) * dt;
    const bool jumped = off.norm() > allowed;
    if (jumped) {
      jump_ = fmt::format("a fix {:.1f} m from the predicted position, {:.1f} m allowed", off.norm(), allowed);
      echoes_.shift(off);
      for (Eigen::Vector2d& p : mapped_W_) p += off;
      solid_W_.clear();
      for (Mover& mover : movers_) {
        for (Eigen::Vector2d& p : mover.outline_W) p += off;
      }
      space_.reset();
    }
    if (!fix.v_WB) next.v_W = jumped ? fix_->v_W : Eigen::Vector2d((to - from) / dt);
    const Angle turned = (fix.X_WB.rotation.heading() - fix_->navigation.X_WB.rotation.heading()).wrapped();
    next.yaw_rate = fix_->yaw_rate + kSmooth * (turned.radians() / dt - fix_->yaw_rate);
  }
  if (dt > 0 && next.navigation.v_WB) {
    current_.update(fix.X_WB.rotation.heading(), *fix.v_WB, next.yaw_rate, dt);
  }
  fix_ = next;
}

void SafetyOfficer::on_sonar_health(const SonarHealthSample& look, Time now) {
  if (!in_time(kSonar, look.time, now)) return;
  const auto known = sonars_.find(look.sonar);
  if (known == sonars_.end() && sonars_.size() >= kMaxNames) return;
  sonars_[look.sonar].update(look, config_, clock_s_);
}

void SafetyOfficer::on_echoes(const SonarEchoes& echoes, Time now) {
  if (!in_time(kSonar, echoes.time, now)) return;
  if (std::isfinite(echoes.blanking_m)) blanking_m_ = echoes.blanking_m;
  const double reach = stop_way(vehicle_.limits.max_speed, config_.reaction_s) + kBeyondReach;
  echoes_.add(echoes, reach, config_, clock_s_);
}

void SafetyOfficer::on_range(const RangeReading& reading, Time now) {
  if (!reading.X_BS.is_finite() || (reading.range_m && !(*reading.range_m >= 0 && *reading.range_m < kFarthest)))
    return;
  if (!in_time(kRanger, reading.time, now)) return;
  const Pose X_WB = fix_ ? fix_->navigation.X_WB : Pose{};
  const Pose X_WL = level(X_WB);
  const Pose X_LS = Pose{X_WL.rotation.inverse() * X_WB.rotation, Eigen::Vector3d::Zero()} * reading.X_BS;
  const double down = (X_LS.rotation * Eigen::Vector3d::UnitX()).z();
  if (down > kDown) on_altitude(reading, down);
  if (std::abs(down) <= kDown) ahead_s_ = clock_s_;
  std::optional<Eigen::Vector3d> v_B;
  if (fix_ && clock_s_ - fix_->heard_s <= kFreshSpeed) {
    const Eigen::Vector3d v_W(fix_->v_W.x(), fix_->v_W.y(), 0);
    v_B = X_WB.rotation.inverse() * v_W;
  }
  imminent_.update(rangers_.index_of(reading.X_BS).value_or(SensorTable::kMax - 1), reading, v_B);
  if (!reading.range_m || std::abs(down) > kDown) return;
  const Eigen::Vector2d echo = (X_LS * Eigen::Vector3d(*reading.range_m, 0, 0)).head<2>();
  const double reach = stop_way(vehicle_.limits.max_speed, config_.reaction_s) + kBeyondReach;
  echoes_.add(echo, X_WL, reach, config_, clock_s_);
}

void SafetyOfficer::on_altitude(const RangeReading& reading, double down) {
  altitude_.spoken = true;
  altitude_.heard_s = clock_s_;
  bool low = false;
  if (reading.range_m) {
    altitude_.echo_s = clock_s_;
    altitude_.last_m = *reading.range_m * down + reading.X_BS.translation.z();
    const double least = plan_ ? plan_->limits.min_altitude_m : 0;
    const double share = std::max(config_.clear_share, 0.1);
    low = altitude_.last_m < (raised(Fault::kTooLow) ? least / share : least);
  }
  altitude_.low = (altitude_.low << 1U | static_cast<std::uint32_t>(low)) & 7U;
}

void SafetyOfficer::on_health(const Health& health, Time now) {
  in_time(kHost, health.time, now);
  if (health.leak) leak_ = health.source + " reports water inside";
  if (health.source == "vehicle") {
    health_s_ = clock_s_;
    const double share = static_cast<double>(health.battery_share);
    if (share >= 0 && share <= 1) battery_share_ = share;
  }
  const auto known = states_.find(health.source);
  if (known == states_.end() && states_.size() >= kMaxNames) return;
  states_[health.source] = health.state;
}

void SafetyOfficer::on_command(const OperatorCommand& command) {
  if (command.kind == OperatorCommand::Kind::kBeat || beat_s_) beat_s_ = clock_s_;
  if (command.kind == OperatorCommand::Kind::kStart) start(command.plan);
}

void SafetyOfficer::on_sweep(const Sweep& sweep) {
  if (!sweep.posed) return;
  movers_.clear();
  for (const Obstacle& obstacle : sweep.map->obstacles) {
    if (!obstacle.moves() || obstacle.outline.empty() || !obstacle.motion.velocity_W.allFinite()) continue;
    movers_.push_back(
        {points_round(world_outline(obstacle, sweep.map->X_WB), kApart), obstacle.motion.velocity_W, clock_s_});
  }
}

void SafetyOfficer::on_scan(const ObstacleScan& scan) {
  mapped_W_.clear();
  if (scan.posed && vehicle_.min_speed > 0) {  // only a vehicle that cannot stop needs an escape
    for (const Hazard& hazard : scan.hazards) {
      if (hazard.kind == HazardKind::kFence || hazard.kind == HazardKind::kMoving) continue;
      for (const Eigen::Vector2d& p_L : points_round(hazard.outline, kApart)) {
        if (!(p_L.norm() < kMapped)) continue;
        mapped_W_.emplace_back((scan.X_WL * Eigen::Vector3d(p_L.x(), p_L.y(), 0)).head<2>());
      }
    }
  }
  if (ever_planned_) return;
  inside_.clear();
  for (const Hazard& hazard : scan.hazards) {
    if (hazard.kind == HazardKind::kFence || hazard.kind == HazardKind::kMoving || hazard.outline.size() < 3) continue;
    if (contains(hazard.outline, Eigen::Vector2d::Zero())) {
      inside_ = "the vehicle is inside an obstacle";
      return;
    }
  }
}

void SafetyOfficer::on_chart(const ChartedHazards& chart) {
  charted_W_.clear();
  if (!chart.hazards || !fix_ || !(vehicle_.min_speed > 0)) return;
  const Eigen::Vector2d vehicle = fix_->navigation.X_WB.translation.head<2>();
  for (const Hazard& hazard : *chart.hazards) {
    for (const Eigen::Vector2d& p : points_round(hazard.outline, kApart)) {
      if ((p - vehicle).norm() < kMapped) charted_W_.push_back(p);
    }
  }
}

void SafetyOfficer::on_world(const WorldSnapshot& world) {
  space_ = world.voxels;
  solid_W_.clear();
  if (!space_ || !fix_) return;
  solid_W_ = space_->occupied_columns(fix_->navigation.X_WB.translation, config_.height_margin_m, kMapped);
}

void SafetyOfficer::on_lost(const AgentLost& lost) {
  if (!leads(lost.agent)) return;
  lost_agent_ = fmt::format("the {} {}: {}", lost.agent, lost.hung ? "hangs" : "died", lost.why);
}

/// The order to the Captain and the Captain's own order name the same plan: the second changes nothing.
void SafetyOfficer::start(const std::shared_ptr<const MissionPlan>& plan) {
  if (!plan || (plan == plan_ && phase_ == MissionPhase::kUnderWay)) return;
  plan_ = plan;
  phase_ = MissionPhase::kUnderWay;
  started_s_ = clock_s_;
  refusal_.reset();
  inside_.clear();
  way_.reset();
  tried_point_.reset();
  ever_planned_ = false;
  for (Row& row : rows_) row.aborted = false;
  for (Fault again : {Fault::kMissionTooLong, Fault::kBatteryLow}) row(again) = Row{};
}

/// While the vehicle is led past moving bodies, the watch over its progress waits, for kInTraffic_s at most.
void SafetyOfficer::wait_for_traffic() {
  if (!way_) return;
  const double since_s = std::min(clock_s_ - std::exchange(way_->steered_s, clock_s_), to_seconds(MotionOrder::kLasts));
  if (way_->in_traffic_s + since_s > kInTraffic_s) return;
  way_->in_traffic_s += since_s;
  way_->progress_s = std::min(way_->progress_s + since_s, clock_s_);
}

void SafetyOfficer::follow(const FollowOrder& order) {
  surfacing_ = order.surface;
  Way way;
  way.version = order.version;
  way.altitude = order.altitude_m.has_value();
  if (fix_) way.from = fix_->navigation.X_WB.translation.head<2>();
  way.points.emplace_back(way.from.value_or(Eigen::Vector2d(0, 0)));
  for (const Waypoint& w : order.waypoints) way.points.emplace_back(w.north, w.east);
  const bool finite = std::all_of(way.points.begin(), way.points.end(),
                                  [](const auto& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < kFarthest; });
  // A route that is planned again and again to the same point must still bring the vehicle nearer.
  const bool same = way_ && finite && way.from && way.points.size() > 1 && way_->points.size() > 1 &&
                    (way_->points.back() - way.points.back()).norm() < config_.progress_m;
  way.nearest_m = same ? (way.points[1] - *way.from).norm() : std::numeric_limits<double>::infinity();
  way.progress_s = same ? way_->progress_s : clock_s_;
  way.steered_s = way_ ? way_->steered_s : 0;
  way.in_traffic_s = same ? way_->in_traffic_s : 0;
  way_.reset();
  if (!finite) return;
  way_ = std::move(way);
}

}  // namespace isobath
