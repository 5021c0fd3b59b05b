#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/config.hpp>
#include <isobath/planning/traffic/traffic_planner.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

constexpr double kOffPlan_m = 0.05, kOffPlanHeading = 0.02, kOffPlanSpeed = 0.05;
constexpr double kStray_m = 0.5;    ///< from the straight motion, within which a motion keeps its course
constexpr double kStopped = 0.5;    ///< of the minimum speed of a body with a role, from which on down it counts
constexpr double kRuleless_s = 2;   ///< without a motion by the rules, after which a plan departs from them
constexpr double kGraze_m = 0.1;    ///< overlap that does no harm
constexpr double kSameSpeed = 0.1;  ///< m/s; contacts at speeds as near as this are of equal harm
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr int kOutlineParts = 4;  ///< of a chord, for a body that turns

/// Paths keep one error of chords more than the search (TrafficPlanner::search), so that it can leave them.
RoadRules road_rules(const TrafficConfig& c, const TrafficVehicle& vehicle, double chord_error_m) {
  const double kept_m = vehicle.radius_m + c.margin_m + 4 * chord_error_m;
  return {kept_m, c.still_speed, {c.search.horizon_s, c.search.clear_s, kept_m, c.sigmas, 0}};
}

bool state_is_finite(const MotionState& state) {
  return state.p_W.allFinite() && std::isfinite(state.heading) && std::isfinite(state.speed);
}

}  // namespace

std::vector<Field> fields(TrafficConfig& c) {
  std::vector<Field> all = {
      Field::real("margin", &c.margin_m, {0, 100}, "m", "Distance between hull and bodies that a plan keeps."),
      Field::real("sigmas", &c.sigmas, {0, 10}, "1", "Standard deviations by which predicted bodies grow."),
      Field::real("replan", &c.replan_s, {0, 60}, "s", "Time between searches while the plan stays free."),
      Field::real("gain", &c.gain_s, {0, 60}, "s", "Gain of arrival time for which a free plan is replaced."),
      Field::flag("roads", &c.roads, "Whether a road map of still bodies leads past walls and out of dead ends."),
      Field::real("still_speed", &c.still_speed, {0, 10}, "m/s",
                  "Speed up to which a body belongs to the road map; a higher value plans paths past slow bodies."),
  };
  for (Field& field : fields(c.search)) all.push_back(std::move(field));
  for (Field& field : fields(c.rules)) all.push_back(std::move(field));
  return all;
}

std::string to_text(TrafficAction action) {
  switch (action) {
    case TrafficAction::kFollow: return "follow";
    case TrafficAction::kEvade: return "evade";
    case TrafficAction::kStop: return "stop";
    case TrafficAction::kRetreat: return "retreat";
    case TrafficAction::kHold: return "hold";
    case TrafficAction::kRefuse: break;
  }
  return "refuse";
}

TrafficPlanner::TrafficPlanner(const TrafficConfig& config, const TrafficVehicle& vehicle)
    : config_(config),
      vehicle_(vehicle),
      search_(config.search, vehicle),
      roads_(vehicle, road_rules(config, vehicle, search_.chord_error_m())),
      rules_(config.rules, vehicle.radius_m) {
  if (!(vehicle.min_speed >= 0 && vehicle.min_speed < vehicle.max_speed)) {
    throw Error("the minimum speed of the vehicle is not below its maximum speed", {.key = "min_speed"},
                fmt::format("0 .. {} m/s", vehicle.max_speed));
  }
}

void TrafficPlanner::set_goal(const Eigen::Vector2d& goal_W, double arrival_m) {
  goal_W_ = goal_W;
  arrival_m_ = arrival_m;
  searched_.reset();
  roads_.set_goal(goal_W, arrival_m);
  std::optional<DirectMotion> rest;
  if (!plan_.trajectory.segments.empty() && plan_.action == TrafficAction::kFollow) {
    rest = direct_motion(vehicle_, plan_.trajectory.at(plan_.free_s), goal_W, arrival_m);
  }
  if (rest) {
    plan_.arrival_s = plan_.free_s + rest->arrival_s;
  } else {
    plan_.trajectory.segments.clear();
  }
}

