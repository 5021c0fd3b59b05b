#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/evaluation/evaluation_report.hpp>
#include <isobath/report/group_outcome.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/picture.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using nlohmann::ordered_json;

constexpr int kPixels = 560;
constexpr std::array<Colour, 5> kColours{
    {{0.0, 0.45, 0.7, 1}, {0.84, 0.37, 0.0, 1}, {0.8, 0.47, 0.65, 1}, {0.9, 0.62, 0.0, 1}, {0.34, 0.34, 0.34, 1}}};

ordered_json json_of(const Spread& s) {
  if (s.count == 0) return nullptr;
  return {{"count", s.count},   {"least", s.least}, {"low", s.low},
          {"median", s.median}, {"high", s.high},   {"most", s.most}};
}

ordered_json middle_of(const Spread& s) { return s.count == 0 ? ordered_json(nullptr) : ordered_json(s.median); }

ordered_json json_of(const Share& s) {
  return {{"count", s.count}, {"of", s.of}, {"share", s.value()}, {"low", s.low}, {"high", s.high}};
}

ordered_json json_of(const std::vector<RowSummary>& rows) {
  ordered_json all = ordered_json::object();
  for (const RowSummary& row : rows) {
    all[row.name] = {{"runs", row.shown.of},
                     {"shown", row.shown.count},
                     {"latest_s", row.latest_s < 0 ? ordered_json(nullptr) : ordered_json(row.latest_s)},
                     {"failures", row.failures}};
  }
  return all;
}

/// The story: how often each stage was shown, and how long after the one before.
ordered_json story_json(const Summary& s) {
  ordered_json stages = ordered_json::array(), failures = ordered_json::object();
  for (const StageSummary& stage : s.stages) {
    stages.push_back({{"name", stage.name},
                      {"shown", json_of(stage.shown)},
                      {"after_s", json_of(stage.after_s)},
                      {"scans", json_of(stage.scans)}});
  }
  for (const auto& [why, count] : s.story_failures) failures[why] = count;
  return {{"shown", json_of(s.story)},
          {"stages", std::move(stages)},
          {"clearance_of_injected_m", json_of(s.injected_m)},
          {"failures", std::move(failures)}};
}

ordered_json group_json(const GroupSummary& g) {
  return {{"searched", json_of(g.searched)},
          {"overlap", json_of(g.overlap)},
          {"all_searched_s", json_of(g.all_searched_s)},
          {"separation_m", json_of(g.separation_m)},
          {"reassigned", json_of(g.reassigned)},
          {"reassigned_s", json_of(g.reassigned_s)},
          {"passage_shared_s", json_of(g.passage_shared_s)},
          {"bit_rate", json_of(g.bit_rate)}};
}

ordered_json json_of(const Summary& s) {
  ordered_json reasons = ordered_json::object();
  for (const auto& [why, count] : s.reasons) reasons[why] = count;
  return {{"runs", s.collisions.of},
          {"collisions", s.collisions.count},
          {"near_misses", s.near_misses.count},
          {"encounters", s.encounters.count},
          {"goals_reached", s.goals.count},
          {"refused", s.refused.count},
          {"refused_where_no_way", s.no_way_there},
          {"lost", s.lost.count},
          {"path_ratio_median", middle_of(s.path_ratio)},
          {"time_ratio_median", middle_of(s.time_ratio)},
          {"least_clearance_m_median", middle_of(s.clearance_m)},
          {"detection_delay_pings_median", middle_of(s.delay_pings)},
          {"first_range_m_median", middle_of(s.first_range_m)},
          {"range_error_m_median", middle_of(s.range_error_m)},
          {"false_obstacles_a_scan", s.false_obstacles},
          {"false_obstacles_20m_a_scan", s.near_false_obstacles},
          {"false_obstacles_unseen_a_scan", s.unseen_false_obstacles},
          {"points_dropped", s.points_dropped},
          {"bodies_missed", s.bodies_missed},
          {"replans", s.replans},
          {"false_replans", s.false_replans},
          {"safety_actions", s.safety_actions},
          {"shares",
           {{"collisions", json_of(s.collisions)},
            {"near_misses", json_of(s.near_misses)},
            {"encounters", json_of(s.encounters)},
            {"goals_reached", json_of(s.goals)},
            {"goals_without_collision", json_of(s.safe_goals)},
            {"refused", json_of(s.refused)},
            {"openings_known", json_of(s.openings_known)},
            {"moving_known", json_of(s.moving_known)},
            {"passed_astern", json_of(s.passed_astern)},
            {"passed_port_to_port", json_of(s.passed_port_to_port)},
            {"stood_on", json_of(s.stood_on)}}},
          {"spreads",
           {{"path_ratio", json_of(s.path_ratio)},
            {"time_ratio", json_of(s.time_ratio)},
            {"least_clearance_m", json_of(s.clearance_m)},
            {"detection_delay_pings", json_of(s.delay_pings)},
            {"first_range_m", json_of(s.first_range_m)},
            {"range_error_m", json_of(s.range_error_m)},
            {"moving_known_s", json_of(s.moving_known_s)},
            {"ospa_m", json_of(s.ospa_m)},
            {"velocity_rms", json_of(s.velocity_rms)},
            {"opening_known_m", json_of(s.opening_known_m)},
            {"opening_share", json_of(s.opening_share)}}},
          {"group", s.group.runs > 0 ? group_json(s.group) : ordered_json(nullptr)},
          {"reasons", reasons}};
}

