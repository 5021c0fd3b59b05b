#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/run/aboard.hpp>
#include <isobath/run/log_identity.hpp>
#include <isobath/run/mission_desk.hpp>
#include <isobath/run/mission_input.hpp>
#include <isobath/run/run_outputs.hpp>
#include <isobath/run/run_results.hpp>
#include <isobath/run/vehicle_run.hpp>
#include <isobath/scenario/voxel_scorer.hpp>
#include <span>

namespace isobath {
namespace {

/// "propeller 11.2 N, rudder -3.4 deg".
std::string actuator_text(const VehicleModel& vehicle, const ActuatorVector& commands) {
  std::string text;
  for (std::size_t i = 0; i < static_cast<std::size_t>(commands.size()); ++i) {
    const double value = commands[static_cast<Eigen::Index>(i)];
    const bool is_fin = i >= vehicle.thrusters.size();
    if (!text.empty()) text += ", ";
    text += is_fin ? fmt::format("{} {:.1f} deg", vehicle.fins[i - vehicle.thrusters.size()].name,
                                 Angle::radians(value).degrees())
                   : fmt::format("{} {:.1f} N", vehicle.thrusters[i].name, value);
  }
  return text;
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The prior of the configuration; else, for a folder of logs with one outline (.shp), that outline of the water.
std::vector<std::string> priors_of(const RunRequest& request) {
  if (!request.configuration.prior.file.empty()) return {request.configuration.prior.file};
  std::error_code ignored;
  std::vector<std::string> outlines;
  for (const auto& entry : std::filesystem::directory_iterator(request.input, ignored)) {
    if (entry.path().extension() == ".shp") outlines.push_back(entry.path().string());
  }
  return outlines.size() == 1 ? outlines : std::vector<std::string>{};
}

/// The same, once it is sure that the run overwrites none of its inputs.
std::vector<std::string> checked_priors(const RunRequest& request) {
  std::vector<std::string> priors = priors_of(request);
  check_run_outputs(request, priors);
  return priors;
}

/// The scenario, if the input is one.
std::optional<Scenario> scenario_of_input(const RunRequest& request) {
  if (request.aboard || !is_scene(request.input)) return std::nullopt;
  Scenario scenario = request.scenario ? *request.scenario : open_scenario(request.input);
  return request.vehicle ? scenario.of_vehicle(*request.vehicle) : std::move(scenario);
}

/// The scenario, if --mission names one: a replay must use the same chart as the recorded run.
std::optional<Scenario> scenario_of_mission(const RunRequest& request) {
  if (request.mission.empty()) return std::nullopt;
  const std::string file = request.mission.string(), text = text_of_file(file);
  return looks_like_scene(text) ? std::optional(parse_scenario(text, file)) : std::nullopt;
}

/// Adds the prior of the scenario, if it has one.
RunRequest completed(RunRequest request, const std::optional<Scenario>& scenario) {
  if (const auto named = scenario ? scenario : scenario_of_mission(request)) {
    request.configuration = named->with_prior(request.configuration);
  }
  return request;
}

RunInput input_of(const RunRequest& request, const std::optional<Scenario>& scenario,
                  const std::optional<GeoOrigin>& frame) {
  if (request.aboard) return {request.aboard->links().source(), frame};
  return {request.input, scenario, request.configuration, frame, request.threads};
}

void check_live(const RunRequest& request, bool mission_in_a_scene) {
  if (!request.live_speed) return;
  if (!mission_in_a_scene) {
    throw Error("only a scene with a mission can run live", {request.input.string(), {}, {}, {}, {}});
  }
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

}  // namespace

VehicleRun::VehicleRun(const RunRequest& asked)
    : scenario_(scenario_of_input(asked)),
      request_(completed(asked, scenario_)),
      priors_(checked_priors(request_)),
      fingerprint_(fingerprint_of_log(request_)),
      held_(visit_of(request_.map, fingerprint_)),
      depths_(request_.configuration, held_ ? std::filesystem::path() : request_.map,
              to_toml(request_.configuration, false)),
      input_(input_of(request_, scenario_, depths_.stored_origin())),
      setup_(mission()),
      folder_(request_.out, request_.configuration),
      display_(request_, setup_, input_),
      helm_(make_helm()),
      onboard_(request_.configuration, depths_,
               {.helm = helm_.get(),
                .times = times_,
                .voxel_file = request_.out / "voxels.sqlite",
                .corners = charted_corners(request_.map, priors_, request_.configuration, input_.origin()),
                .live = request_.has_real_threads()}) {
  depths_.set_prior_files(priors_);
  if (request_.live_speed.value_or(0) > 0) cycles_.emplace(*request_.live_speed);
  invite_observers();
  if (request_.watch) watched_.emplace(*request_.watch);
  if (setup_) in_force_.begin(setup_->plan);
  const bool steers = setup_ && (input_.simulated() || request_.aboard);
  if (steers && desk()) desk()->open(*setup_, request_.configuration.mission);
  if (request_.has_real_threads()) {
    live_datum_ = depths_.continues() ? depths_.facts().datum : request_.configuration.prior.datum;
  }
  if (request_.live_speed) live_.emplace(*request_.live_speed, *input_.simulator());
  if (request_.aboard) {
    onboard_.show_to(*request_.aboard);
    if (setup_) request_.aboard->set_plan(setup_->plan);
  }
}

std::optional<MissionSetup> VehicleRun::mission() {
  auto setup = mission_setup(request_.mission, scenario_ ? &*scenario_ : nullptr, request_.input, input_.simulator());
  check_live(request_, setup && input_.simulated());
  if (!setup) return setup;
  if (request_.aboard) {
    setup->vehicle = request_.aboard->vehicle();
    setup->plan.waits_for_operator = true;  // until the vehicle is armed and in GUIDED
  }
  timing_ = check_timing(request_.configuration.mission.timing);
  setup->chart = chart_of(request_.map, priors_, request_.configuration, input_.origin());
  if (SimulatedSource* simulated = input_.simulated()) simulated->add_operator(scenario_->orders, setup->plan);
  return setup;
}

std::unique_ptr<Helm> VehicleRun::make_helm() const {
  if (!setup_) return nullptr;
  if (request_.has_real_threads()) return make_threaded_helm(*setup_, request_.configuration, times_);
  return make_serial_helm(*setup_, request_.configuration, times_);
}

/// Onboard calls the observers in this order.
void VehicleRun::invite_observers() {
  if (helm_) onboard_.show_to(notes_);
  onboard_.show_to(folder_);
  if (!input_.simulated()) {
    onboard_.show_to(fan_.emplace(request_.configuration.mission.memory,
                                  reference_of(request_.input, request_.configuration.input, input_.origin())));
  }
  if (SimulatedSource* simulated = input_.simulated()) {
    if (!request_.live_speed) {
      onboard_.show_to(judge_.emplace(simulated->simulator()));
      simulated->tell_truth_to(*judge_);
      onboard_.show_to(map_judge_.emplace(simulated->simulator(), request_.configuration.depth.evidence.range_cap_m));
      simulated->tell_truth_to(*map_judge_);
    }
    if (setup_) simulated->tell_truth_to(track_.emplace(simulated->simulator()));
    simulated->tell_truth_to(display_);
  }
  if (display_.on()) onboard_.show_to(display_);
  if (!helm_) return;
  helm_->show_messages_to([this](const Envelope& envelope) {
    notes_.on_message(envelope);
    levels_.on_message(envelope);
    in_force_.on_message(envelope);
    if (desk()) desk()->on_message(envelope);
    if (request_.aboard) request_.aboard->on_message(envelope);
    if (cycles_ && std::holds_alternative<HelmOrder>(envelope.message)) cycles_->note();
    if (display_.on()) display_.on_message(envelope);
  });
}

bool VehicleRun::advance(double until_s) {
  // A mission must not see future pings, so with a mission there is no look-ahead.
  if (!begun_ && !input_.simulated() && !setup_) input_.listen_for(onboard_.pipeline());
  begun_ = true;
  while (!over_ && !(input_.simulator() && input_.simulator()->now_s() >= until_s)) {
    auto event = next();
    over_ = !event || !take(std::move(*event));
    if (!helm_) continue;
    for (FrameBytes& packet : helm_->to_group()) packets_.push_back(std::move(packet));
  }
  return !over_;
}

RunOutcome VehicleRun::outcome() {
  onboard_.settle();
  RunOutcome outcome;
  if (helm_) outcome.mission = mission_outcome();  // before finish() ends the open sweep
  onboard_.finish();
  std::vector<double> ping_ms = onboard_.ping_ms();
  outcome.timings = timings_of(ping_ms, milliseconds_since(began_));
  outcome.timings.load = onboard_.load();
  if (is_live()) {
    outcome.live.emplace().lost_pings = onboard_.lost_pings();
    if (outcome.mission) outcome.timings.load.add(Stage::kAgents, outcome.mission->timings.agents_s);
    if (request_.aboard) outcome.aboard = request_.aboard->outcome();
  }
  if (first_ <= last_) outcome.started = first_;
  outcome.log_s = last_ > first_ ? to_seconds(last_ - first_) : 0;
  outcome.source = input_.report();
  outcome.source.origin = input_.origin();
  const VoxelModel& voxels = onboard_.voxels();
  add_results(outcome, onboard_.pipeline(), depths_, voxels.map() != nullptr);
  for (const std::string& departure : timing_) {
    outcome.warning += (outcome.warning.empty() ? "timing: " : "; timing: ") + departure;
  }
  for (const auto& [reason, count] : voxels.refused()) outcome.rejected["left out of the voxels: " + reason] += count;
  finish_display(outcome);
  if (judge_) {
    outcome.truth = judge_->score();
    outcome.truth->mapped = map_judge_->bodies();
    folder_.show_truth(judge_->outlines());
  }
  if (depths_.snapshot()) {
    depths_.commit(request_.input.empty() ? "embedded scene" : request_.input.string(), fingerprint_);
    outcome.depth = outcome_of(depths_);
  }
  if (held_) {
    outcome.map_holds = fmt::format("already in this map: {} holds this log as {}; the map stays as it is",
                                    request_.map.string(), held_->input);
  }
  if (voxels.map()) add_voxels(outcome);
  if (fan_) {
    fan_->add_to(outcome);
    if (outcome.sharpness) folder_.show_placement(fan_->view(outcome));
  }
  if (request_.configuration.corner_fix.on) outcome.corner_fix = onboard_.corner_fixes().outcome();
  outcome.contacts = onboard_.contacts().outcome();
  if (onboard_.sphere().grid()) outcome.sphere = onboard_.sphere().outcome(vehicle_radius_m());
  folder_.write(request_, onboard_, outcome);
  return outcome;
}

void VehicleRun::finish_display(RunOutcome& outcome) {
  display_.finish(last_);
  if (const RunRecorder* recorder = display_.recorder()) {
    outcome.recording_problem = recorder->problem();
    outcome.not_recorded = recorder->left_out();
  }
  if (display_.replay() && last_ >= first_) folder_.show_run(*display_.replay(), last_, display_.items());
  if (!outcome.live) return;
  const TaskThread::LeftOut left_out = display_.left_out();
  outcome.live->unshown_pings = left_out.pings;
  outcome.live->unshown_notes = left_out.notes;
  outcome.live->display_problem = display_.problem();
  if (display_.problem().empty() || !display_.recorder() || !outcome.recording_problem.empty()) return;
  outcome.recording_problem = display_.problem();
  outcome.not_recorded = left_out.pings + left_out.notes;
}

std::optional<Event> VehicleRun::next() {
  onboard_.beside().enter(Stage::kSource);
  std::optional<Event> event = input_.next();
  onboard_.beside().leave();
  return event;
}

bool VehicleRun::take(Event event) {
  const Time time = time_of(event);
  const bool is_first = first_ == Time::max();
  if (!is_live() || is_first) depths_.locate(input_.origin());  // the origin of a scene is known from the start
  if (setup_ && is_first) check_frame(setup_->plan, input_.origin());
  if (watched_ && !watched_->keep(time)) return false;
  if (SimulatedSource* simulated = input_.simulated(); simulated && watched_ && setup_ && request_.watch->ordered) {
    if (auto order = request_.watch->ordered()) simulated->order(*std::move(order), setup_->plan);
  }
  onboard_.on_event(std::move(event));
  if (live_ && live_->keep(onboard_)) display_.settle();
  first_ = std::min(first_, time);
  last_ = std::max(last_, time);
  if (request_.progress)
    request_.progress(input_.report(), is_live() ? PipelineCounts{} : onboard_.pipeline().counts());
  note_servo(time);
  mission_over_ = !steer();
  onboard_.beside().enter(Stage::kReport);
  show(time);
  onboard_.beside().leave();
  return !mission_over_ || request_.vehicle.has_value();
}

void VehicleRun::note_servo(Time time) {
  if (!helm_ || !input_.simulated() || is_live() || (servo_due_ && time < *servo_due_)) return;
  const Simulator& simulator = input_.simulated()->simulator();
  const ActuatorVector commands = simulator.actuator_commands();
  if (commands.size() == 0) return;
  servo_due_ = time + kExecutorCycle;
  levels_.on_servo(time, helm_->served());
  if (display_.on()) display_.servo(time, helm_->served(), {commands, actuator_text(simulator.vehicle(), commands)});
}

bool VehicleRun::steer() {
  if (!helm_) return true;
  if (SimulatedSource* simulated = input_.simulated()) return steer_simulated(onboard_, *helm_, *simulated, end_);
  const Setpoint setpoint = onboard_.steer();
  if (!request_.aboard) return true;
  steer_aboard(setpoint);
  return !request_.aboard->options().ends_with_mission || !end_.reached(helm_->progress().phase, to_seconds(last_));
}

void VehicleRun::steer_aboard(const Setpoint& setpoint) {
  Aboard& aboard = *request_.aboard;
  if (request_.watch && request_.watch->ordered) {
    if (auto order = request_.watch->ordered()) aboard.order(*std::move(order));
  }
  aboard.speak_for_operator(*helm_, last_);
  aboard.steer(setpoint, last_);
  if (const auto command = onboard_.take_scan_command()) aboard.scan(*command);
  aboard.tell(*helm_, last_);
}

void VehicleRun::show(Time time) {
  if (!display_.on()) return;
  if (display_.wants_scene(time)) {
    show_scene(time);
    if (helm_) display_.show(time, onboard_.timings(), onboard_.lost_pings());
  }
  if (!is_live()) display_.look(time, onboard_.pipeline(), depths_, onboard_.voxels());
  display_.sample(time);
}

/// Shows the scene once, and again when it has changed: a body moved, or the origin or the datum became known.
void VehicleRun::show_scene(Time time) {
  const auto origin = input_.origin();
  const std::string& datum = is_live() ? live_datum_ : depths_.facts().datum;
  const Simulator* simulator = input_.simulator();
  const auto bodies = simulator ? simulator->world().bodies() : std::span<const WorldBody>();
  const bool moved = std::any_of(bodies.begin(), bodies.end(), [](const WorldBody& body) { return body.moves; });
  const MissionInForce::Given given = in_force_.given();
  const bool same = scene_ && scene_->mission == given.number && scene_->origin == origin;
  if (same && !moved && scene_->depth_datum == datum) return;
  if (!scene_) {
    scene_.emplace();
    scene_->source = request_.input.empty() ? "embedded scene" : request_.input.filename().string();
    scene_->title = scene_->source;
    scene_->safe_m = request_.configuration.mission.route.clearance_m;
    scene_->simulated = simulator != nullptr;
    if (setup_) {
      if (!setup_->plan.title.empty()) scene_->title = setup_->plan.title;
      if (setup_->chart.objects) scene_->charted = *setup_->chart.objects;
      scene_->vehicle_length_m = 2 * setup_->vehicle.hull_radius_m;
      scene_->vehicle_radius_m = setup_->vehicle.half_width_m;
    } else if (simulator) {
      scene_->title = simulator->scene().about.title;
    }
  }
  if (given.plan) scene_->plan = *given.plan;
  scene_->mission = given.number;
  scene_->origin = origin;
  scene_->depth_datum = datum;
  if (simulator) scene_->bodies = outlines_of(simulator->world());
  display_.show(time, *scene_);
}

MissionOutcome VehicleRun::mission_outcome() {
  MissionOutcome mission;
  mission.plan = *in_force_.given().plan;
  mission.report = helm_->progress();
  mission.decisions = helm_->decisions();
  mission.believed = notes_.believed();
  mission.seen = notes_.seen();
  mission.charted = notes_.charted();
  mission.mapped = notes_.mapped();
  mission.timings = onboard_.timings();
  mission.executor = helm_->executor_counts();
  mission.crew = helm_->crew();
  mission.levels = levels_.outcome();
  if (cycles_) mission.timings.cycle = cycles_->departures();
  if (SimulatedSource* simulated = input_.simulated()) {
    mission.truth = track_->truth();
    mission.bodies = outlines_of(simulated->simulator().world());
    if (const SimulatedOperator* at_the_link = simulated->at_the_link()) mission.answers = at_the_link->answers();
  } else if (request_.aboard || input_.report().details.contains(kLiveDetail)) {
    return mission;  // live runs are not deterministic: their decisions are not compared
  } else if (const auto recorded = compare_with_log(mission.decisions, request_.input)) {
    mission.recorded = recorded->decisions;
    mission.as_recorded = recorded->the_same;
  }
  return mission;
}

/// The radius of the vehicle with the water that it must keep clear.
double VehicleRun::vehicle_radius_m() const {
  constexpr double kUnknownVehicle_m = 0.5;
  return (setup_ ? setup_->vehicle.half_width_m : kUnknownVehicle_m) +
         request_.configuration.mission.chart_room.clearance_m;
}

void VehicleRun::add_voxels(RunOutcome& outcome) {
  constexpr std::uint64_t kJudged = 500'000;
  const VoxelModel& voxels = onboard_.voxels();
  outcome.voxels = voxels.outcome();
  if (voxels.save()) outcome.files.emplace_back("voxels.sqlite");
  if (!judge_) return;
  const std::uint64_t every = 1 + outcome.voxels->seen / kJudged;
  outcome.voxels->truth = judge(*voxels.map(), input_.simulator()->world(), every);
}

}  // namespace isobath
