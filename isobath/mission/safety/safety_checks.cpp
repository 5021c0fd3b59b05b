// The causes for which the Safety Officer checks in each cycle, row by row of the fault table.
#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/safety/safety_officer.hpp>

namespace isobath {
namespace {

constexpr double kToMove = 0.1;  // m/s: a slower order is an order to stay
constexpr double kFresh = 2;     // s

double distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d way = b - a;
  const double length2 = way.squaredNorm();
  const double share = length2 > 0 ? std::clamp((p - a).dot(way) / length2, 0.0, 1.0) : 0;
  return (p - a - share * way).norm();
}

}  // namespace

void SafetyOfficer::find(Fault fault, std::string why) {
  Row& found = row(fault);
  if (found.cause) return;  // one reason is enough
  found.cause = true;
  found.why = std::move(why);
}

bool SafetyOfficer::watching() const { return plan_ && phase_ != MissionPhase::kWaiting; }

bool SafetyOfficer::under_way() const { return phase_ == MissionPhase::kUnderWay || phase_ == MissionPhase::kHolding; }

void SafetyOfficer::check_sonars() {
  if (!watching()) return;
  // Range sonars that look ahead are the eyes of a vehicle without another sonar.
  if (sonars_.empty() && ahead_s_) {
    const double silent = std::min(clock_s_ - *ahead_s_, clock_s_ - started_s_);
    if (silent > config_.sonar_silent_s) find(Fault::kSonarSilent, fmt::format("no range ahead for {:.1f} s", silent));
  } else if (sonars_.empty() && clock_s_ - started_s_ > config_.startup_s) {
    find(Fault::kSonarSilent, fmt::format("no ping in {:.0f} s since the start", clock_s_ - started_s_));
  }
  for (const auto& [source, state] : states_) {
    if (source.starts_with("sonar") && state == HealthState::kLost) {
      find(Fault::kSonarSilent, "the host reports that " + source + " is lost");
    }
  }
  for (const auto& [name, sonar] : sonars_) {
    const double silent = clock_s_ - sonar.last_s(), since_start = clock_s_ - started_s_;
    if (silent > config_.sonar_silent_s && since_start > config_.sonar_silent_s) {
      find(Fault::kSonarSilent, fmt::format("no ping of {} for {:.1f} s", name, silent));
    }
    if (sonar.frozen()) find(Fault::kSonarFrozen, name + " sends identical pings");
    if (sonar.saturated()) {
      find(Fault::kSonarSaturated,
           fmt::format("{:.0f} % of the samples of {} at full scale", 100 * sonar.last().full_scale, name));
    }
    if (sonar.deaf(config_, clock_s_)) find(Fault::kSonarDeaf, name + " delivers only zeros");
    if (sonar.port_blind()) find(Fault::kSonarBlindSide, name + " receives nothing from port");
    if (sonar.starboard_blind()) find(Fault::kSonarBlindSide, name + " receives nothing from starboard");
    if (sonar.garbled()) {
      find(Fault::kSonarGarbled,
           fmt::format("neighbouring bins of {} differ by {:.2f} of full scale", name, sonar.last().roughness));
    }
  }
}

void SafetyOfficer::check_navigation() {
  const auto depth = states_.find("depth");
  if (watching() && depth != states_.end() && depth->second == HealthState::kLost) {
    find(Fault::kDepthLost, "the host reports that the depth sensor is lost");
  }
  if (!jump_.empty() && watching()) find(Fault::kNavigationJump, jump_);
  jump_.clear();
  if (!watching()) return;
  const auto host = states_.find("navigation");
  if (host != states_.end() && host->second == HealthState::kLost) {
    find(Fault::kNavigationSilent, "the host reports that navigation is lost");
  }
  if (!fix_) {
    if (clock_s_ - started_s_ > config_.startup_s) {
      find(Fault::kNavigationSilent, fmt::format("no fix in {:.0f} s since the start", clock_s_ - started_s_));
    }
    return;
  }
  const double silent = std::min(clock_s_ - fix_->heard_s, clock_s_ - started_s_);
  if (silent > config_.navigation_silent_s) {
    find(Fault::kNavigationSilent, fmt::format("no fix for {:.1f} s", silent));
  }
  const bool free = action_.kind == SafetyActionKind::kNone || action_.kind == SafetyActionKind::kSlow;
  const bool to_move = order_ && order_->speed > kToMove && free;
  if (!to_move) {
    to_move_since_s_.reset();
  } else if (!to_move_since_s_) {
    to_move_since_s_ = clock_s_;
  }
  const double standing = moved_s_ ? clock_s_ - *moved_s_ : 0;  // a vehicle ordered to stay has constant fixes, too
  const double still = to_move ? std::min(standing, clock_s_ - *to_move_since_s_) : standing;
  if (still > config_.navigation_silent_s && (to_move || raised(Fault::kNavigationSilent))) {
    find(Fault::kNavigationSilent,
         fmt::format("the same fix for {:.1f} s while the vehicle is ordered to move", still));
  }
  const double most = plan_->limits.max_position_sigma_m;
  if (fix_->sigma_m > most * (raised(Fault::kNavigationDrift) ? config_.clear_share : 1)) {
    find(Fault::kNavigationDrift,
         fmt::format("the position is known to {:.1f} m, {:.1f} m allowed", fix_->sigma_m, most));
  }
}

