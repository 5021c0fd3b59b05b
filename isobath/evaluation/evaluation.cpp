#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/evaluation/baseline_helms.hpp>
#include <isobath/evaluation/evaluation.hpp>
#include <isobath/evaluation/run_store.hpp>
#include <isobath/report/html_report.hpp>
#include <mutex>
#include <thread>

namespace isobath {
namespace {

constexpr double kNormal95 = 1.959964;

/// FNV-1a, 64 bits.
std::string fingerprint_of_request(const EvaluationRequest& request) {
  std::string all = fmt::format("{}|{:016x}", request.version, request.suite.digest);
  for (const ComparedMethod& method : request.methods) {
    const Configuration& configuration = method.configuration;
    all += "|" + method.name + "|" + to_toml(configuration, false);
    const SensorConfig& sensor = configuration.sensor;
    for (const std::string* file : {&sensor.model, &sensor.histogram, &sensor.histogram_vertical}) {
      if (!file->empty()) all += text_of_file(*file, 1024);
    }
  }
  std::uint64_t digest = 0xcbf29ce484222325u;
  for (const char c : all) digest = (digest ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return fmt::format("{:016x}", digest);
}

std::vector<Polygon> outlines_in(const RunTruth& truth) {
  std::vector<Polygon> outlines;
  for (const Hazard& hazard : truth.outlines()) outlines.push_back(hazard.outline);
  return outlines;
}

/// `first`: the result of the first method.
ScoredRun run_all(const EvaluationRequest& request, std::span<const Scenario> scenes, std::uint64_t seed,
                  ShownRun& first) {
  const SuiteRun run = make_run(request.suite, scenes, seed);
  if (run.scenario.mission.search.on()) {
    ScoredRun scored{seed, run.variant, run.conditions, 0, {}, {RunScore{}}};
    first = run_group_method(request.methods.front(), run, scored.scores.front());
    return scored;
  }
  const RunTruth truth(request.suite, run);
  ScoredRun scored{seed, run.variant, run.conditions, truth.way_m(), truth.no_way(), {}};
  for (const ComparedMethod& method : request.methods) {
    StoryLog log;
    LoopResult result = run_method(method, run, truth.vehicle(), request.suite.stages.empty() ? nullptr : &log);
    scored.scores.push_back(score(result, run.scenario.mission, truth, request.suite.about));
    if (run.row) {
      scored.scores.back().proof = prove(*run.row, run.scenario, method.configuration.safety, result);
    }
    if (!run.encounters.empty()) {
      const std::span<const Body> bodies = run.scenario.scene.bodies;
      scored.scores.back().rules = rules_score(result.track, bodies.last(run.encounters.size()), run.encounters);
    }
    if (!request.suite.stages.empty()) {
      scored.scores.back().story = follow_story(request.suite.stages, run.scenario, outlines_in(truth), log, result);
    }
    if (&method == &request.methods.front()) first.result = std::move(result);
  }
  return scored;
}

void keep_worst(const std::map<std::uint64_t, ScoredRun>& runs, std::map<std::uint64_t, ShownRun>& results) {
  std::vector<ScoredRun> of_results;
  for (const auto& [seed, result] : results) of_results.push_back(runs.at(seed));
  std::map<std::uint64_t, ShownRun> worst;
  for (const std::size_t i : worst_runs(of_results, kWorstRuns)) {
    worst.insert(results.extract(of_results[i].seed));
  }
  results = std::move(worst);
}

/// Runs the missing seeds, on all threads.
void run_missing(const EvaluationRequest& request, const std::vector<std::uint64_t>& seeds, RunStore& store, int done,
                 std::map<std::uint64_t, ShownRun>& worst) {
  const std::vector<Scenario> scenes = load_scenes(request.suite);
  std::atomic<std::size_t> next{0};
  std::mutex lock;
  std::exception_ptr failure;
  const int all = done + static_cast<int>(seeds.size());
  const auto work = [&] {
    for (std::size_t i = next++; i < seeds.size(); i = next++) {
      try {
        ShownRun first;
        const ScoredRun run = run_all(request, scenes, seeds[i], first);
        const std::lock_guard<std::mutex> held(lock);
        store.add(run);
        worst.emplace(seeds[i], std::move(first));
        keep_worst(store.runs(), worst);
        if (request.progress) request.progress(++done, all);
      } catch (...) {
        const std::lock_guard<std::mutex> held(lock);
        if (!failure) failure = std::current_exception();
        next = seeds.size();
      }
    }
  };
  std::vector<std::thread> threads;
  const auto most = std::min<std::size_t>(static_cast<std::size_t>(std::max(1, request.threads)), seeds.size());
  for (std::size_t i = 1; i < most; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

/// Reasons of one kind differ only in their numbers.
std::string without_numbers(const std::string& reason) {
  std::string kind;
  for (const char c : reason) {
    const bool digit = (c >= '0' && c <= '9') || (c == '.' && !kind.empty() && kind.back() == '#');
    if (!digit) kind += c;
    if (digit && (kind.empty() || kind.back() != '#')) kind += '#';
  }
  return kind;
}

double badness(const RunScore& s) {
  if (s.contact_s >= 0) return 5;
  if (s.collision) return 4;
  if (!s.proof.failure.empty()) return 3.5;
  if (!s.story.failure.empty()) return 3.2;
  if (!s.goal_reached && s.refused.empty()) return 3;
  if (!s.goal_reached) return 2;
  if (s.group.vehicles > 0) return 1 + s.group.overlap - s.group.searched;
  return std::min(0.5 * s.path_ratio, 1.9);
}

void sum_up_rows(const std::vector<ScoredRun>& runs, std::size_t method, Summary& s) {
  const bool any =
      std::any_of(runs.begin(), runs.end(), [&](const ScoredRun& r) { return !r.scores[method].proof.fault.empty(); });
  if (!any) return;
  std::size_t shown = 0, all = 0;
  for (const FaultRow& row : fault_table()) {
    RowSummary& sum = s.rows.emplace_back();
    sum.name = row.name;
    std::size_t own = 0;
    for (const ScoredRun& run : runs) {
      const FaultInjectionCheck& proof = run.scores[method].proof;
      if (proof.fault != row.name) continue;
      ++own;
      sum.latest_s = std::max(sum.latest_s, proof.after_s);
      if (!proof.failure.empty()) sum.failures.push_back(fmt::format("seed {}: {}", run.seed, proof.failure));
    }
    sum.shown = share(own - sum.failures.size(), own);
    shown += sum.shown.count;
    all += own;
  }
  s.shown = share(shown, all);
}

void sum_up_rules(const std::vector<ScoredRun>& runs, std::size_t method, Summary& s) {
  const auto shown = [&](int RulesScore::*count, int RulesScore::*of) {
    std::size_t counts = 0, all = 0;
    for (const ScoredRun& run : runs) {
      counts += static_cast<std::size_t>(run.scores[method].rules.*count);
      all += static_cast<std::size_t>(run.scores[method].rules.*of);
    }
    return share(counts, all);
  };
  s.passed_astern = shown(&RulesScore::passed_astern, &RulesScore::give_way);
  s.passed_port_to_port = shown(&RulesScore::passed_port_to_port, &RulesScore::head_on);
  s.stood_on = shown(&RulesScore::stood_on, &RulesScore::stand_on);
}

void sum_up_story(const std::vector<ScoredRun>& runs, std::size_t method, const std::vector<StoryStage>& stages,
                  Summary& s) {
  if (stages.empty()) return;
  std::size_t whole = 0;
  std::vector<double> injected;
  for (const ScoredRun& run : runs) {
    const RunScore& r = run.scores[method];
    whole += r.story.all(stages.size()) && r.goal_reached && !r.collision;
    if (r.story.min_injected_m >= 0) injected.push_back(r.story.min_injected_m);
    if (!r.story.failure.empty()) ++s.story_failures[without_numbers(r.story.failure)];
  }
  s.story = share(whole, runs.size());
  s.injected_m = spread(injected);
  for (std::size_t i = 0; i < stages.size(); ++i) {
    std::vector<double> after_s, scans;
    for (const ScoredRun& run : runs) {
      const StoryCheck& story = run.scores[method].story;
      if (story.after_s.size() <= i) continue;
      after_s.push_back(story.after_s[i]);
      scans.push_back(story.scans[i]);
    }
    s.stages.push_back({stages[i].name, share(after_s.size(), runs.size()), spread(after_s), spread(scans)});
  }
}

}  // namespace

// Statistics ---------------------------------------------------------------------------------------------------------

Share share(std::size_t count, std::size_t of) {
  Share s{count, of, 0, 1};
  if (of == 0) return s;
  const auto n = static_cast<double>(of);
  const double p = static_cast<double>(count) / n, z2 = kNormal95 * kNormal95;
  const double middle = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kNormal95 / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  s.low = count == 0 ? 0 : std::max(0.0, middle - half);
  s.high = count == of ? 1 : std::min(1.0, middle + half);
  return s;
}

ShareDifference difference(const Share& a, const Share& b) {
  const double value = a.value() - b.value();
  return {value, value - std::hypot(a.value() - a.low, b.high - b.value()),
          value + std::hypot(a.high - a.value(), b.value() - b.low)};
}

double quantile(std::vector<double> sample, double p) {
  ISOBATH_ASSERT(!sample.empty());
  std::sort(sample.begin(), sample.end());
  const double at = p * static_cast<double>(sample.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sample.size() - 1);
  return sample[below] + (at - static_cast<double>(below)) * (sample[above] - sample[below]);
}

Spread spread(const std::vector<double>& sample) {
  if (sample.empty()) return {};
  return {sample.size(),         quantile(sample, 0),    quantile(sample, 0.05),
          quantile(sample, 0.5), quantile(sample, 0.95), quantile(sample, 1)};
}

Summary summarise(const std::string& name, const std::vector<ScoredRun>& runs, std::size_t method,
                  const std::vector<StoryStage>& stages) {
  Summary s;
  s.name = name;
  std::vector<double> path, time, clearance, delay, range, error, opening, known, moving_s, ospa, velocity;
  double scans = 0;
  std::size_t moving = 0, moving_known = 0;
  const auto count = [&](const auto& of) {
    return share(static_cast<std::size_t>(
                     std::count_if(runs.begin(), runs.end(), [&](const ScoredRun& r) { return of(r.scores[method]); })),
                 runs.size());
  };
  s.collisions = count([](const RunScore& r) { return r.collision; });
  s.near_misses = count([](const RunScore& r) { return r.near_miss; });
  s.encounters = count([](const RunScore& r) { return r.encounter; });
  s.goals = count([](const RunScore& r) { return r.goal_reached; });
  s.safe_goals = count([](const RunScore& r) { return r.goal_reached && !r.collision; });
  s.refused = count([](const RunScore& r) { return !r.refused.empty(); });
  s.lost = count([](const RunScore& r) { return !r.goal_reached && r.refused.empty() && !r.collision; });
  for (const ScoredRun& run : runs) {
    const RunScore& r = run.scores[method];
    if (r.path_ratio > 0) path.push_back(r.path_ratio);
    if (r.time_ratio > 0) time.push_back(r.time_ratio);
    if (!r.nearest_body.empty()) clearance.push_back(std::max(0.0, r.min_clearance_m));
    delay.insert(delay.end(), r.delay_pings.begin(), r.delay_pings.end());
    range.insert(range.end(), r.first_range_m.begin(), r.first_range_m.end());
    error.insert(error.end(), r.range_error_m.begin(), r.range_error_m.end());
    if (r.opening_known_m >= 0) opening.push_back(r.opening_known_m);
    if (r.opening_share >= 0) known.push_back(r.opening_share);
    moving += static_cast<std::size_t>(r.moving_bodies);
    moving_known += static_cast<std::size_t>(r.moving_known);
    if (r.moving_known_s >= 0) moving_s.push_back(r.moving_known_s);
    if (r.ospa_m >= 0) ospa.push_back(r.ospa_m);
    if (r.velocity_rms >= 0) velocity.push_back(r.velocity_rms);
    s.points_dropped += r.points_dropped;
    s.bodies_missed += r.bodies_missed;
    s.replans += r.replans;
    s.false_replans += r.false_replans;
    s.safety_actions += r.safety_actions;
    scans += r.scans;
    s.false_obstacles += r.false_obstacles;
    s.near_false_obstacles += r.near_false_obstacles;
    s.unseen_false_obstacles += r.unseen_false_obstacles;
    if (r.refused.empty()) continue;
    ++s.reasons[without_numbers(r.refused)];
    s.no_way_there += !run.no_way.empty();
  }
  s.false_obstacles /= std::max(scans, 1.0);
  s.near_false_obstacles /= std::max(scans, 1.0);
  s.unseen_false_obstacles /= std::max(scans, 1.0);
  s.path_ratio = spread(path);
  s.time_ratio = spread(time);
  s.clearance_m = spread(clearance);
  s.delay_pings = spread(delay);
  s.first_range_m = spread(range);
  s.range_error_m = spread(error);
  s.moving_known = share(moving_known, moving);
  s.moving_known_s = spread(moving_s);
  s.ospa_m = spread(ospa);
  s.velocity_rms = spread(velocity);
  s.openings_known = share(opening.size(), known.size());
  s.opening_known_m = spread(opening);
  s.opening_share = spread(known);
  sum_up_rules(runs, method, s);
  sum_up_rows(runs, method, s);
  sum_up_story(runs, method, stages, s);
  s.group = summarise_groups(runs, method);
  return s;
}

std::vector<Summary> summarise_variants(const std::vector<SuiteVariant>& variants, const std::vector<ScoredRun>& runs) {
  std::vector<Summary> summaries;
  for (const SuiteVariant& variant : variants) {
    std::vector<ScoredRun> own;
    std::copy_if(runs.begin(), runs.end(), std::back_inserter(own),
                 [&variant](const ScoredRun& run) { return run.variant == variant.name; });
    if (!own.empty()) summaries.push_back(summarise(variant.name, own, 0));
  }
  return summaries;
}

std::vector<std::string> broken_bars(const BarsConfig& bars, const Summary& s) {
  std::vector<std::string> broken;
  if (bars.collisions >= 0 && s.collisions.count > static_cast<std::size_t>(bars.collisions)) {
    broken.push_back(fmt::format("collisions: {}, at most {}", s.collisions.count, bars.collisions));
  }
  if (bars.goals_share >= 0 && s.goals.value() < bars.goals_share) {
    broken.push_back(fmt::format("goals_share: {:.3f}, at least {:g}", s.goals.value(), bars.goals_share));
  }
  if (bars.refused_share >= 0 && s.refused.value() > bars.refused_share) {
    broken.push_back(fmt::format("refused_share: {:.3f}, at most {:g}", s.refused.value(), bars.refused_share));
  }
  if (bars.path_ratio_median >= 0 && s.path_ratio.count == 0) {
    broken.push_back(fmt::format("path_ratio_median: no run to compare, at most {:g}", bars.path_ratio_median));
  } else if (bars.path_ratio_median >= 0 && s.path_ratio.median > bars.path_ratio_median) {
    broken.push_back(
        fmt::format("path_ratio_median: {:.3f}, at most {:g}", s.path_ratio.median, bars.path_ratio_median));
  }
  if (bars.false_obstacles_20m >= 0 && s.near_false_obstacles > bars.false_obstacles_20m) {
    broken.push_back(fmt::format("false_obstacles_20m: {:.3f} a scan, at most {:g}", s.near_false_obstacles,
                                 bars.false_obstacles_20m));
  }
  if (bars.shown_share >= 0 && s.shown.value() < bars.shown_share) {
    broken.push_back(fmt::format("shown_share: {:.3f}, at least {:g}", s.shown.value(), bars.shown_share));
    for (const RowSummary& row : s.rows) {
      if (!row.failures.empty()) broken.back() += fmt::format("; {}: {}", row.name, fmt::join(row.failures, ", "));
    }
  }
  if (bars.story_share >= 0 && s.story.value() < bars.story_share) {
    broken.push_back(fmt::format("story_share: {:.3f}, at least {:g}", s.story.value(), bars.story_share));
    for (const auto& [why, count] : s.story_failures) broken.back() += fmt::format("; {} times {}", count, why);
  }
  add_broken_bars(bars, s.group, broken);
  return broken;
}

std::vector<std::size_t> worst_runs(const std::vector<ScoredRun>& runs, std::size_t most) {
  std::vector<std::size_t> order(runs.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&runs](std::size_t a, std::size_t b) {
    return badness(runs[a].scores.front()) > badness(runs[b].scores.front());
  });
  order.resize(std::min(order.size(), most));
  return order;
}

// Running ------------------------------------------------------------------------------------------------------------

LoopResult run_method(const ComparedMethod& method, const SuiteRun& run, const VehicleParameters& vehicle,
                      OnboardObserver* observer) {
  LoopRequest request;
  request.configuration = run.row ? proving(*run.row, method.configuration) : method.configuration;
  request.configuration.simulation.seed = static_cast<int>(run.seed);
  request.configuration.simulation.duration_s = run.scenario.scene.about.duration_s;
  request.stop_at_contact = true;
  request.judge = true;
  if (observer) request.observers.push_back(observer);
  const std::unique_ptr<Helm> helm = method.make(run.scenario, vehicle, method.configuration);
  return run_closed_loop(run.scenario, *helm, request);
}

Evaluation evaluate(const EvaluationRequest& request) {
  ISOBATH_ASSERT(!request.methods.empty());
  const int first = request.seed >= 0 ? request.seed : request.suite.about.seed;
  const int wanted = request.runs > 0 ? request.runs : request.suite.about.runs;
  make_folder(request.out);
  RunStore store(request.out / "runs.jsonl", fingerprint_of_request(request));
  Evaluation evaluation;
  std::vector<std::uint64_t> missing;
  for (int i = 0; i < wanted; ++i) {
    const auto seed = static_cast<std::uint64_t>(first) + static_cast<std::uint64_t>(i);
    if (store.runs().count(seed) == 0) missing.push_back(seed);
  }
  evaluation.taken_over = wanted - static_cast<int>(missing.size());
  run_missing(request, missing, store, evaluation.taken_over, evaluation.worst);
  store.close();
  for (int i = 0; i < wanted; ++i) {
    evaluation.runs.push_back(store.runs().at(static_cast<std::uint64_t>(first) + static_cast<std::uint64_t>(i)));
  }
  for (std::size_t c = 0; c < request.methods.size(); ++c) {
    evaluation.summaries.push_back(summarise(request.methods[c].name, evaluation.runs, c, request.suite.stages));
  }
  evaluation.variants = summarise_variants(request.suite.variants, evaluation.runs);
  evaluation.broken = broken_bars(request.suite.bars, evaluation.summaries.front());
  return evaluation;
}

}  // namespace isobath
