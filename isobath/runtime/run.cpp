#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/pose_track.hpp>
#include <isobath/runtime/closed_loop.hpp>
#include <isobath/runtime/depth_model.hpp>
#include <isobath/runtime/mission_run.hpp>
#include <isobath/runtime/prefetch.hpp>
#include <isobath/runtime/run.hpp>
#include <isobath/runtime/run_folder.hpp>
#include <isobath/runtime/run_log.hpp>
#include <isobath/runtime/run_source.hpp>
#include <isobath/runtime/scenario.hpp>

namespace isobath {
namespace {

using Clock = std::chrono::steady_clock;  // for timings alone: no result depends on it

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A scene is simulated here and now; it uses the threads itself.
std::unique_ptr<SimulatedSource> simulate(const RunRequest& request) {
  if (!is_scene(request.input)) return nullptr;
  return std::make_unique<SimulatedSource>(open_scene(request.input), request.configuration.simulation,
                                           std::min(request.threads, 2));
}

/// All that results and truths go to: the mission's crew, what the folder keeps, and, for a simulated run, what the
/// truth says of it.
class Sinks : public ResultSink, public SimulatedSource::TruthSink {
 public:
  explicit Sinks(RunFolder& folder) : folder_(folder) {}
  void on_ping(const PosedPing& ping) override {
    if (mission) mission->on_ping(ping);
    aside([&] {
      folder_.on_ping(ping);
      if (judge) judge->on_ping(ping);
    });
  }
  void on_scan(const ScanResult& scan) override {
    if (mission) mission->on_scan(scan);
    aside([&] {
      folder_.on_scan(scan);
      if (judge) judge->on_scan(scan);
    });
  }
  void take(const EchoTruth& echoes) override { tell(echoes); }
  void take(const TrueMotion& motion) override { tell(motion); }

  std::optional<MissionRun> mission;
  std::optional<TruthJudge> judge;
  std::optional<TrueTrack> track;
  std::optional<RunLog> log;

 private:
  template <class Work>
  void aside(Work work) {
    const auto start = Clock::now();
    work();
    if (mission) mission->leave_out(milliseconds_since(start));
  }
  template <class Truth>
  void tell(const Truth& truth) {
    if (judge) judge->take(truth);
    if (track) track->take(truth);
    if (log) log->take(truth);
  }