void SafetyOfficer::check_altitude() {
  if (!watching()) return;
  for (const auto& [source, state] : states_) {
    if (source.starts_with("altimeter") && state == HealthState::kLost) {
      find(Fault::kAltitudeLost, "the host reports that " + source + " is lost");
    }
  }
  const double since_start = clock_s_ - started_s_;
  const bool wanted = std::any_of(plan_->points.begin(), plan_->points.end(),
                                  [](const MissionPoint& p) { return p.altitude_m.has_value(); });
  if (!altitude_.spoken) {
    if (wanted && since_start > config_.startup_s)
      find(Fault::kAltitudeLost, "no sensor measures the altitude that the mission asks for");
    return;
  }
  const double silent = std::min(clock_s_ - altitude_.heard_s, since_start);
  if (silent > config_.altitude_silent_s) {
    find(Fault::kAltitudeLost, fmt::format("no reading of the altitude for {:.1f} s", silent));
  }
  const double unheard = std::min(clock_s_ - altitude_.echo_s, since_start);
  if (way_ && way_->altitude && unheard > config_.altitude_silent_s) {
    find(Fault::kAltitudeLost,
         fmt::format("no echo of the bottom for {:.1f} s while an altitude is to be held", unheard));
  }
  if (std::popcount(altitude_.low) >= 2) {
    find(Fault::kTooLow,
         fmt::format("{:.1f} m above the bottom, {:.1f} m allowed", altitude_.last_m, plan_->limits.min_altitude_m));
  }
}

void SafetyOfficer::check_way() {
  const bool fresh = fix_ && clock_s_ - fix_->heard_s < kFresh;
  if (phase_ != MissionPhase::kUnderWay || !way_ || !fresh || way_->next >= way_->points.size()) return;
  const Eigen::Vector2d here = fix_->navigation.X_WB.translation.head<2>();
  if (!way_->from) {
    way_->from = here;
    way_->points[0] = here;
  }
  double beside = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < way_->points.size(); ++i) {
    beside = std::min(beside, distance(here, way_->points[i - 1], way_->points[i]));
  }
  const double most = config_.cross_track_m + 2 * vehicle_.limits.turning_radius;
  if (!(beside > most * (raised(Fault::kWayNotFollowed) ? config_.clear_share : 1))) {
    way_->off_since_s.reset();
  } else if (!way_->off_since_s) {
    way_->off_since_s = clock_s_;
  }
  if (way_->off_since_s && clock_s_ - *way_->off_since_s >= config_.off_route_s) {
    find(Fault::kWayNotFollowed, fmt::format("{:.1f} m off the route, {:.1f} m allowed", beside, most));
  }
  const double left = (way_->points[way_->next] - here).norm();
  const bool free = action_.kind == SafetyActionKind::kNone || action_.kind == SafetyActionKind::kSlow;
  if (left < way_->nearest_m - config_.progress_m || !order_ || !(order_->speed > kToMove) || !free) {
    way_->nearest_m = std::min(left, way_->nearest_m);
    way_->progress_s = clock_s_;
    way_->in_traffic_s = 0;
  }
  if (clock_s_ - way_->progress_s > config_.progress_s) {
    find(Fault::kWayNotFollowed, fmt::format("no nearer to way-point {} than {:.1f} m for {:.0f} s", way_->next,
                                             way_->nearest_m, clock_s_ - way_->progress_s));
  }
}