void TrafficPlanner::continue_from(const TrafficPlanner& before) {
  rules_.take_roles(before.rules_);
  ruled_ = before.ruled_;
  keeps_zones_ = before.keeps_zones_;
  goal_W_ = before.goal_W_;
  arrival_m_ = before.arrival_m_;
  roads_.set_goal(goal_W_, arrival_m_);
  plan_ = before.plan_;
  if (before.vehicle_.max_speed > vehicle_.max_speed) plan_.trajectory.segments.clear();
}

bool TrafficPlanner::on_plan(const MotionState& own, Time now) const {
  if (plan_.trajectory.segments.empty()) return false;
  const double from_s = to_seconds(now - plan_.start);
  if (from_s < 0 || from_s >= plan_.trajectory.duration_s()) return false;
  const MotionState there = plan_.trajectory.at(from_s);
  return (own.p_W - there.p_W).norm() < kOffPlan_m &&
         std::abs(std::remainder(own.heading - there.heading, 2 * std::numbers::pi)) < kOffPlanHeading &&
         std::abs(own.speed - there.speed) < kOffPlanSpeed;
}

void TrafficPlanner::sample(const Trajectory& motion, double from_s) const {
  const double piece_s = TrafficSearch::kStep_s / TrafficSearch::kPieces, left_s = motion.duration_s() - from_s;
  samples_.clear();
  for (double t = 0; t < left_s; t += piece_s) samples_.push_back({t, motion.at(from_s + t).p_W});
  samples_.push_back({left_s, motion.at(from_s + left_s).p_W});
}

TrafficPlanner::Approach TrafficPlanner::closest(const MovingBody& body, Time now) const {
  const double age_s = to_seconds(now - body.time);
  const double shape_m = circumscribed_radius(body);
  Approach least{{body.number, 0, std::numeric_limits<double>::infinity()}, std::numeric_limits<double>::infinity(), 0};
  for (std::size_t k = 1; k < samples_.size(); ++k) {
    const auto& [from_s, p] = samples_[k - 1];
    const auto& [to_s, q] = samples_[k];
    const int parts = body.outline.empty() ? 1 : kOutlineParts;
    const double growth = predicted_growth(body, age_s + to_s, config_.sigmas) + vehicle_.radius_m;
    if (!body.outline.empty()) {
      const double far_m = (p - body.p_W - (age_s + from_s) * body.velocity_W).norm() - shape_m - growth;
      const double moves_m = (q - p).norm() + (to_s - from_s) * body.velocity_W.norm();
      if (far_m - moves_m > std::max(0.0, least.passage.gap_m)) continue;  // it cannot come nearer
    }
    for (int part = 0; part < parts; ++part) {
      const double first = static_cast<double>(part) / parts, last = (part + 1.0) / parts;
      const double start_s = from_s + first * (to_s - from_s), end_s = from_s + last * (to_s - from_s);
      const Eigen::Vector2d a = p + first * (q - p) - body.p_W - (age_s + start_s) * body.velocity_W;
      const Eigen::Vector2d side = p + last * (q - p) - body.p_W - (age_s + end_s) * body.velocity_W - a;
      const double length2 = side.squaredNorm();
      const double share = length2 > 0 ? std::clamp(-a.dot(side) / length2, 0.0, 1.0) : 0;
      const double at = start_s + share * (end_s - start_s);
      const double gap =
          (body.outline.empty() ? (a + share * side).norm() - body.radius_m
                                : distance_to(body, p + (at - from_s) / (to_s - from_s) * (q - p), age_s + at)) -
          growth;
      if (gap < least.passage.gap_m) least.passage = {body.number, at, gap};
      if (gap < -kGraze_m && at < least.contact_s) {
        least.contact_s = at;
        least.contact_speed = std::sqrt(length2) / (end_s - start_s);
      }
    }
  }
  return least;
}

