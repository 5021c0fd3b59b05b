#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <isobath/app/exit_codes.hpp>
#include <isobath/app/group_results.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/app/run_json.hpp>
#include <isobath/app/run_options.hpp>
#include <isobath/app/speed.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <isobath/perception/water_label.hpp>
#include <isobath/report/contact_text.hpp>
#include <isobath/report/corner_fix_text.hpp>
#include <isobath/report/fan_calibration.hpp>
#include <isobath/report/mission_pages.hpp>
#include <isobath/report/placement_pages.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/run/group_run.hpp>
#include <isobath/run/run.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct RunCommandOptions : RunOptions {
  bool json = false, live = false;
  std::string speed = "1";
};

void print(const char* stage, const StageTime& t) {
  fmt::print("  {:<30} {:>9.3f} {:>9.3f} {:>9.3f}  {:>7}\n", stage, t.median_ms, t.p99_ms, t.worst_ms, t.count);
}

void print(const MissionTimings& t) {
  fmt::print("  {:<30} {:>9} {:>9} {:>9}  {:>7}\n", "latency, ms", "median", "99 %", "worst", "count");
  print("agents: handling of an event", t.event_to_agents);
  print("mapping: a ping into the grid", t.ping_to_grid);
  print("detection: obstacles of a scan", t.detection);
  print("planning: the Navigator's turn", t.planning);
  print("scan to decision", t.scan_to_decision);
  if (t.cycle.count > 0) print("cycle of 0.6 s, departure", t.cycle);
}

void print(const TruthScore& truth) {
  fmt::print("ground truth: {} pieces of obstacles in {} scans, {} of them false\n", truth.obstacles, truth.scans,
             truth.false_alarms);
  for (const BodyScore& b : truth.bodies) {
    if (b.scans_found == 0) {
      fmt::print("  {}: echoes in {} pings, not detected\n", printable_text(b.name), b.pings_heard);
      continue;
    }
    fmt::print("  {}: detected at {:.1f} m, {} pings ({:.1f} s) after its first echo", printable_text(b.name),
               b.first_range_m, b.delay_pings, b.delay_s);
    if (b.compact) fmt::print("; range error {:+.2f} m mean, {:.2f} m rms", b.range_error_mean_m, b.range_error_rms_m);
    fmt::print("\n");
  }
  const MotionScore& m = truth.motion;
  if (m.scans == 0) return;
  fmt::print("moving bodies: {} of {} that were heard known to move", m.known, m.bodies);
  if (m.known > 0)
    fmt::print(", {:.1f} s after the first echo (median; 95 %: {:.1f} s)", m.known_after_s, m.known_after_95_s);
  fmt::print("; OSPA {:.2f} m (cut-off {:g} m) in {} scans; ", m.ospa_m, MotionScorer::kCutOff_m, m.scans);
  if (m.known > 0) fmt::print("errors {:.2f} m and {:.2f} m/s rms; ", m.position_rms_m, m.velocity_rms);
  fmt::print("{:.1f} false tracks a scan, {} switches\n", m.false_tracks, m.switches);
}

void print(const RunRequest& request, const DepthOutcome& depth) {
  const DepthCounts& n = depth.counts;
  fmt::print("depth map: {} ranges and {} soundings; {} pixels measured, ", n.readings, n.soundings,
             depth.sensed_pixels);
  if (depth.confirmed_pixels > 0) fmt::print("{} charted ones confirmed, ", depth.confirmed_pixels);
  fmt::print("{} known\n", depth.known_pixels);
  for (const std::string& prior : depth.priors) fmt::print("  prior: {}\n", printable_text(prior));
  for (const auto& [reason, count] : depth.prior_left_out)
    fmt::print("  prior: left out {}: {}\n", count, printable_text(reason));
  for (const auto& [reason, count] : depth.refused) fmt::print("  refused {}: {}\n", count, printable_text(reason));
  if (depth.pixels_lost > 0) fmt::print("  {} pixels lay outside the operational area\n", depth.pixels_lost);
  for (const std::string& damage : depth.damages) fmt::print("  damaged: {}\n", printable_text(damage));
  if (depth.generation > 0) {
    fmt::print("  committed to {} as generation {}\n", request.map.string(), depth.generation);
  }
}