  RunFolder& folder_;
};

/// Outlines from above of all that stands in a scene, where it is now.
std::vector<TrueBody> outlines_of(const World& world) {
  std::vector<TrueBody> outlines;
  for (const WorldBody& body : world.bodies()) {
    for (Polygon part : body.plan) {
      for (Eigen::Vector2d& p : part) p += body.moved.head<2>();
      outlines.push_back({body.name, std::move(part)});
    }
  }
  return outlines;
}

/// North and east of a mission mean those of what it hears.
void check_frame(const MissionPlan& plan, const std::optional<GeoOrigin>& heard) {
  if (!plan.origin || !heard) return;
  const double apart_m = distance_m(*plan.origin, *heard);
  if (apart_m <= 1) return;
  throw Error(
      fmt::format("north and east of the mission count from a place {:.0f} m away from that of the input", apart_m),
      plan.place, "the same origin in both");
}

MissionOutcome outcome_of(const Sinks& sinks, const RunRequest& request, Simulator* simulator) {
  MissionOutcome mission = sinks.mission->outcome();
  if (simulator) {
    mission.truth = sinks.track->truth();
    mission.bodies = outlines_of(simulator->world());
  } else if (const auto recorded = compare_with_log(mission.decisions, request.input)) {
    mission.recorded = recorded->decisions;
    mission.as_recorded = recorded->the_same;
  }
  return mission;
}

RunTimings timings_of(std::vector<double>& ping_ms, double wall_ms) {
  RunTimings timings;
  timings.wall_s = wall_ms / 1000;
  if (ping_ms.empty()) return timings;
  std::sort(ping_ms.begin(), ping_ms.end());
  timings.ping_median_ms = ping_ms[ping_ms.size() / 2];
  timings.ping_p99_ms = ping_ms[ping_ms.size() * 99 / 100];
  return timings;
}

/// What makes the input itself wrong, as one line. A damaged stretch in the middle is none of these.
std::string problem_of(const RunOutcome& outcome) {
  const SourceReport& source = outcome.source;
  if (!source.damages.empty() && source.bytes_total > 0) {
    const Damage& last = source.damages.back();
    if (last.offset + last.bytes >= source.bytes_total) {
      return fmt::format("the log is cut off: its last {} bytes, from byte {}, are no whole record ({})", last.bytes,
                         last.offset, last.reason);
    }
  }
  for (const char* reason : {EventGate::kBadNavigation, EventGate::kBackwards, kBadPose, kPoseBackwards}) {
    const auto found = outcome.rejected.find(reason);
    if (found != outcome.rejected.end()) {
      return fmt::format("{}: {} of {} events were refused for it", reason, found->second,
                         found->second + outcome.counts.pings + outcome.counts.navigation + outcome.counts.ranges +
                             outcome.counts.swaths);
    }
  }
  return {};
}

}  // namespace

/// A folder of logs with one outline beside them: that of the water.
std::vector<std::string> priors_of(const RunRequest& request) {
  if (!request.configuration.prior.file.empty()) return {request.configuration.prior.file};
  std::error_code ignored;
  std::vector<std::string> outlines;
  for (const auto& entry : std::filesystem::directory_iterator(request.input, ignored)) {
    if (entry.path().extension() == ".shp") outlines.push_back(entry.path().string());
  }
  return outlines.size() == 1 ? outlines : std::vector<std::string>{};
}

DepthOutcome outcome_of(const DepthModel& model) {
  DepthOutcome depth;
  depth.counts = model.counts();
  for (std::size_t i = 0; i < depth.counts.refused.size(); ++i) {
    if (depth.counts.refused[i] > 0) depth.refused[to_text(static_cast<DepthRefusal>(i))] = depth.counts.refused[i];
  }
  depth.generation = model.facts().generation;
  depth.pixels_lost = model.pixels_lost();
  depth.continued = model.continues();
  depth.changes = model.changes();
  depth.origin = model.facts().origin;
  depth.found = model.found();
  depth.sensors = model.sensors();
  depth.priors = model.facts().priors;
  for (const Prior& prior : model.prior().files) {
    for (const auto& [what, count] : prior.read) depth.prior_read[what] += count;
    for (const auto& [reason, count] : prior.left_out) depth.prior_left_out[reason] += count;
  }
  for (const MapDamage& d : model.damages()) depth.damages.push_back(to_text(d));
  const DepthTrees& trees = model.snapshot()->trees();
  for (const RegionQuadtree* tree : {&trees.prior(), &trees.sensed(), &trees.state()}) {
    depth.leaves += tree->statistics().leaves;
    depth.bytes += tree->statistics().bytes;
  }
  trees.state().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow& leaf) {
    const DepthPixel pixel{0, word};
    const std::uint64_t pixels = static_cast<std::uint64_t>(leaf.width) * static_cast<std::uint64_t>(leaf.height);
    if (!pixel.has(kSensed) && pixel.has(kSeenByDepth) && pixel.confidence() > model.charted_confidence()) {
      depth.confirmed_pixels += pixels;
    }
    if (!pixel.has(kSensed)) return;
    depth.sensed_pixels += pixels;
    depth.sensed_by_confidence[static_cast<std::size_t>(pixel.confidence() / 5)] += pixels;
  });
  depth.pixel_m = model.facts().area.grid.pixel_m;
  depth.datum = model.facts().datum;
  trees.sensed().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow&) {
    if (word == DepthPixel::kUnknownDepth) return;
    const double metres = DepthPixel{word, 0}.depth_m();
    depth.shoalest_m = std::min(depth.shoalest_m.value_or(metres), metres);
    depth.deepest_m = std::max(depth.deepest_m.value_or(metres), metres);
  });
  depth.known_pixels = depth.sensed_pixels;
  trees.prior().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow& leaf) {
    if (word == DepthPixel::kUnknownDepth) return;
    trees.state().for_each_leaf(leaf, [&](std::uint32_t state, const PixelWindow& part) {
      if (DepthPixel{0, state}.has(kSensed)) return;
      depth.known_pixels += static_cast<std::uint64_t>(part.width) * static_cast<std::uint64_t>(part.height);
    });
  });
  return depth;
}

void prepare(Sinks& sinks, const RunRequest& request, const std::optional<MissionSetup>& setup,
             SimulatedSource* simulated) {
  if (!request.record.empty() && !simulated) {
    throw Error("only what is simulated can be recorded", {request.input.string(), {}, {}, {}, {}}, "a scene",
                "isobath convert makes a log of a log");
  }
  if (setup) sinks.mission.emplace(*setup, request.configuration);
  if (!simulated) return;
  const Simulator& simulator = simulated->simulator();
  sinks.judge.emplace(simulated->simulator());
  if (setup) sinks.track.emplace(simulator);
  if (!request.record.empty()) {
    sinks.log.emplace(request.record, simulator, scenario_text(request.input), request.configuration);
    if (setup) sinks.log->attach(*setup);
  }
  simulated->tell_truth_to(&sinks);
}