bool TrafficPlanner::plan_is_free(Time now, double margin_m) const {
  sample(plan_.trajectory, to_seconds(now - plan_.start));
  const auto is_clear = [&](const MovingBody& body) {
    return closest(body, now).passage.gap_m >= margin_m + search_.chord_error_m();
  };
  return std::ranges::all_of(bodies_, is_clear) && (!keeps_zones_ || std::ranges::all_of(zones_.zones, is_clear));
}

std::vector<Passage> TrafficPlanner::passages(Time now, double within_m) const {
  std::vector<Passage> all;
  sample(plan_.trajectory, std::max(0.0, to_seconds(now - plan_.start)));
  for (const auto* bodies : {&bodies_, &left_out_}) {
    for (const MovingBody& body : *bodies) {
      const Passage one = closest(body, now).passage;
      if (one.gap_m <= within_m) all.push_back(one);
    }
  }
  std::ranges::stable_sort(all, {}, &Passage::time_s);
  return all;
}

std::optional<RoadMotion> TrafficPlanner::search_roads(const MotionState& own, Time now) {
  if (!has_roads_) return std::nullopt;
  roads_.find(own, now);
  return roads_.motion(own, now);
}

/// The error of the chords counts three times: here, in the later checks of the plan, which have other chords, and as
/// their own error.
double TrafficPlanner::kept_m(double margin_m) const {
  return vehicle_.radius_m + margin_m + 3 * search_.chord_error_m();
}

void TrafficPlanner::follow_rules(const MotionState& own, Time now) {
  const Eigen::Vector2d to_goal = goal_W_ - own.p_W;
  rules_.update(own, vehicle_.max_speed * to_goal.normalized(), now, bodies_);
  const auto stands_on = [&](const MovingBody& body) {
    return rules_.stands_on_for(body.number) && body.velocity_W.norm() >= kStopped * config_.rules.min_speed;
  };
  std::ranges::copy_if(bodies_, std::back_inserter(left_out_), stands_on);
  std::erase_if(bodies_, stands_on);
  // A little more than the search keeps, so that a motion can begin where it is.
  zones_ = rules_.zones(own, now, kept_m(config_.margin_m) + search_.chord_error_m());
  if (zones_.zones.empty()) keeps_zones_ = true;
  plan_.duties = rules_.duties();
  note_departure();
}

void TrafficPlanner::note_departure() {
  plan_.departs = zones_.left_out > 0 || (!keeps_zones_ && !zones_.zones.empty());
}

void TrafficPlanner::count_all_bodies() {
  bodies_.insert(bodies_.end(), left_out_.begin(), left_out_.end());
  left_out_.clear();
}

bool TrafficPlanner::goes_straight(const MotionState& own) const {
  const auto direct = direct_motion(vehicle_, own, goal_W_, arrival_m_);
  if (!direct) return false;
  for (double t = 1; t <= std::min(config_.rules.act_s, direct->arrival_s); ++t) {
    if ((found_.at(t).p_W - direct->at(t).p_W).norm() > kStray_m) return false;
  }
  return true;
}

bool TrafficPlanner::search_by_rules(const MotionState& own, Time now) {
  const auto find = [&] {
    with_zones_ = bodies_;
    with_zones_.insert(with_zones_.end(), zones_.zones.begin(), zones_.zones.end());
    // A motion that ends in an escape before the horizon would wait in front of what comes.
    return search(with_zones_, own, now, config_.margin_m, kNever) && result_.end == SearchEnd::kHorizon;
  };
  if (!find()) return false;
  if (left_out_.empty() || goes_straight(own)) return true;
  sample(found_, 0);
  const auto is_passed = [&](const MovingBody& body) { return closest(body, now).passage.gap_m >= config_.margin_m; };
  if (std::ranges::all_of(left_out_, is_passed)) return true;
  count_all_bodies();  // to manoeuvre for one body must not bring the vehicle near another
  return find();
}