/// Share of the runs up to each value.
std::string distribution_chart(const EvaluationRequest& request, const Evaluation& evaluation, const std::string& title,
                               const std::string& label, double low, double high,
                               const std::function<double(const RunScore&)>& value) {
  ChartPicture chart(kPixels, 380, title, {label, low, high}, {"share of runs up to this value", 0, 1});
  for (std::size_t c = 0; c < request.methods.size(); ++c) {
    std::vector<double> sample;
    for (const ScoredRun& run : evaluation.runs) {
      const double v = value(run.scores[c]);
      if (v >= 0) sample.push_back(std::clamp(v, low, high));
    }
    std::sort(sample.begin(), sample.end());
    std::vector<double> x{low}, y{0};
    for (std::size_t i = 0; i < sample.size(); ++i) {
      x.insert(x.end(), {sample[i], sample[i]});
      y.insert(y.end(), {y.back(), static_cast<double>(i + 1) / static_cast<double>(evaluation.runs.size())});
    }
    x.push_back(high);
    y.push_back(y.back());
    chart.curve(x, y, {kColours[c % kColours.size()], c == 0 ? 2.5 : 1.5, c != 0}, request.methods[c].name);
  }
  chart.finish();
  return chart.png();
}

std::string verdict(const RunScore& s) {
  std::string text;
  if (s.contact_s >= 0) {
    text = fmt::format("touched {} after {:.1f} s", s.contact_with, s.contact_s);
  } else if (s.collision) {
    text = fmt::format("came within {:.2f} m of {}", s.min_clearance_m, s.nearest_body);
  } else if (!s.proof.failure.empty()) {
    text = s.proof.fault + ": " + s.proof.failure;
  } else if (!s.story.failure.empty()) {
    text = "the story fails: " + s.story.failure;
  } else if (s.group.vehicles > 0) {
    text = fmt::format("searched {:.1f} % of the area, and {:.1f} % of it twice", 100 * s.group.searched,
                       100 * s.group.overlap);
    if (!s.refused.empty()) text += "; " + s.refused;
  } else if (s.goal_reached) {
    text = s.path_ratio > 0 ? fmt::format("reached the goal on {:.2f} times the shortest path", s.path_ratio)
                            : "reached the goal";
  } else if (!s.refused.empty()) {
    text = "refused: " + s.refused;
  } else {
    text = fmt::format("never came nearer to the goal than {:.1f} m", s.goal_distance_m);
  }
  if (!s.nearest_body.empty())
    text += fmt::format("; minimum clearance {:.2f} m, to {}", s.min_clearance_m, s.nearest_body);
  return text;
}

/// Which variant and which recording it needs.
std::string options_of(const EvaluationRequest& request, const ScoredRun& run) {
  const std::string variant = run.variant.empty() ? "" : " --variant " + run.variant;
  return variant + (request.suite.replay.on ? " --replay " + request.suite.replay.file : "");
}

std::string how_to_run_again(const EvaluationRequest& request, const ScoredRun& run) {
  return fmt::format("isobath eval {} --runs 1 --seed {}{}", request.suite.name, run.seed, options_of(request, run));
}

/// The command that runs it with all its maps and shows it on the live page.
std::string how_to_watch(const EvaluationRequest& request, const ScoredRun& run) {
  return fmt::format("isobath serve --suite {}{} --set simulation.seed={}", request.suite.name,
                     options_of(request, run), run.seed);
}

