#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/report/mission_outcome.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

namespace isobath {
namespace {

using nlohmann::ordered_json;

/// Rounded to 1e-6, which is finer than any sonar and still readable; null if not finite.
ordered_json number_json(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e6) / 1e6;
}

std::string dump(const ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json stage_json(const StageTime& t) {
  return {{"count", t.count}, {"median_ms", t.median_ms}, {"p99_ms", t.p99_ms}, {"worst_ms", t.worst_ms}};
}

ordered_json points_json(const MissionPlan& plan) {
  ordered_json points = ordered_json::array();
  for (const MissionPoint& p : plan.points) {
    points.push_back(
        {{"name", p.name}, {"north_m", number_json(p.north_east.x())}, {"east_m", number_json(p.north_east.y())}});
  }
  return points;
}

}  // namespace

std::string MissionOutcome::failure() const {
  if (truth && truth->contact_s >= 0)
    return fmt::format("contact with {} at {:.1f} s", truth->contact_with, truth->contact_s);
  if (report.phase == MissionPhase::kAborted) return "the mission was aborted: " + report.why;
  if (report.phase != MissionPhase::kFinished) return fmt::format("the mission did not end: {}", to_text(report.phase));
  if (report.reached == 0) return "no mission point was reached";
  if (recorded && (*recorded != decisions.size() || as_recorded != decisions.size())) {
    return fmt::format("decision {} differs from the recorded run", as_recorded + 1);
  }
  return {};
}

std::optional<BelievedPlace> place_at(const MissionOutcome& outcome, Time time) {
  const auto after = std::upper_bound(outcome.believed.begin(), outcome.believed.end(), time,
                                      [](Time t, const BelievedPlace& place) { return t < place.time; });
  if (after == outcome.believed.begin()) return std::nullopt;
  return *std::prev(after);
}

std::optional<NavigationError> navigation_error(const MissionOutcome& outcome) {
  if (!outcome.truth) return std::nullopt;
  std::optional<NavigationError> error;
  for (const BelievedPlace& believed : outcome.believed) {
    const std::optional<Pose> truth = true_pose_at(outcome.truth->track, believed.time);
    if (!truth) continue;
    if (!error) error.emplace();
    error->last_m = (believed.north_east - truth->translation.head<2>()).norm();
    error->largest_m = std::max(error->largest_m, error->last_m);
  }
  return error;
}

namespace {

/// How well the vehicle truly held a point at which it was to stay (ledger S7-15): its distance from where it was when
/// the stay began.
struct HeldPoint {
  std::size_t point = 0;
  double largest_m = 0, rms_m = 0;
};

/// One for each point with a stay that was reached, in order.
std::vector<HeldPoint> held_points(const MissionOutcome& outcome) {
  constexpr double kReached_m = 3;
  std::vector<HeldPoint> held;
  const std::vector<MissionPoint>& points = outcome.plan.points;
  auto at = outcome.believed.begin();
  for (std::size_t k = 0; k < points.size() && outcome.truth; ++k) {
    at = std::find_if(at, outcome.believed.end(), [&](const BelievedPlace& place) {
      return (place.north_east - points[k].north_east).norm() <= kReached_m;
    });
    if (at == outcome.believed.end()) break;
    const auto begun = true_pose_at(outcome.truth->track, at->time);
    if (!(points[k].hold_s > 0) || !begun) continue;
    HeldPoint one{k};
    std::size_t instants = 0;
    for (const TrueMotion& motion : outcome.truth->track) {
      const double after_s = to_seconds(motion.time - at->time);
      if (after_s < 0 || after_s > points[k].hold_s) continue;
      const double off = (motion.state.X_WB.translation - begun->translation).head<2>().norm();
      one.largest_m = std::max(one.largest_m, off);
      one.rms_m += off * off;
      ++instants;
    }
    if (instants == 0) continue;
    one.rms_m = std::sqrt(one.rms_m / static_cast<double>(instants));
    held.push_back(one);
  }
  return held;
}

}  // namespace

std::vector<CornerOverrun> corner_overruns(const MissionOutcome& outcome) {
  constexpr double kCorner_rad = std::numbers::pi / 6, kAt_m = 5;
  const std::vector<MissionPoint>& points = outcome.plan.points;
  const std::vector<BelievedPlace>& track = outcome.believed;
  std::vector<CornerOverrun> corners;
  if (track.empty() || outcome.plan.search.on()) return corners;
  Eigen::Vector2d from = track.front().north_east;
  auto at = track.begin();
  const auto first_near = [&](std::size_t point) {
    return std::find_if(at, track.end(), [&](const BelievedPlace& place) {
      return (place.north_east - points[point].north_east).norm() <= kAt_m;
    });
  };
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Eigen::Vector2d corner = points[k].north_east, in = corner - from, leg = points[k + 1].north_east - corner;
    at = first_near(k);
    if (at == track.end()) break;
    from = corner;
    if (leg.norm() <= 2 * kAt_m || in.norm() <= 0) continue;
    const double turn = std::atan2(in.x() * leg.y() - in.y() * leg.x(), in.dot(leg));
    if (std::abs(turn) < kCorner_rad) continue;
    // To the left of the leg when it turns to the right.
    const Eigen::Vector2d outer = Eigen::Vector2d(leg.y(), -leg.x()) * ((turn > 0 ? 1 : -1) / leg.norm());
    CornerOverrun overrun{k, 0, std::nullopt};
    const auto next = first_near(k + 1);
    for (auto place = at; place != next; ++place) {
      overrun.overrun_m = std::max(overrun.overrun_m, outer.dot(place->north_east - corner));
      const auto truth = outcome.truth ? true_pose_at(outcome.truth->track, place->time) : std::nullopt;
      if (!truth) continue;
      overrun.true_m = std::max(overrun.true_m.value_or(0), outer.dot(truth->translation.head<2>() - corner));
    }
    corners.push_back(overrun);
  }
  return corners;
}