bool TrafficPlanner::search(std::span<const MovingBody> bodies, const MotionState& own, Time now, double margin_m,
                            double before_s) {
  const double steps_s = search_.steps() * TrafficSearch::kStep_s;
  traffic_.build(bodies, {.start = now,
                          .step_s = TrafficSearch::kStep_s,
                          .count = search_.steps(),
                          .distance_m = kept_m(margin_m),
                          .sigmas = config_.sigmas,
                          .middle_W = own.p_W,
                          .half_side_m = vehicle_.max_speed * steps_s,
                          .piece_m = search_.piece_m()});
  result_ = search_.search(traffic_, own, goal_W_, arrival_m_, has_roads_ ? roads_.guide() : nullptr, before_s, found_);
  ++work_.searches;
  work_.expansions += result_.expansions;
  work_.checks += traffic_.checks();
  return result_.end != SearchEnd::kNone;
}

void TrafficPlanner::take_found(Time now, double margin_m, bool keeps_zones) {
  keeps_zones_ = keeps_zones;
  note_departure();
  std::swap(plan_.trajectory, found_);
  plan_.action = result_.end == SearchEnd::kHorizon ? TrafficAction::kFollow : TrafficAction::kEvade;
  plan_.start = now;
  plan_.arrival_s = result_.arrival_s;
  plan_.free_s = result_.free_s;
  plan_.margin_m = margin_m;
  plan_.on_road = plan_.mends = false;
  ++plan_.number;
  plan_.reason.clear();
}

bool TrafficPlanner::take_stop(const MotionState& own, Time now) {
  if (vehicle_.min_speed > 0) return false;
  found_.segments.clear();
  found_.append(own, 0, -vehicle_.braking, own.speed / vehicle_.braking);
  found_.append(own, 0, 0, config_.search.horizon_s);
  if (worst_of(found_, now).passage.gap_m < config_.margin_m) return false;
  result_ = {SearchEnd::kEscape, kNever, 0, 0};
  take_found(now, config_.margin_m, zones_.zones.empty());
  plan_.action = TrafficAction::kStop;
  plan_.reason = "no path leads to the goal: " + plan_.road_reason;
  return true;
}

TrafficPlanner::Approach TrafficPlanner::worst_of(const Trajectory& motion, Time now) const {
  sample(motion, 0);
  Approach worst{{0, 0, kNever}, kNever, 0};
  for (const MovingBody& body : bodies_) {
    const Approach one = closest(body, now);
    if (one.passage.gap_m < worst.passage.gap_m) worst.passage = one.passage;
    if (one.contact_s < worst.contact_s) {
      worst.contact_s = one.contact_s;
      worst.contact_speed = one.contact_speed;
    }
  }
  return worst;
}

void TrafficPlanner::take_least_harm(const MotionState& own, Time now) {
  struct Choice {
    TrafficAction action;
    double curvature, acceleration;
  };
  const double k = vehicle_.max_curvature(), horizon_s = config_.search.horizon_s;
  const double slower = own.speed > vehicle_.min_speed ? -vehicle_.braking : 0;
  const double faster = own.speed < vehicle_.max_speed ? vehicle_.acceleration : 0;
  Approach best{{0, 0, -std::numeric_limits<double>::infinity()}, 0, std::numeric_limits<double>::infinity()};
  for (const Choice& choice : {Choice{TrafficAction::kStop, 0, slower},
                               {TrafficAction::kStop, k, slower},
                               {TrafficAction::kStop, -k, slower},
                               {TrafficAction::kRetreat, k, faster},
                               {TrafficAction::kRetreat, -k, faster},
                               {TrafficAction::kHold, 0, faster}}) {
    found_.segments.clear();
    const double limit = choice.acceleration > 0 ? vehicle_.max_speed : vehicle_.min_speed;
    const double changing_s =
        choice.acceleration == 0 ? 0 : std::min(horizon_s, (limit - own.speed) / choice.acceleration);
    found_.append(own, choice.curvature, choice.acceleration, changing_s);
    const double turning_s = choice.action == TrafficAction::kRetreat ? 3.1 / (k * vehicle_.max_speed) : horizon_s;
    found_.append(own, choice.curvature, 0, std::clamp(turning_s - changing_s, 0.0, horizon_s - changing_s));
    found_.append(own, 0, 0, std::max(0.0, horizon_s - found_.duration_s()));
    const Approach worst = worst_of(found_, now);
    const double gain = best.contact_speed - worst.contact_speed;
    if (gain < -kSameSpeed || (gain <= kSameSpeed && worst.passage.gap_m <= best.passage.gap_m)) continue;
    best = worst;
    std::swap(plan_.trajectory, found_);
    plan_.action = choice.action;
  }
  keeps_zones_ = zones_.zones.empty();
  note_departure();
  plan_.start = now;
  plan_.arrival_s = std::numeric_limits<double>::infinity();
  plan_.free_s = 0;
  plan_.margin_m = 0;
  plan_.on_road = plan_.mends = false;
  ++plan_.number;
  plan_.reason = fmt::format("no motion keeps clear; {} comes nearest to body {}, {:.2f} m in {:.1f} s",
                             to_text(plan_.action), best.passage.number, best.passage.gap_m, best.passage.time_s);
}