/// Distributions of the runs.
void show_distributions(const EvaluationRequest& request, const Evaluation& evaluation, HtmlReport& page) {
  page.begin_row();
  page.figure(distribution_chart(
                  request, evaluation, "Minimum clearance", "m from the hull", 0, 15,
                  [](const RunScore& s) { return s.nearest_body.empty() ? -1 : std::max(0.0, s.min_clearance_m); }),
              "Minimum distance from the hull to a body in each run. Further to the right is safer.");
  if (evaluation.summaries.front().group.runs == 0) {
    page.figure(distribution_chart(request, evaluation, "Path length", "times the shortest", 0.9, 2,
                                   [](const RunScore& s) { return s.path_ratio; }),
                "Only runs that reached the goal; the height at the right end is their share.");
    page.end_row();
    return;
  }
  page.figure(distribution_chart(request, evaluation, "Area searched", "share of the area", 0.8, 1,
                                 [](const RunScore& s) { return s.group.searched; }),
              "Share of the area that some vehicle passed within 0.55 lane breadths. Further to the right is better.");
  page.figure(distribution_chart(request, evaluation, "Searched twice or more", "share of the area", 0, 0.3,
                                 [](const RunScore& s) { return s.group.vehicles > 1 ? s.group.overlap : -1; }),
              "Share of the area that two or more vehicles searched; only runs of several vehicles.");
  page.end_row();
}

/// What the figures of the tables mean.
std::string meaning_of_figures(const Evaluation& evaluation) {
  const std::string intervals =
      "Shares of runs have their 95 % intervals (Wilson); other values are the median with the 5 and 95 % quantiles of "
      "the runs. ";
  const std::string clearances = fmt::format(
      "For a hull of {:g} m, a clearance below {:g} m is a collision, below {:g} m a near miss and below {:g} m an "
      "encounter; other hulls in proportion. ",
      kReferenceHull_m, kCollision_m, kNearMiss_m, kEncounter_m);
  if (evaluation.summaries.front().group.runs > 0) {
    return intervals + clearances +
           "A place counts as searched by a vehicle that truly passed within 0.55 lane breadths of it. The last lane "
           "is "
           "done when the first vehicle knows that all are.";
  }
  return intervals + clearances +
         fmt::format(
             "The path ratio is the path length over that of the route planner with every outline known, at the same "
             "clearance. False obstacles have an existence probability of at least {:g}, and neither a body nor a "
             "bottom that the vehicle must avoid is there.",
             kSureObstacle);
}

/// The conditions that were drawn, and the variant.
std::string conditions_of(const ScoredRun& run) {
  return run.variant.empty() ? run.conditions : run.variant + "; " + run.conditions;
}

ShownRun run_again(const EvaluationRequest& request, const SuiteRun& run) {
  RunScore ignored;
  if (run.scenario.mission.search.on()) return run_group_method(request.methods.front(), run, ignored);
  return {run_method(request.methods.front(), run, RunTruth(request.suite, run).vehicle()), std::nullopt};
}

PlanExtent around(const RunTruth& truth, const SuiteRun& run, const LoopResult& result) {
  Eigen::AlignedBox2d box;
  for (const TrueMotion& m : result.track) box.extend(Vector2d(m.state.X_WB.translation.head<2>()));
  for (const MissionPoint& p : run.scenario.mission.points) box.extend(p.north_east);
  for (const Vector2d& p : truth.way()) box.extend(p);
  const Vector2d c = box.center();
  box.extend(Vector2d(c.array() - 5)).extend(Vector2d(c.array() + 5));
  return frame_around(box);
}

}  // namespace

