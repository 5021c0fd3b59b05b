#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/evaluation/evaluation.hpp>
#include <isobath/run/group_run.hpp>
#include <isobath/scenario/group_record.hpp>

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
  if (!record.plan.passages.empty() && s.vehicles > 1) s.passage_shared_s = record.passage_shared_s;
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
    const bool says_why = vehicle.report.phase == MissionPhase::kAborted && !vehicle.report.why.empty();
    return vehicle.name + ": " + to_text(vehicle.report.phase) + (says_why ? ", " + vehicle.report.why : "");
  }
  return s.all_searched_s < 0 ? "the area was not searched whole" : "";
}

}  // namespace

ShownRun run_group_method(const ComparedMethod& method, const SuiteRun& run, RunScore& s) {
  LoopRequest request;
  request.configuration = method.configuration;
  request.configuration.simulation.seed = static_cast<int>(run.seed);
  request.configuration.simulation.duration_s = run.scenario.scene.about.duration_s;
  GroupLoop group = loop_group(run.scenario, request);
  const double scale = vehicle_model_of(run.scenario.scene).length / kReferenceHull_m;
  ShownRun shown;
  for (std::size_t v = 0; v < group.vehicles.size(); ++v) {
    const LoopResult& vehicle = group.vehicles[v];
    add_clearance(vehicle, scale, s);
    s.points_dropped += static_cast<int>(vehicle.report.dropped);
    s.path_m += vehicle.length_m;
    for (Decision decision : vehicle.decisions) {
      s.safety_actions += is_safety_action(decision);
      if (decision.what == "replan") ++s.replans;
      decision.agent = run.scenario.mission.group[v].name + ", " + decision.agent;
      shown.result.decisions.push_back(std::move(decision));
    }
  }
  std::ranges::stable_sort(shown.result.decisions, {}, &Decision::time);
  s.duration_s = group.record.duration_s;
  s.group = group_score(group.record);
  const std::string failure = failure_of(group.record, s.group);
  shown.group = std::move(group.record);
  s.goal_reached = failure.empty();
  if (s.goal_reached) s.goal_s = s.duration_s;
  if (!s.goal_reached && !s.collision) s.refused = failure;
  return shown;
}

GroupSummary summarise_groups(const std::vector<ScoredRun>& runs, std::size_t method) {
  GroupSummary s;
  std::vector<double> searched, overlap, unlost, all, separation, reassigned, shared, bits;
  std::size_t lost = 0;
  for (const ScoredRun& run : runs) {
    const GroupRunScore& g = run.scores[method].group;
    if (g.vehicles == 0) continue;
    ++s.runs;
    searched.push_back(g.searched);
    bits.push_back(g.bit_rate);
    if (g.all_searched_s >= 0) all.push_back(g.all_searched_s);
    if (g.vehicles > 1) overlap.push_back(g.overlap);
    if (g.vehicles > 1 && g.lost_s < 0) unlost.push_back(g.overlap);
    if (g.vehicles > 1) separation.push_back(g.separation_m);
    lost += g.lost_s >= 0;
    if (g.reassigned_s >= 0) reassigned.push_back(g.reassigned_s);
    if (g.passage_shared_s >= 0) shared.push_back(g.passage_shared_s);
  }
  s.reassigned = share(reassigned.size(), lost);
  s.searched = spread(searched);
  s.overlap = spread(overlap);
  s.overlap_unlost = spread(unlost);
  s.all_searched_s = spread(all);
  s.separation_m = spread(separation);
  s.reassigned_s = spread(reassigned);
  s.passage_shared_s = spread(shared);
  s.bit_rate = spread(bits);
  return s;
}

void add_broken_bars(const BarsConfig& bars, const GroupSummary& g, std::vector<std::string>& broken) {
  if (g.runs == 0) return;
  if (bars.searched_share >= 0 && g.searched.least < bars.searched_share) {
    broken.push_back(
        fmt::format("searched_share: {:.3f} in a run, at least {:g}", g.searched.least, bars.searched_share));
  }
  if (bars.overlap_share >= 0 && g.overlap_unlost.most > bars.overlap_share) {
    broken.push_back(
        fmt::format("overlap_share: {:.3f} in a run, at most {:g}", g.overlap_unlost.most, bars.overlap_share));
  }
  if (bars.separation_m >= 0 && g.separation_m.count > 0 && g.separation_m.least < bars.separation_m) {
    broken.push_back(fmt::format("separation_m: {:.2f} m, at least {:g}", g.separation_m.least, bars.separation_m));
  }
  if (bars.passage_shared_s >= 0 && g.passage_shared_s.count > 0 && g.passage_shared_s.most > bars.passage_shared_s) {
    broken.push_back(fmt::format("passage_shared_s: {:.1f} s in a run, at most {:g}", g.passage_shared_s.most,
                                 bars.passage_shared_s));
  }
  if (bars.bit_rate >= 0 && g.bit_rate.most > bars.bit_rate) {
    broken.push_back(fmt::format("bit_rate: {:.1f} bit/s, at most {:g}", g.bit_rate.most, bars.bit_rate));
  }
}

}  // namespace isobath