/// The end of an event's way: the set-point. False: the mission was over long enough.
bool steer(Sinks& sinks, Simulator* simulator, EndOfMission& end, Time time) {
  const Setpoint setpoint = sinks.mission->steer();
  if (sinks.log) sinks.log->write(time, setpoint, sinks.mission->helm().decisions());
  if (!simulator) return true;
  simulator->command(setpoint);
  return !end.reached(sinks.mission->helm(), simulator->now_s());
}

RunOutcome run(const RunRequest& request) {
  DepthModel depths(request.configuration, request.map);
  depths.set_prior_files(priors_of(request));
  const std::optional<GeoOrigin> frame = depths.stored_origin();
  const auto simulated = simulate(request);
  const auto opened =
      simulated ? nullptr : open_run_source(request.input, request.configuration, frame, request.threads);
  const auto placed = simulated && frame ? place_in(*simulated, *frame) : nullptr;
  Source* source = placed ? placed.get() : simulated ? static_cast<Source*>(simulated.get()) : opened.get();
  Simulator* simulator = simulated ? &simulated->simulator() : nullptr;
  const auto setup = mission_setup(request.mission, request.input, simulator);
  RunFolder folder(request.out, request.configuration);
  Sinks sinks(folder);
  prepare(sinks, request, setup, simulated.get());
  Pipeline pipeline(request.configuration, sinks, &depths);
  EndOfMission end;
  RunOutcome outcome;

  const auto start = Clock::now();
  std::vector<double> ping_ms;
  Time first = Time::max(), last = Time::min();
  while (auto event = source->next()) {
    depths.locate(frame ? frame : source->report().origin);
    const bool is_ping = std::holds_alternative<Ping>(*event);
    const Time time = time_of(*event);
    if (setup && first == Time::max()) check_frame(setup->plan, frame ? frame : source->report().origin);
    if (sinks.log) sinks.log->write(*event);
    if (sinks.mission) sinks.mission->hear(*event);
    const auto begun = Clock::now();
    const std::uint64_t mapped = pipeline.counts().pings;
    pipeline.take(std::move(*event));
    if (is_ping || pipeline.counts().pings > mapped) ping_ms.push_back(milliseconds_since(begun));
    first = std::min(first, time);
    last = std::max(last, time);
    if (request.progress) request.progress(source->report(), pipeline.counts());
    if (sinks.mission && !steer(sinks, simulator, end, time)) break;
  }
  if (sinks.mission) outcome.mission = outcome_of(sinks, request, simulator);  // before the sweep that was cut short
  pipeline.finish();
  depths.finish();
  outcome.timings = timings_of(ping_ms, milliseconds_since(start));
  outcome.counts = pipeline.counts();
  outcome.source = source->report();
  if (frame) outcome.source.origin = frame;
  outcome.rejected = outcome.source.rejected;
  for (const auto& [reason, count] : pipeline.rejected()) outcome.rejected[reason] += count;
  outcome.log_s = last > first ? to_seconds(last - first) : 0;
  if (outcome.counts.pings > 0) outcome.undecided = pipeline.undecided();
  outcome.alarms = alarms_of(pipeline.emergencies());
  for (const Alarm& alarm : alarms_of(depths.emergencies())) outcome.alarms.push_back(alarm);
  outcome.problem = problem_of(outcome);
  if (outcome.counts.pings + outcome.counts.ranges + outcome.counts.swaths == 0 && outcome.problem.empty())
    outcome.problem = "no ping, range or sounding in it could be used";
  if (outcome.counts.pings == 0 && !depths.snapshot() && outcome.problem.empty())
    outcome.problem = "none of its ranges and soundings has a place; say where the vehicle was (input.navigation)";
  if (sinks.log) sinks.log->close();
  if (sinks.judge) {
    outcome.truth = sinks.judge->score();
    folder.show_truth(sinks.judge->outlines());
  }
  if (depths.snapshot()) {
    depths.commit(request.input.empty() ? "embedded scene" : request.input.string());
    outcome.depth = outcome_of(depths);
  }
  folder.write(request, pipeline.grid(), depths, outcome);
  return outcome;
}

}  // namespace isobath