void print(const std::vector<Obstacle>& pieces, std::uint64_t scans) {
  constexpr std::size_t kMaxPrinted = 10;  // the nearest come first
  const std::vector<WholeObstacle> obstacles = whole_obstacles(pieces);
  const auto hidden = static_cast<std::size_t>(
      std::count_if(obstacles.begin(), obstacles.end(), [](const WholeObstacle& o) { return o.behind; }));
  fmt::print("{} obstacle{} at the end of {} scan{}\n", obstacles.size(), obstacles.size() == 1 ? "" : "s", scans,
             scans == 1 ? "" : "s");
  std::size_t printed = 0;
  for (const WholeObstacle& o : obstacles) {
    if (o.behind || printed == kMaxPrinted) continue;
    ++printed;
    const Obstacle& nearest = *o.nearest;
    fmt::print("  obstacle {:<3}  {:6.2f} m  bearing {:5.1f} deg  {:<8}  {:5.1f} m across  existence {:.3f}{}{}{}\n",
               o.number, nearest.range_m, nearest.bearing.wrapped_positive().degrees(), o.kind(), o.extent_m,
               o.existence, nearest.label == WaterLabel::kUnknown ? "" : fmt::format("  {}", to_text(nearest.label)),
               o.possible_multiple ? "  possible multiple echo" : "",
               nearest.moves() ? "  " + motion_text(nearest) : "");
  }
  if (hidden > 0) fmt::print("  {} {} hidden behind nearer ones\n", hidden, hidden == 1 ? "is" : "are");
  if (printed + hidden < obstacles.size()) {
    fmt::print("  and {} more in obstacles.json\n", obstacles.size() - printed - hidden);
  }
}

/// Prints the numbers of pings, echoes, ranges and swaths received.
void print_input(const RunOutcome& outcome) {
  const PipelineCounts& n = outcome.counts;
  const std::string span = span_text(outcome.log_s);
  if (n.pings > 0 || n.ranges + n.swaths == 0) {
    fmt::print("received {} pings in {}: {} echoes in {} bins\n", n.pings, span, n.hits, n.bins);
  } else {
    fmt::print("received {} ranges and {} swaths in {}\n", n.ranges, n.swaths, span);
  }
  const std::uint64_t moving = n.bodies.moving;
  if (moving > 0) {
    fmt::print("{} bod{} found to move; {} echoes of moving bodies went to no map\n", moving,
               moving == 1 ? "y was" : "ies were", n.of_moving);
  }
  if (n.bodies.left_out > 0) {
    fmt::print("too many echoes to track all: {} readings and tracks of bodies were left out\n", n.bodies.left_out);
  }
  if (n.vertical > 0) fmt::print("received {} pings of vertical fans, for the voxel map\n", n.vertical);
}

/// Prints what the user may want to correct: refusals, damage, jumps, missing altitudes.
void print_doubts(const RunOutcome& outcome) {
  const PipelineCounts& n = outcome.counts;
  for (const auto& [reason, count] : outcome.rejected) fmt::print("refused {}: {}\n", count, printable_text(reason));
  for (const Damage& d : outcome.source.damages) {
    fmt::print("skipped {} bytes at byte {}: {}\n", d.bytes, d.offset, d.reason);
  }
  if (n.jumps > 0) {
    fmt::print("jumps of the position: {}, by up to {:.1f} m; the maps around the vehicle moved along\n", n.jumps,
               n.farthest_jump_m);
  }
  if (outcome.fan) fmt::print("{}\n", to_text(*outcome.fan));
  if (!outcome.map_holds.empty()) fmt::print("{}\n", printable_text(outcome.map_holds));
  if (!outcome.undecided.empty()) fmt::print("at the end of the run no bin could be decided: {}\n", outcome.undecided);
  if (100 * n.no_bottom > n.pings) {  // the first pings of a log come before the first altitude
    fmt::print("no altitude for {} of {} pings: bottom echoes are not separated from obstacles\n", n.no_bottom,
               n.pings);
  }
  if (n.blind > 0) {
    fmt::print("echoes of bottom or surface mask {} of {} bins: these count as unknown\n", n.blind, n.bins);
  }
}