void SafetyOfficer::check_route() {
  if (!under_way()) return;
  if (!inside_.empty()) find(Fault::kInsideObstacle, inside_);
  if (!refusal_ || waits_for_turn_ || !wants_route_) return;
  const bool first_look = !ever_planned_ && clock_s_ - started_s_ < config_.startup_s;
  if (refusal_->reason == RouteRefused::Reason::kNoMap && first_look) return;  // no sweep has ended yet
  switch (refusal_->reason) {
    case RouteRefused::Reason::kStartBlocked: find(Fault::kInsideObstacle, refusal_->why); break;
    case RouteRefused::Reason::kNoPath:
    case RouteRefused::Reason::kNoMap: find(Fault::kNoPath, refusal_->why); break;
    case RouteRefused::Reason::kOutOfBudget: find(Fault::kPlannerOverBudget, refusal_->why); break;
    case RouteRefused::Reason::kGoalBlocked:
    case RouteRefused::Reason::kOutsideFence: break;  // the point is at fault, not the route to it
  }
}

bool SafetyOfficer::fenced() const {
  return plan_ && plan_->fence.size() >= 3 &&
         std::ranges::all_of(plan_->fence, [](const auto& p) { return p.allFinite(); });
}

void SafetyOfficer::check_limits() {
  if (!watching()) return;
  const double most = plan_->limits.max_duration_s;
  if (most > 0 && under_way() && clock_s_ - started_s_ > most) {
    find(Fault::kMissionTooLong, fmt::format("{:.0f} s under way, {:.0f} s allowed", clock_s_ - started_s_, most));
  }
  if (!fix_) return;
  const Eigen::Vector3d& p = fix_->navigation.X_WB.translation;
  const double deepest = std::min(plan_->limits.max_depth_m, vehicle_.limits.max_depth);
  if (p.z() > deepest + (raised(Fault::kTooDeep) ? 0 : config_.depth_slack_m)) {
    find(Fault::kTooDeep, fmt::format("{:.1f} m deep, {:.1f} m allowed", p.z(), deepest));
  }
  if (!fenced()) return;
  const Eigen::Vector2d here = p.head<2>();
  if (!encloses(plan_->fence, here)) {
    find(Fault::kFenceBreach, fmt::format("{:.1f} m outside the fence", -inner_distance(plan_->fence, here)));
    return;
  }
  const double speed = fix_->v_W.norm();
  if (vehicle_.min_speed > 0 || !(speed > kToMove)) return;  // check_fence() is for one that cannot stop
  const double reach = stop_way(speed, config_.reaction_s) + config_.collision_margin_m;
  const Eigen::Vector2d there = here + fix_->v_W / speed * std::min(reach, 1e6);
  if (first_exit(plan_->fence, here, there)) {
    find(Fault::kFenceAhead, fmt::format("the fence lies within the stopping distance of {:.1f} m", reach));
  }
}

void SafetyOfficer::check_host() {
  if (!lost_agent_.empty()) find(Fault::kAgentDead, lost_agent_);
  if (!leak_.empty()) find(Fault::kLeak, leak_);
  const double least = plan_ ? plan_->limits.low_battery_share : 0;
  if (battery_share_ && *battery_share_ < least) {
    find(Fault::kBatteryLow,
         fmt::format("{:.0f} % of a charge left, {:.0f} % required", 100 * *battery_share_, 100 * least));
  }
  for (const auto& [source, state] : states_) {
    if (state == HealthState::kOk) continue;
    if (source.starts_with("thruster")) find(Fault::kThrusterLost, source + " delivers less than it should");
    if (source.starts_with("disk")) find(Fault::kDiskFull, "recording has stopped");
    if (source == "vehicle" && state == HealthState::kLost)
      find(Fault::kHealthSilent, "the vehicle reports that it is lost");
  }
  if (watching()) {
    const double silent = clock_s_ - std::max(health_s_, started_s_);
    const bool spoken = states_.contains("vehicle");
    if (silent > (spoken ? config_.health_silent_s : config_.startup_s)) {
      find(Fault::kHealthSilent, fmt::format("no report of the vehicle's health for {:.0f} s", silent));
    }
    if (beat_s_ && clock_s_ - *beat_s_ > config_.link_silent_s) {
      find(Fault::kLinkLost, fmt::format("the last message from the operator is {:.0f} s old", clock_s_ - *beat_s_));
    }
  }
  if (!jumped_.empty()) find(Fault::kClockJump, jumped_);
  jumped_.clear();
}

}  // namespace isobath