const TrafficPlan& TrafficPlanner::step(const MotionState& own, Time now, std::span<const MovingBody> bodies) {
  work_ = {};
  if (!state_is_finite(own) || !goal_W_.allFinite()) {
    plan_ = {};
    plan_.reason = "the state of the vehicle or the goal is not finite";
    return plan_;
  }
  bodies_.clear();
  for (const MovingBody& body : bodies) {
    if (is_valid(body)) bodies_.push_back(body);
  }
  work_.refused_bodies = static_cast<int>(bodies.size() - bodies_.size());
  left_out_.clear();
  if (config_.rules.on) follow_rules(own, now);
  has_roads_ = config_.roads && roads_.update(own, bodies_);
  const bool kept = on_plan(own, now) && plan_.reason.empty();
  bool free = kept && plan_is_free(now, plan_.margin_m);
  const double since_s = kept ? to_seconds(now - plan_.start) : 0;
  const bool whole = plan_.action == TrafficAction::kFollow && plan_.margin_m == config_.margin_m;
  if (free && whole && searched_ && to_seconds(now - *searched_) < config_.replan_s - 1e-6) return plan_;
  searched_ = now;
  const auto replaces = [&] {
    const bool better = result_.arrival_s < plan_.arrival_s - since_s - config_.gain_s;
    const bool as_far = result_.end == SearchEnd::kHorizon;
    const bool old = since_s > 0.5 * plan_.free_s;
    return !free || (as_far ? better || old || !whole : !whole);
  };
  const std::optional<RoadMotion> road = search_roads(own, now);
  plan_.road_reason = has_roads_ ? roads_.reason() : std::string();
  if (has_roads_ && roads_.is_shut() && take_stop(own, now)) return plan_;
  if (!zones_.zones.empty() || !left_out_.empty()) {
    if (search_by_rules(own, now)) {
      ruled_ = now;
      if (replaces() || !keeps_zones_) take_found(now, config_.margin_m, true);
      return plan_;
    }
    if (free && keeps_zones_ && to_seconds(now - ruled_) < kRuleless_s) return plan_;
    count_all_bodies();
    free = free && plan_is_free(now, plan_.margin_m);
  }
  for (const double share : {1.0, 0.5, 0.0}) {
    const double margin_m = share * config_.margin_m;
    if (free && margin_m < plan_.margin_m) return plan_;
    const bool by_road = !search(bodies_, own, now, margin_m, road ? road->arrival_s - config_.gain_s : kNever);
    if (by_road && !road) continue;
    if (by_road) result_ = {SearchEnd::kHorizon, road->arrival_s, road->free_s, 0};
    if (!replaces()) return plan_;
    if (by_road) found_ = road->trajectory;
    take_found(now, margin_m, zones_.zones.empty());
    if (by_road) {
      plan_.on_road = true;
      plan_.mends = road->mends;
      roads_.follow();
    }
    return plan_;
  }
  if (!free) take_least_harm(own, now);
  return plan_;
}

}  // namespace isobath