bool LevelOutcome::in_time() const {
  constexpr double kTick_s = 0.1;
  const double longest_s = level == CommandLevel::kServo ? longest_interval_s : longest_replan_s;
  return longest_s < timing.replan_s + kTick_s;
}

ordered_json mission_json(const MissionOutcome& outcome, bool with_timings) {
  const MissionReport& report = outcome.report;
  ordered_json json{
      {"title", outcome.plan.title},           {"phase", to_text(report.phase)}, {"why", report.why},
      {"points", points_json(outcome.plan)},   {"reached", report.reached},      {"dropped", report.dropped},
      {"decisions", outcome.decisions.size()}, {"failure", outcome.failure()}};
  json["hazards"] = {{"charted", outcome.charted.size()}, {"measured", outcome.mapped.size()}};
  if (const auto& truth = outcome.truth) {
    json["truth"] = {{"contact", truth->contact_s >= 0},
                     {"contact_s", truth->contact_s >= 0 ? number_json(truth->contact_s) : ordered_json()},
                     {"contact_with", truth->contact_with},
                     {"least_clearance_m", number_json(truth->min_clearance_m)},
                     {"nearest_body", truth->nearest_body},
                     {"least_altitude_m", number_json(truth->min_altitude_m)},
                     {"path_m", number_json(truth->length_m)}};
    if (const auto error = navigation_error(outcome)) {
      json["truth"]["navigation_error_last_m"] = number_json(error->last_m);
      json["truth"]["navigation_error_largest_m"] = number_json(error->largest_m);
    }
    json["truth"]["held"] = ordered_json::array();
    for (const HeldPoint& held : held_points(outcome)) {
      json["truth"]["held"].push_back(
          {{"point", held.point + 1}, {"largest_m", number_json(held.largest_m)}, {"rms_m", number_json(held.rms_m)}});
    }
  }
  json["corners"] = ordered_json::array();
  for (const CornerOverrun& corner : corner_overruns(outcome)) {
    json["corners"].push_back({{"point", corner.point + 1}, {"overrun_m", number_json(corner.overrun_m)}});
    if (corner.true_m) json["corners"].back()["true_overrun_m"] = number_json(*corner.true_m);
  }
  const ExecutorCounts& executor = outcome.executor;
  json["crew"] = {{"ticks", executor.ticks},
                  {"agents_lost", executor.lost},
                  {"messages_cut", executor.cut},
                  {"set_points_limited", executor.limited},
                  {"agents", ordered_json::array()}};
  for (const AgentReport& agent : outcome.crew) {
    ordered_json sent = ordered_json::array();
    for (const auto& [message, count] : agent.sent) sent.push_back({{"message", message}, {"count", count}});
    json["crew"]["agents"].push_back(
        {{"name", agent.name}, {"level", to_text(agent.level)}, {"sent", std::move(sent)}});
  }
  json["levels"] = ordered_json::array();
  for (const LevelOutcome& level : outcome.levels) {
    json["levels"].push_back({{"level", to_text(level.level)},
                              {"commands", level.commands},
                              {"without_parent", level.without_parent},
                              {"mean_interval_s", number_json(level.mean_interval_s)},
                              {"least_interval_s", number_json(level.least_interval_s)},
                              {"longest_interval_s", number_json(level.longest_interval_s)},
                              {"longest_stale_s", number_json(level.longest_stale_s)},
                              {"plans", level.plans},
                              {"changed_plans", level.changed_plans},
                              {"longest_replan_s", number_json(level.longest_replan_s)},
                              {"mean_horizon_s", number_json(level.mean_horizon_s)},
                              {"wanted_replan_s", number_json(level.timing.replan_s)},
                              {"wanted_horizon_s", number_json(level.timing.horizon_s)},
                              {"in_time", level.in_time()}});
  }
  for (const OperatorAnswer& answer : outcome.answers) {
    json["operator"].push_back(
        {{"time", to_text(answer.time)}, {"phase", to_text(answer.status.phase)}, {"text", answer.status.text}});
  }
  if (outcome.recorded) json["recorded"] = {{"decisions", *outcome.recorded}, {"the_same", outcome.as_recorded}};
  if (with_timings) {
    json["timings"] = {{"event_to_crew", stage_json(outcome.timings.event_to_agents)},
                       {"ping_to_grid", stage_json(outcome.timings.ping_to_grid)},
                       {"detection", stage_json(outcome.timings.detection)},
                       {"planning", stage_json(outcome.timings.planning)},
                       {"scan_to_decision", stage_json(outcome.timings.scan_to_decision)},
                       {"cycle_departure", stage_json(outcome.timings.cycle)}};
  }
  return json;
}

std::string mission_text(const MissionOutcome& outcome) { return dump(mission_json(outcome, false), 1) + "\n"; }

}  // namespace isobath
