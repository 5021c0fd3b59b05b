#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/pose_track.hpp>
#include <isobath/runtime/closed_loop.hpp>
#include <isobath/runtime/depth_model.hpp>
#include <isobath/runtime/display.hpp>
#include <isobath/runtime/mission_chart.hpp>
#include <isobath/runtime/mission_run.hpp>
#include <isobath/runtime/prefetch.hpp>
#include <isobath/runtime/run.hpp>
#include <isobath/runtime/run_folder.hpp>
#include <isobath/runtime/run_recorder.hpp>
#include <isobath/runtime/run_source.hpp>
#include <isobath/runtime/scenario.hpp>
#include <thread>

namespace isobath {
namespace {

using Clock = std::chrono::steady_clock;  // for timings alone: no result depends on it

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A scene is simulated here and now; it uses the threads itself.
std::unique_ptr<SimulatedSource> simulate(const RunRequest& request, const std::optional<Scenario>& scenario) {
  if (!scenario) return nullptr;
  return std::make_unique<SimulatedSource>(scenario->scene, request.configuration.simulation,
                                           std::min(request.threads, 2));
}

/// All that results and truths go to: the mission's crew, what the folder keeps, and, for a simulated run, what the
/// truth says of it.
class Sinks : public ResultSink, public SimulatedSource::TruthSink {
 public:
  Sinks(RunFolder& folder, const RunRequest& request)
      : voxels(request.configuration.voxels, request.out / "voxels.sqlite"),
        folder_(folder),
        reach_m_(request.configuration.mission.space_route.reach_m) {}
  void on_ping(const PosedPing& ping) override {
    load.enter(Stage::kAgents);
    if (mission) mission->on_ping(ping);
    load.enter(Stage::kVoxels);
    voxels.take(ping);
    load.enter(Stage::kReport);
    folder_.on_ping(ping);
    if (judge) judge->on_ping(ping);
    if (recorder) recorder->on_ping(ping);
    if (display) display->on_ping(ping);
    if (mission) mission->resume();
  }
  void on_scan(const ScanResult& scan) override {
    if (mission) {
      load.enter(Stage::kVoxels);
      const auto space = voxels.space_around(scan, reach_m_);
      load.enter(Stage::kAgents);
      if (space) mission->on_space(scan.detection.time, space);
      mission->on_scan(scan);
    }
    load.enter(Stage::kReport);
    folder_.on_scan(scan);
    if (judge) judge->on_scan(scan);
    if (recorder) recorder->on_scan(scan);
    if (display) display->on_scan(scan);
    if (mission) mission->resume();
  }
  void on_upright(const PosedPing& ping) override {
    load.enter(Stage::kVoxels);
    voxels.take(ping);
    load.enter(Stage::kReport);
    if (recorder) recorder->on_upright(ping);
    if (display) display->on_upright(ping);
  }
  void on_soundings(const Swath& swath, const Pose& X_WB) override {
    load.enter(Stage::kVoxels);
    voxels.take(swath, X_WB);
  }
  void on_jump(const Eigen::Vector3d& by_W) override {
    voxels.move_along(by_W);
    folder_.on_jump(by_W);
    if (display) display->on_jump(by_W);
  }
  void take(const EchoTruth& echoes) override { tell(echoes); }
  void take(const TrueMotion& motion) override { tell(motion); }

  StageLoad load;  ///< of whoever maps
  VoxelModel voxels;
  DisplayItems items;  ///< of the display, where nobody looks on
  DisplayItems* shown = &items;
  std::optional<Display> display;       ///< the mission's crew tells it
  std::optional<RunRecorder> recorder;  ///< likewise
  std::optional<RunFilm> film;          ///< of the display, for the report
  std::optional<MissionRun> mission;
  std::optional<TruthJudge> judge;
  std::optional<TrueTrack> track;

