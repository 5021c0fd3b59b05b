#include <algorithm>
#include <cmath>
#include <isobath/evaluation/evaluation.hpp>
#include <isobath/evaluation/group_score.hpp>
#include <isobath/run/group_run.hpp>

namespace isobath {
namespace {

GroupRunScore group_score(const GroupRecord& record) {
  const GroupScore score = score_of(record);
  GroupRunScore s;
  s.vehicles = static_cast<int>(record.vehicles.size());
  s.searched = score.searched;
  s.overlap = score.overlap;
  s.all_searched_s = score.all_searched_s.value_or(-1);
  if (std::isfinite(record.least_separation_m)) s.separation_m = record.least_separation_m;
  s.reassigned_s = score.reassigned_s.value_or(-1);
  for (std::size_t v = 0; v < record.vehicles.size(); ++v) {
    s.bit_rate = std::max(s.bit_rate, record.bit_rate(v));
    if (record.vehicles[v].lost_s) s.lost_s = *record.vehicles[v].lost_s;
  }
  return s;
}

/// What keeps the area from being searched; empty: nothing.
std::string failure_of(const GroupRecord& record, const GroupRunScore& s) {
  for (const GroupVehicleRecord& vehicle : record.vehicles) {
    if (vehicle.lost_s || vehicle.report.phase == MissionPhase::kFinished) continue;
    return vehicle.name + ": " + (vehicle.report.why.empty() ? to_text(vehicle.report.phase) : vehicle.report.why);
  }
  return s.all_searched_s < 0 ? "the area was not searched whole" : "";
}

void add_clearance(const LoopResult& vehicle, double scale, RunScore& s) {
  if (vehicle.contact_s >= 0 && (s.contact_s < 0 || vehicle.contact_s < s.contact_s)) {
    s.contact_s = vehicle.contact_s;
    s.contact_with = vehicle.contact_with;
  }
  if (std::isfinite(vehicle.min_clearance_m) &&
      (s.nearest_body.empty() || vehicle.min_clearance_m < s.min_clearance_m)) {
    s.min_clearance_m = vehicle.min_clearance_m;
    s.nearest_body = vehicle.nearest_body;
  }
  s.collision = s.collision || vehicle.contact_s >= 0 || vehicle.min_clearance_m < kCollision_m * scale;
  s.near_miss = s.near_miss || s.collision || vehicle.min_clearance_m < kNearMiss_m * scale;
  s.encounter = s.encounter || s.near_miss || vehicle.min_clearance_m < kEncounter_m * scale;
}

}  // namespace

ShownRun run_group_method(const ComparedMethod& method, const SuiteRun& run, RunScore& s) {
  LoopRequest request;
  request.configuration = method.configuration;
  request.configuration.simulation.seed = static_cast<int>(run.seed);
  request.configuration.simulation.duration_s = run.scenario.scene.about.duration_s;
  const GroupLoop group = loop_group(run.scenario, request);
  const double scale = vehicle_model_of(run.scenario.scene).length / kReferenceHull_m;
  ShownRun shown{{}, group.record};
  for (std::size_t v = 0; v < group.vehicles.size(); ++v) {
    const LoopResult& vehicle = group.vehicles[v];
    add_clearance(vehicle, scale, s);
    s.points_dropped += static_cast<int>(vehicle.report.dropped);
    s.path_m += vehicle.length_m;
    for (Decision decision : vehicle.decisions) {
      if (decision.agent == "safety officer" && decision.what != "over" && decision.what != "report")
        ++s.safety_actions;
      if (decision.what == "replan") ++s.replans;
      decision.agent = run.scenario.mission.group[v].name + ", " + decision.agent;
      shown.result.decisions.push_back(std::move(decision));
    }
  }
  std::ranges::stable_sort(shown.result.decisions, {}, &Decision::time);
  s.duration_s = group.record.duration_s;
  s.group = group_score(group.record);
  const std::string failure = failure_of(group.record, s.group);
  s.goal_reached = failure.empty();
  if (s.goal_reached) s.goal_s = s.duration_s;
  if (!s.goal_reached && !s.collision) s.refused = failure;
  return shown;
}

}  // namespace isobath