void print_timings(const RunOutcome& outcome) {
  const RunTimings& timings = outcome.timings;
  fmt::print("{:.2f} s of work, {:.0f} x real time\n", timings.wall_s,
             timings.wall_s > 0 ? outcome.log_s / timings.wall_s : 0);
  if (const std::string load = load_text(timings.load, outcome.counts.pings, outcome.log_s); !load.empty()) {
    fmt::print("{}\n", load);
  }
  if (outcome.mission) print(outcome.mission->timings);
}

/// Prints the results first, then the input, the problems and the output folder.
void print(const RunRequest& request, const RunOutcome& outcome) {
  for (const Alarm& alarm : outcome.alarms) fmt::print("ALARM: {}\n", to_text(alarm));
  if (outcome.mission) {
    for (const std::string& line : mission_summary(*outcome.mission))
      fmt::print("{}\n", printable_text(line, 2 * kMaxForeignText));
    if (outcome.live) fmt::print("{}\n", live_text(*outcome.live));
  }
  if (outcome.counts.pings > 0 || !outcome.depth) print(outcome.obstacles, outcome.counts.scans);
  if (outcome.depth) print(request, *outcome.depth);
  if (outcome.sphere) fmt::print("{}\n", sphere_text(*outcome.sphere));
  if (outcome.corner_fix) fmt::print("{}\n", corner_fix_text(*outcome.corner_fix));
  if (outcome.contacts) fmt::print("{}", contact_lines(*outcome.contacts));
  if (outcome.sharpness) fmt::print("{}\n", to_text(*outcome.sharpness));
  if (outcome.drift) fmt::print("{}\n", to_text(*outcome.drift));
  if (outcome.truth) print(*outcome.truth);
  print_input(outcome);
  print_doubts(outcome);
  if (request.timings) print_timings(outcome);
  fmt::print("written to {}: report.html and {} more files\n", request.out.string(), outcome.files.size() - 1);
}

int act(RunCommandOptions& options) {
  RunRequest& request = options.read();
  if (options.live) request.live_speed = speed_of(options.speed);
  ProgressLine progress;
  request.progress = [&](const SourceReport& source, const PipelineCounts& counts) {
    progress.show(source.bytes_read, source.bytes_total, counts.pings + counts.ranges + counts.swaths);
  };
  if (!options.conditions().empty() && !options.json) fmt::print("{}\n", printable_text(options.conditions(), 1000));
  if (const auto scenario = vehicle_group_of(request)) {
    const GroupOutcome outcome = run_group(request, *scenario);
    progress.clear();
    if (options.json) {
      print_json(group_results_json(request, outcome));
    } else {
      print_group_results(request, outcome);
    }
    std::fflush(stdout);
    return conclude_group(outcome);
  }
  const RunOutcome outcome = run(request);
  progress.clear();
  if (options.json) {
    print_json(run_json(request, outcome));
  } else {
    print(request, outcome);
  }
  return conclude(request, outcome);
}

}  // namespace

Action add_run(CLI::App& program) {
  auto options = std::make_shared<RunCommandOptions>();
  CLI::App* command = program.add_subcommand("run", "Map a log or a scene; write map, obstacles, pictures and report");
  command->add_option("INPUT", options->request.input, "Log, folder of frames, or scene (.toml)")
      ->check(reads())
      ->default_str("the embedded scene");
  options->add_to(*command, "out/run");
  options->add_suite_to(*command);
  add_json_flag(*command, options->json);
  CLI::Option* live = command
                          ->add_flag("--live", options->live,
                                     "Run the scene's mission with real threads; the output is not deterministic")
                          ->group("Run");
  command->add_option("--speed", options->speed, "Speed of a live run: a multiple of real time, or max")
      ->type_name("FACTOR")
      ->check(speed())
      ->capture_default_str()
      ->needs(live)
      ->group("Run");
  command->add_flag("--timings", options->request.timings, "Print measured times, here and in the report")
      ->group("Run");
  add_example(*command, "run dive.bin --out out/dive");
  add_example(*command, "run survey/ --map lake --set input.sound_speed=1480");
  add_example(*command, "run --suite bridge --set simulation.seed=742");
  add_example(*command, "run scenarios/simulated_mission_1.toml --record mission.mcap --json");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