std::string to_json(const EvaluationRequest& request, const Evaluation& evaluation) {
  ordered_json json = {{"suite", request.suite.name}, {"title", request.suite.about.title}};
  json["first_seed"] = evaluation.runs.empty() ? 0 : evaluation.runs.front().seed;
  const Summary& ours = evaluation.summaries.front();
  json.update(json_of(ours));
  if (!ours.rows.empty()) json["faults"] = {{"shown", json_of(ours.shown)}, {"rows", json_of(ours.rows)}};
  if (!ours.stages.empty()) json["story"] = story_json(ours);
  if (!evaluation.variants.empty()) {
    ordered_json& variants = json["variants"] = ordered_json::object();
    for (const Summary& s : evaluation.variants) variants[s.name] = json_of(s);
  }
  json["broken_bars"] = evaluation.broken;
  ordered_json& baselines = json["baselines"] = ordered_json::object();
  for (std::size_t i = 1; i < evaluation.summaries.size(); ++i) {
    baselines[evaluation.summaries[i].name] = json_of(evaluation.summaries[i]);
  }
  ordered_json& worst = json["worst"] = ordered_json::array();
  for (const std::size_t i : worst_runs(evaluation.runs, kWorstRuns)) {
    const ScoredRun& run = evaluation.runs[i];
    worst.push_back({{"seed", run.seed},
                     {"variant", run.variant},
                     {"what", verdict(run.scores.front())},
                     {"conditions", run.conditions},
                     {"again", how_to_run_again(request, run)},
                     {"watch", how_to_watch(request, run)}});
  }
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string run_picture(const SuiteRun& run, const RunTruth& truth, const LoopResult& result,
                        const std::string& title) {
  PlanPicture picture(around(truth, run, result), kPixels, {title, "north (m)", "east (m)"});
  for (const Hazard& h : truth.outlines())
    picture.polygon(h.outline, {palette::kInk, 1.5, false}, {0.3, 0.25, 0.2, 0.6});
  std::vector<Vector2d> mission{run.scenario.scene.vehicle.start.head<2>()};
  for (const MissionPoint& p : run.scenario.mission.points) mission.push_back(p.north_east);
  picture.polyline(mission, {palette::kFaint, 1, true});
  if (!truth.way().empty()) picture.polyline(truth.way(), {palette::kTruth, 1.5, true});
  std::vector<Vector2d> track;
  for (const TrueMotion& m : result.track) track.emplace_back(m.state.X_WB.translation.head<2>());
  if (track.size() > 1) picture.polyline(track, {palette::kTrack, 2, false});
  for (const Decision& d : result.decisions) {
    if (d.obstacle) picture.dot(*d.obstacle, 3, palette::kObstacle);
  }
  for (std::size_t i = 1; i < mission.size(); ++i) picture.dot(mission[i], 3, palette::kInk);
  picture.vehicle(mission.front(), run.scenario.scene.vehicle.heading.radians());
  if (!result.track.empty()) {
    const Pose& X_WB = result.track.back().state.X_WB;
    picture.vehicle(X_WB.translation.head<2>(), X_WB.rotation.heading().radians());
  }
  picture.finish({{palette::kInk, "bodies"},
                  {palette::kTrack, "vehicle track"},
                  {palette::kTruth, "shortest path, all known"},
                  {palette::kObstacle, "obstacles of its decisions"}});
  return picture.png();
}

void write_evaluation(const EvaluationRequest& request, const Evaluation& evaluation) {
  write_whole_file(request.out / "results.json", to_json(request, evaluation));
  const ComparedMethod& ours = request.methods.front();
  HtmlReport page("Isobath: " + request.suite.about.title, request.suite.about.text);
  for (const std::string& bar : evaluation.broken) page.warning("Bar missed: " + bar + ".");
  page.heading("Results");
  const auto table = evaluation_table(evaluation);
  page.table(table.front(), {table.begin() + 1, table.end()});
  page.paragraph(meaning_of_figures(evaluation));
  for (const std::string& line : comparison_lines(evaluation)) page.paragraph(ours.name + " " + line + ".");
  for (const Summary& s : evaluation.summaries) {
    for (const auto& [why, count] : s.reasons)
      page.paragraph(fmt::format("{} refused {} times: {}", s.name, count, why));
  }
  if (const auto variants = variant_table(evaluation); !variants.empty()) {
    page.heading("Variants");
    page.table(variants.front(), {variants.begin() + 1, variants.end()});
    if (evaluation.summaries.front().group.runs == 0) {
      page.paragraph("All of " + ours.name +
                     ". Path ratio and clearance are medians; false obstacles are means over all scans.");
    }
  }
  page.heading("Distributions");
  show_distributions(request, evaluation, page);
  page.heading("The worst runs");
  const std::vector<Scenario> scenes = load_scenes(request.suite);
  for (const std::size_t i : worst_runs(evaluation.runs, kWorstRuns)) {
    const ScoredRun& scored = evaluation.runs[i];
    const SuiteRun run = make_run(request.suite, scenes, scored.seed);
    const auto done = evaluation.worst.find(scored.seed);
    const auto [result, group] = done != evaluation.worst.end() ? done->second : run_again(request, run);
    const std::string title = fmt::format("seed {}", scored.seed);
    page.figure(group ? draw_group(*group, title) : run_picture(run, RunTruth(request.suite, run), result, title),
                fmt::format("{}. To repeat it: {}. To watch it: {}", conditions_of(scored),
                            how_to_run_again(request, scored), how_to_watch(request, scored)));
    page.paragraph(fmt::format("Seed {}: {}.", scored.seed, verdict(scored.scores.front())));
    std::string decisions;
    for (const Decision& d : result.decisions) {
      decisions +=
          fmt::format("{:>3}  {:7.2f} s  {}: {}: {}\n", d.number, to_seconds(d.time), d.agent, d.what, d.reason);
    }
    page.folded("Decisions", decisions);
  }
  page.folded("Configuration in force", to_toml(ours.configuration, true));
  write_whole_file(request.out / "report.html", page.html());
}

}  // namespace isobath
