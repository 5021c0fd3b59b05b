#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/runtime/mission_outcome.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using nlohmann::ordered_json;

/// Rounded to 1e-6, which is finer than any sonar and still readable; null if not finite.
ordered_json tidy(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e6) / 1e6;
}

ordered_json place_json(const Eigen::Vector2d& p) { return ordered_json::array({tidy(p.x()), tidy(p.y())}); }

ordered_json decision_content(const Decision& d) {
  ordered_json json{{"time_ns", d.time.time_since_epoch().count()},
                    {"time", to_text(d.time)},
                    {"agent", d.agent},
                    {"what", d.what},
                    {"reason", d.reason}};
  if (d.obstacle) json["obstacle_m"] = place_json(*d.obstacle);
  if (d.leg) json["leg"] = *d.leg;
  if (d.margin_m) json["margin_m"] = tidy(*d.margin_m);
  if (!d.way.empty()) {
    json["way_m"] = ordered_json::array();
    for (const Eigen::Vector2d& p : d.way) json["way_m"].push_back(place_json(p));
  }
  return json;
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
    points.push_back({{"name", p.name}, {"north_m", tidy(p.north_east.x())}, {"east_m", tidy(p.north_east.y())}});
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

std::string decision_json(const Decision& decision) { return dump(decision_content(decision), -1); }

std::string decisions_text(const std::vector<Decision>& decisions) {
  ordered_json json{{"frame", "world: north, east, metres, as estimated by the vehicle"},
                    {"decisions", ordered_json::array()}};
  for (const Decision& d : decisions) json["decisions"].push_back(decision_content(d));
  return dump(json, 1) + "\n";
}

ordered_json mission_json(const MissionOutcome& outcome, bool with_timings) {
  const MissionReport& report = outcome.report;
  ordered_json json{
      {"title", outcome.plan.title},           {"phase", to_text(report.phase)}, {"why", report.why},
      {"points", points_json(outcome.plan)},   {"reached", report.reached},      {"dropped", report.dropped},
      {"decisions", outcome.decisions.size()}, {"failure", outcome.failure()}};
  if (const auto& truth = outcome.truth) {
    json["truth"] = {{"contact", truth->contact_s >= 0},
                     {"contact_s", truth->contact_s >= 0 ? tidy(truth->contact_s) : ordered_json()},
                     {"contact_with", truth->contact_with},
                     {"least_clearance_m", tidy(truth->least_clearance_m)},
                     {"nearest_body", truth->nearest_body},
                     {"least_altitude_m", tidy(truth->least_altitude_m)},
                     {"path_m", tidy(truth->length_m)}};
  }
  const ExecutorCounts& executor = outcome.executor;
  json["crew"] = {{"ticks", executor.ticks},
                  {"agents_lost", executor.lost},
                  {"messages_cut", executor.cut},
                  {"set_points_limited", executor.limited}};
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
                       {"scan_to_decision", stage_json(outcome.timings.scan_to_decision)}};
  }
  return json;
}

std::string mission_text(const MissionOutcome& outcome) { return dump(mission_json(outcome, false), 1) + "\n"; }

}  // namespace isobath