 private:
  template <class Truth>
  void tell(const Truth& truth) {
    if (judge) judge->take(truth);
    if (track) track->take(truth);
    if (recorder) recorder->take(truth);
  }

  RunFolder& folder_;
  double reach_m_;
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

MissionOutcome outcome_of(const Sinks& sinks, const RunRequest& request, SimulatedSource* simulated) {
  MissionOutcome mission = sinks.mission->outcome();
  if (simulated) {
    mission.truth = sinks.track->truth();
    mission.bodies = outlines_of(simulated->simulator().world());
    if (const SimulatedOperator* at_the_link = simulated->at_the_link()) mission.answers = at_the_link->answers();
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

/// Where --mission names a scenario: what was run once is decided again by the same chart.
std::optional<Scenario> scenario_of_mission(const RunRequest& request) {
  if (request.mission.empty()) return std::nullopt;
  const std::string file = request.mission.string(), text = text_of_file(file);
  return looks_like_scene(text) ? std::optional(parse_scenario(text, file)) : std::nullopt;
}

void check_live(const RunRequest& request, const std::optional<MissionSetup>& setup, bool simulated) {
  if (!request.live_speed) return;
  const Place input{request.input.string(), {}, {}, {}, {}};
  if (!simulated || !setup) throw Error("only a scene with a mission can run live", input);
  if (!request.record.empty()) {
    throw Error("a live run is not recorded", input, "", "what it decides could not be decided again");
  }
}

void prepare_recorder(Sinks& sinks, const RunRequest& request, const std::optional<MissionSetup>& setup,
                      SimulatedSource* simulated, const Source& source) {
  RunRecorder& recorder = sinks.recorder.emplace(request.record, request.configuration);
  if (simulated) {
    recorder.describe(simulated->simulator(), scenario_text(request.input));
  } else {
    recorder.describe(source.report());
  }
  if (setup) recorder.describe(*setup);
}

void prepare(Sinks& sinks, const RunRequest& request, const std::optional<MissionSetup>& setup,
             SimulatedSource* simulated, const Source& source) {
  check_live(request, setup, simulated != nullptr);
  if (setup) sinks.mission.emplace(*setup, request.configuration, request.live_speed.has_value());
  if (!request.record.empty()) prepare_recorder(sinks, request, setup, simulated, source);
  if (request.watch && request.watch->display) sinks.shown = request.watch->display;
  if (RunFilm::wanted(request.configuration.report) && !request.live_speed)
    sinks.film.emplace(request.configuration.report);
  if (request.watch || sinks.recorder || sinks.film) sinks.display.emplace(*sinks.shown);
  if (setup && sinks.display) {
    sinks.mission->show_messages_to([&sinks](const Envelope& envelope) {
      sinks.display->heard(envelope);
      if (sinks.recorder) sinks.recorder->heard(envelope);
    });
  }
  if (!simulated) return;
  if (!request.live_speed) sinks.judge.emplace(simulated->simulator());
  if (setup) sinks.track.emplace(simulated->simulator());
  simulated->tell_truth_to(&sinks);
}

/// What a page is told of the run as a whole; bodies that move stand where they are now.
DisplayScene scene_of(const RunRequest& request, const Source& source, const std::optional<MissionSetup>& setup,
                      SimulatedSource* simulated, const DepthModel& depths) {
  DisplayScene scene;
  scene.source = request.input.empty() ? "embedded scene" : request.input.filename().string();
  scene.title = setup && !setup->plan.title.empty() ? setup->plan.title : scene.source;
  scene.origin = source.report().origin;
  scene.safe_m = request.configuration.mission.route.clearance_m;
  scene.depth_datum = depths.facts().datum;
  if (setup) {
    scene.plan = setup->plan;
    if (setup->chart.objects) scene.charted = *setup->chart.objects;
    scene.vehicle_length_m = 2 * setup->vehicle.hull_radius_m;
    scene.vehicle_radius_m = setup->vehicle.half_width_m;
  }
  if (simulated) {
    scene.simulated = true;
    if (!setup) scene.title = simulated->simulator().scene().about.title;
    scene.bodies = outlines_of(simulated->simulator().world());
  }
  return scene;
}

/// The end of an event's way: the set-point. False: the mission was over long enough.
bool steer(Sinks& sinks, SimulatedSource* simulated, EndOfMission& end, Time time) {
  Helm& helm = sinks.mission->helm();
  const Setpoint setpoint = sinks.mission->steer();
  if (sinks.display) sinks.display->want(setpoint);
  if (sinks.recorder) {
    sinks.recorder->decided(helm.decisions());
    sinks.recorder->setpoint(time, setpoint);
  }
  if (!simulated) return true;
  simulated->simulator().command(setpoint);
  simulated->answer(helm.to_operator());
  return !end.reached(helm.progress().phase, simulated->simulator().now_s());
}

/// Keeps the threads of a live run together: by the real clock, or, as fast as it goes, by waiting for all.
class Pace {
 public:
  Pace(double speed, const Simulator& simulator) : speed_(speed), simulator_(simulator), start_(Clock::now()) {}
  void keep(MappingThread& mapping, Helm& helm) {
    const double now_s = simulator_.now_s();
    if (speed_ > 0) {
      std::this_thread::sleep_until(start_ + std::chrono::duration<double>(now_s / speed_));
    } else if (now_s - settled_s_ >= to_seconds(kTick)) {
      settle(mapping, helm);
      settled_s_ = now_s;
    }
  }

 private:
  double speed_;
  const Simulator& simulator_;
  Clock::time_point start_;
  double settled_s_ = 0;
};

/// Lets a run be looked at: not faster than the watch says, and stopped when it says so. A gap of time in a log is
/// waited for no longer than kLongestWait.
class WatchedPace {
 public:
  static constexpr double kLongestWait_s = 2;
  explicit WatchedPace(const RunWatch& watch) : watch_(watch) {}

  /// Before an event of this time is heard. False: it is to end here.
  bool keep(Time time) {
    if (watch_.stopped && watch_.stopped()) return false;
    if (watch_.speed <= 0) return true;
    const auto now = Clock::now();
    const double ahead_s = last_ ? to_seconds(time - *last_) / watch_.speed : 0;
    if (time > last_.value_or(Time::min())) last_ = time;
    due_ += std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(std::clamp(ahead_s, 0.0, kLongestWait_s)));
    due_ = std::max(due_, now - kMostBehind);  // what was slow is made up for, but not for long
    while (due_ > Clock::now()) {
      if (watch_.stopped && watch_.stopped()) return false;
      std::this_thread::sleep_until(std::min(due_, Clock::now() + kMostBehind));
    }
    return true;
  }

 private:
  static constexpr Clock::duration kMostBehind = std::chrono::milliseconds(500);
  const RunWatch& watch_;
  std::optional<Time> last_;
  Clock::time_point due_ = Clock::now();
};

/// After an event has gone all its way.
void show(Sinks& sinks, Time time, const Pipeline& pipeline, const DepthModel& depths,
          const std::function<DisplayScene()>& scene) {
  if (!sinks.display) return;
  if (sinks.display->wants_counts(time)) {
    const bool looked_at = sinks.shown != &sinks.items;  // no recording holds what a real clock measured
    sinks.display->show(time, scene());
    if (sinks.mission && looked_at) sinks.display->show(time, sinks.mission->timings());
  }
  sinks.display->look(time, pipeline, depths, sinks.voxels);
  if (sinks.recorder) sinks.recorder->sample(time, *sinks.shown);
  if (sinks.film) sinks.film->sample(time, *sinks.shown);
}

/// What pipeline and depth map found (`mapped`: there are voxels), and whether the input was in order.
void add_results(RunOutcome& outcome, const Pipeline& pipeline, const DepthModel& depths, bool mapped) {
  outcome.counts = pipeline.counts();
  outcome.rejected = outcome.source.rejected;
  for (const auto& [reason, count] : pipeline.rejected()) outcome.rejected[reason] += count;
  if (outcome.counts.pings > 0) outcome.undecided = pipeline.undecided();
  outcome.alarms = alarms_of(pipeline.emergencies());
  for (const Alarm& alarm : alarms_of(depths.emergencies())) outcome.alarms.push_back(alarm);
  outcome.problem = problem_of(outcome);
  if (outcome.counts.pings + outcome.counts.upright + outcome.counts.ranges + outcome.counts.swaths == 0 &&
      outcome.problem.empty())
    outcome.problem = "no ping, range or sounding in it could be used";
  if (outcome.counts.pings + outcome.counts.upright == 0 && !depths.snapshot() && !mapped && outcome.problem.empty())
    outcome.problem = "none of its ranges and soundings has a place; say where the vehicle was (input.navigation)";
}

RunOutcome run(const RunRequest& asked) {
  RunRequest request = asked;
  std::optional<Scenario> scenario;
  if (is_scene(request.input)) scenario = open_scenario(request.input);
  if (const auto named = scenario ? scenario : scenario_of_mission(request)) {
    request.configuration = named->with_prior(request.configuration);
  }
  const std::vector<std::string> priors = priors_of(request);
  DepthModel depths(request.configuration, request.map);
  depths.set_prior_files(priors);
  const std::optional<GeoOrigin> frame = depths.stored_origin();
  const auto simulated = simulate(request, scenario);
  const auto opened =
      simulated ? nullptr : open_run_source(request.input, request.configuration, frame, request.threads);
  const auto placed = simulated && frame ? place_in(*simulated, *frame) : nullptr;
  Source* source = placed ? placed.get() : simulated ? static_cast<Source*>(simulated.get()) : opened.get();
  const Simulator* simulator = simulated ? &simulated->simulator() : nullptr;
  auto setup = mission_setup(request.mission, request.input, simulator);
  if (setup) {
    setup->chart = chart_of(request.map, priors, request.configuration, frame ? frame : source->report().origin);
    if (simulated) simulated->add_operator(scenario->orders, setup->plan);
  }
  RunFolder folder(request.out, request.configuration);
  Sinks sinks(folder, request);
  prepare(sinks, request, setup, simulated.get(), *source);
  Pipeline pipeline(request.configuration, sinks, &depths);
  pipeline.watch(&sinks.load);
  EndOfMission end;
  RunOutcome outcome;

  const auto start = Clock::now();
  std::vector<double> ping_ms;
  const auto map = [&](Event event, Clock::time_point taken) {
    const bool is_ping = std::holds_alternative<Ping>(event);
    const std::uint64_t mapped = pipeline.counts().pings;
    if (sinks.mission) sinks.mission->begin(taken);
    const auto begun = Clock::now();
    pipeline.take(std::move(event));
    sinks.load.leave();
    if (is_ping || pipeline.counts().pings > mapped) ping_ms.push_back(milliseconds_since(begun));
  };
  std::optional<MappingThread> mapping;
  std::optional<Pace> pace;
  if (request.live_speed) {
    pace.emplace(*request.live_speed, *simulator);
    mapping.emplace(map);
  }
  std::optional<WatchedPace> watched;
  if (request.watch) watched.emplace(*request.watch);
  const auto scene = [&] { return scene_of(request, *source, setup, simulated.get(), depths); };
  std::deque<Event> ahead;
  // Who decides on the way could not have known, in the vehicle's time, what comes.
  if (!simulated && !setup) ahead = listen_ahead(*source, pipeline);
  StageLoad beside;  // of whoever senses and steers
  const auto next = [&] {
    beside.enter(Stage::kSource);
    std::optional<Event> event;
    if (ahead.empty()) {
      event = source->next();
    } else {
      event = std::move(ahead.front());
      ahead.pop_front();
    }
    beside.leave();
    return event;
  };
  Time first = Time::max(), last = Time::min();
  while (auto event = next()) {
    const std::optional<GeoOrigin> origin = frame ? frame : source->report().origin;
    if (!mapping || first == Time::max()) depths.locate(origin);  // a scene lies where it lies from the start
    if (setup && first == Time::max()) check_frame(setup->plan, origin);
    const Time time = time_of(*event);
    if (watched && !watched->keep(time)) break;
    if (watched && simulated && setup && request.watch->ordered) {
      if (const auto order = request.watch->ordered()) simulated->order(*order, setup->plan);
    }
    if (sinks.recorder) {
      if (origin) sinks.recorder->locate(*origin);
      sinks.recorder->take(*event);
    }
    if (sinks.display) sinks.display->hear(*event);
    const auto taken = Clock::now();
    beside.enter(Stage::kAgents);
    if (sinks.mission) sinks.mission->hear(*event);
    beside.leave();
    if (mapping) {
      mapping->take(std::move(*event));
      pace->keep(*mapping, sinks.mission->helm());
    } else {
      map(std::move(*event), taken);
    }
    first = std::min(first, time);
    last = std::max(last, time);
    if (request.progress) request.progress(source->report(), mapping ? PipelineCounts{} : pipeline.counts());
    beside.enter(Stage::kAgents);
    const bool over = sinks.mission && !steer(sinks, simulated.get(), end, time);
    beside.enter(Stage::kReport);
    show(sinks, time, pipeline, depths, scene);
    beside.leave();
    if (over) break;
  }
  if (mapping) {
    settle(*mapping, sinks.mission->helm());
    outcome.live = LiveOutcome{mapping->lost_pings()};
  }
  if (sinks.mission) outcome.mission = outcome_of(sinks, request, simulated.get());  // before the sweep cut short
  pipeline.finish();
  depths.finish();
  sinks.load.leave();
  outcome.timings = timings_of(ping_ms, milliseconds_since(start));
  outcome.timings.load = load_of(sinks.load, beside);
  if (mapping && outcome.mission) outcome.timings.load.add(Stage::kAgents, outcome.mission->timings.agents_s);
  outcome.log_s = last > first ? to_seconds(last - first) : 0;
  outcome.source = source->report();
  if (frame) outcome.source.origin = frame;
  add_results(outcome, pipeline, depths, sinks.voxels.map() != nullptr);
  for (const auto& [reason, count] : sinks.voxels.refused())
    outcome.rejected["left out of the voxels: " + reason] += count;
  if (sinks.recorder) {
    sinks.recorder->sample(last, *sinks.shown, true);
    sinks.recorder->close();
    outcome.recording_problem = sinks.recorder->problem();
    outcome.not_recorded = sinks.recorder->left_out();
  }
  if (sinks.film && last >= first) folder.show_run(*sinks.film, last, *sinks.shown);
  if (sinks.judge) {
    outcome.truth = sinks.judge->score();
    folder.show_truth(sinks.judge->outlines());
  }
  if (depths.snapshot()) {
    depths.commit(request.input.empty() ? "embedded scene" : request.input.string());
    outcome.depth = outcome_of(depths);
  }
  if (const VoxelMap* voxels = sinks.voxels.map()) {
    constexpr std::uint64_t kJudged = 500'000;
    outcome.voxels = sinks.voxels.outcome();
    if (sinks.voxels.save()) outcome.files.emplace_back("voxels.sqlite");
    if (sinks.judge) outcome.voxels->truth = judge(*voxels, simulator->world(), 1 + outcome.voxels->seen / kJudged);
  }
  folder.write(request, pipeline.grid(), sinks.voxels.map(), depths, outcome);
  return outcome;
}

}  // namespace isobath
