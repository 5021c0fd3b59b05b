#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/sim/camera_simulator.hpp>
#include <isobath/sim/simulator.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kStep = 0.02, kTruthInterval = 0.1, kHealthInterval = 1, kNear = 10;
constexpr double kPartSilent = 0.5, kPartPeriods = 5;  // s, periods: a sensor that is silent longer has failed
constexpr double kSteered_s = 1;                       // s, for which a steered body goes on with its velocity
constexpr double kDiveMemory = 20;                     // s: correlation time of the noise on a dive

enum : std::uint64_t {
  kSensorSeed = 1,
  kNavigatorSeed,
  kFaultSeed,
  kDiveSeed,
  kSonarSeed,
  kHydrophoneSeed,
  kTextureSeed
};

/// A vehicle that follows its set-points instantly, for scenes without a vehicle file.
VehicleModel point_vehicle() {
  VehicleModel model;
  model.name = "point";
  model.length = 0.5;
  model.width = 0.5;
  model.height = 0.3;
  model.mass = 30;
  model.volume = model.mass / 1000;
  model.inertia_B = Eigen::Matrix3d::Identity();
  model.limits.max_speed = 10;
  model.limits.max_acceleration = 10;
  model.limits.turning_radius = 0;
  model.limits.max_yaw_rate = Angle::degrees(90);
  model.limits.max_climb_rate = 2;
  return model;
}

Scene checked(Scene scene) {
  check(scene);
  return scene;
}

VehicleState start_of(const VehicleConfig& c) {
  VehicleState state;
  state.X_WB = {Rotation::from_heading(c.heading), c.start};
  state.v_B = {c.speed, 0, 0};
  return state;
}

LineOfSight guidance_of(const Scene& scene) {
  std::vector<Waypoint> points;
  for (const WaypointConfig& w : scene.waypoints) {
    points.push_back({w.north, w.east, w.depth, w.speed > 0 ? w.speed : scene.vehicle.speed});
  }
  GuidanceConfig config;
  if (scene.water.current.empty()) config.integral_gain = config.drift_time = 0;  // no current to compensate
  return LineOfSight(config, std::move(points));
}

}  // namespace

std::vector<Field> fields(SimulationConfig& c) {
  return {Field::integer("seed", &c.seed, {-1, 2147483647}, "", "Seed of all random numbers; -1: the scene's seed."),
          Field::real("duration_s", &c.duration_s, {0, 1e6}, "s", "Length of the run; 0: the scene's duration."),
          Field::text("without", &c.without, "Name of a sonar of the scene to switch off; empty: none.")};
}

VehicleModel vehicle_model_of(const Scene& scene) {
  VehicleModel model = scene.vehicle.file.empty() ? point_vehicle() : load_vehicle(scene.vehicle.file);
  model.autopilot.control = scene.vehicle.control.value_or(model.autopilot.control);
  return model;
}

/// A sonar with its clock and its faults.
struct Simulator::Device {
  Device(const SonarConfig& config, const World& world, const Water& water, std::uint64_t seed, int threads,
         const FaultSchedule& faults, const std::string& fault_name)
      : name(fault_name),
        configured(config),
        sonar(config, world, water, seed, threads),
        pings(faults, fault_name),
        ranges(faults, fault_name) {}
  std::string name;
  SonarConfig configured;
  SimulatedSonar sonar;
  FaultyChannel<Ping> pings;
  FaultyChannel<RangeReading> ranges;
  Time due{};
  std::uint64_t number = 0;
};

/// A pair of cameras with its clock.
struct Simulator::Cameras {
  Cameras(const CameraPairConfig& config, std::size_t number) : rig(number), calibration(cameras_of(config)) {
    interval = seconds(1 / config.rate_hz);
    X_BC = looking_ahead(config.X_BL());
    noise = config.noise;
  }
  [[nodiscard]] CameraPair take(const CameraSimulator& simulator, const Pose& X_WB) {
    CameraOptics optics{calibration.left, calibration.in_water, calibration.port, calibration.light, noise};
    optics.isoluminant = calibration.isoluminant;
    const Pose X_WC = X_WB * X_BC;
    CameraPair pair{due, simulator.take(optics, X_WC, exposures), {}, rig};
    optics.model = calibration.right;
    pair.right = simulator.take(optics, X_WC * calibration.X_LR(), exposures + 1);
    exposures += 2;
    return pair;
  }
  std::size_t rig;
  StereoCalibration calibration;
  Duration interval{};
  Pose X_BC;  ///< of the left camera: right, down, forward
  double noise = 1;
  Time due{};
  std::uint64_t exposures = 0;
};

Simulator::Simulator(Scene scene, const SimulationConfig& config, int threads)
    : scene_(checked(std::move(scene))),
      seed_(static_cast<std::uint64_t>(config.seed >= 0 ? config.seed : scene_.about.seed)),
      duration_s_(config.duration_s > 0 ? config.duration_s : scene_.about.duration_s),
      water_(scene_.water, scene_.water_place),
      world_(std::make_unique<World>(scene_)),
      model_(vehicle_model_of(scene_)),
      plant_(make_plant(model_, scene_.vehicle.dynamic ? PlantKind::kDynamic : PlantKind::kKinematic,
                        start_of(scene_.vehicle), scene_.plant, scene_.control_model)),
      faults_(scene_.faults, random_at(seed_, kFaultSeed, 0).bits()),
      sensors_(scene_.navigation, random_at(seed_, kSensorSeed, 0).bits()),
      navigator_(scene_.navigator, scene_.navigation, random_at(seed_, kNavigatorSeed, 0).bits()),
      threads_(threads),
      fix_channel_(faults_, "navigation"),
      waves_(random_at(seed_, kDiveSeed, 0)) {
  if (!config.without.empty()) switch_off(scene_, config.without);
  check_length(scene_, duration_s_);
  if (!scene_.waypoints.empty()) guidance_.emplace(guidance_of(scene_));
  const std::vector<std::string> names = fault_names(scene_.sonars);
  for (std::size_t i = 0; i < scene_.sonars.size(); ++i) {
    if (!scene_.sonars[i].on) continue;
    devices_.push_back(std::make_unique<Device>(scene_.sonars[i], *world_, water_,
                                                random_at(seed_, kSonarSeed, i).bits(), threads, faults_, names[i]));
  }
  for (std::size_t i = 0; i < scene_.cameras.size(); ++i) {
    if (scene_.cameras[i].on) cameras_.emplace_back(scene_.cameras[i], i);
  }
  for (const char* source : {"compass", "ahrs", "gyro", "dvl", "depth", "gps", "lbl"}) {
    reading_channels_.emplace_back(source, FaultyChannel<NavReading>(faults_, source));
  }
  if (scene_.hydrophones.on) {
    hydrophones_.emplace(scene_.hydrophones, scene_.sounds, *world_, water_, seed_at(seed_, kHydrophoneSeed, 0));
  }
  watch_parts();
  near_.resize(world_->bodies().size());
  state_before_ = plant_->state();
  check_start();
}

Simulator::~Simulator() = default;

double Simulator::hull_radius() const { return 0.5 * std::hypot(model_.length, model_.width); }

void Simulator::check_start() const {
  if (!scene_.group.empty()) {
    throw Error(fmt::format("the scene has {} vehicles", scene_.group.size() + 1), scene_.group.front().place,
                "one vehicle for this command; isobath run takes several");
  }
  const Eigen::Vector3d p = scene_.vehicle.start;
  Place here = scene_.vehicle.place;
  here.key = "vehicle.start";
  const auto bottom = world_->bottom_depth(p.x(), p.y());
  if (bottom && p.z() >= *bottom) {
    throw Error(fmt::format("the vehicle starts {:.1f} m deep, where the bottom is {:.1f} m deep", p.z(), *bottom),
                here);
  }
  const auto bodies = world_->bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double clear = world_->distance(static_cast<int>(i), p);
    if (clear < hull_radius()) {
      throw Error(fmt::format("{} is inside the vehicle: {:.2f} m from its middle", bodies[i].name, clear),
                  bodies[i].body->place, fmt::format("at least {:.2f} m from [vehicle] start", hull_radius()));
    }
  }
}

void Simulator::steer_body(std::size_t body, double t_s, const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W) {
  std::vector<double>& path = scene_.bodies.at(body).path;
  ISOBATH_ASSERT(path.size() >= 8 && path[0] < t_s);
  const Eigen::Vector3d then_W = p_W + kSteered_s * v_W;
  path.resize(4);  // displacements count from the first row
  for (const auto& [time_s, at_W] : {std::pair{t_s, p_W}, std::pair{t_s + kSteered_s, then_W}}) {
    path.insert(path.end(), {time_s, at_W.x(), at_W.y(), at_W.z()});
  }
}

std::optional<SimulatedEvent> Simulator::next() {
  while (queue_.empty()) {
    if (to_seconds(now_) >= duration_s_) return std::nullopt;
    step();
  }
  std::optional<SimulatedEvent> event(std::move(queue_.front()));
  queue_.pop_front();
  return event;
}

void Simulator::step() {
  if (started_) {
    state_before_ = plant_->state();
    before_ = now_;
    move(kStep);
    now_ += seconds(kStep);
  }
  started_ = true;
  watch_for_events();
  for (; next_truth_ <= now_; next_truth_ += seconds(kTruthInterval)) truth(next_truth_);
  navigate();
  ping_all();
  listen();
  take_pictures();
  report_health();
}

// The vehicle --------------------------------------------------------------------------------------------------------

Setpoint Simulator::wanted(double dt) {
  const VehicleConfig& v = scene_.vehicle;
  Setpoint setpoint{v.heading, v.start.z(), v.speed};
  if (command_) return *command_;
  if (guidance_) setpoint = guidance_->step(plant_->state(), dt);
  if (v.dive_noise > 0) {
    const double keep = std::exp(-dt / kDiveMemory);
    dive_noise_ = keep * dive_noise_ + std::sqrt(1 - keep * keep) * v.dive_noise * waves_.normal();
  }
  const double phase = 2 * std::numbers::pi * to_seconds(now_) / v.dive_period_s;
  setpoint.depth = std::max(0.0, setpoint.depth + v.dive_amplitude * std::sin(phase) + dive_noise_);
  return setpoint;
}

void Simulator::move(double dt) {
  Setpoint setpoint = wanted(dt);
  const VehicleFaults broken = faults_.vehicle_faults(now_);
  const int thrusters = static_cast<int>(model_.thrusters.size());
  const Pose& pose = plant_->state().X_WB;
  const Eigen::Vector3d current = water_.current(pose.translation.z());
  if (auto* dynamic = dynamic_cast<DynamicVehicle*>(plant_.get())) {
    for (int i = 0; i < thrusters; ++i) {
      dynamic->dynamics().set_effectiveness(i, broken.thrust_share[static_cast<std::size_t>(i)]);
    }
  } else {  // thrust grows with the square of the speed through the water
    const double set = (pose.rotation.inverse() * current).x();
    setpoint.speed = set + std::sqrt(broken.thrust_share[0]) * (setpoint.speed - set);
  }
  plant_->step(setpoint, {water_.density(), current}, dt);
}

VehicleState Simulator::state_at(Time time) const {
  const VehicleState& after = plant_->state();
  if (now_ <= before_ || time >= now_) return after;
  const double share = to_seconds(time - before_) / to_seconds(now_ - before_);
  return {interpolate(state_before_.X_WB, after.X_WB, share),
          state_before_.v_B + share * (after.v_B - state_before_.v_B),
          state_before_.w_B + share * (after.w_B - state_before_.w_B)};
}

void Simulator::watch_for_events() {
  if (guidance_) {
    for (; waypoint_ < guidance_->next(); ++waypoint_) faults_.raise(fmt::format("waypoint {}", waypoint_ + 1), now_);
  }
  const Eigen::Vector3d p = plant_->state().X_WB.translation;
  const auto bodies = world_->bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Eigen::AlignedBox3d box = bodies[i].box;
    box.translate(bodies[i].moved);
    if (near_[i] || box.exteriorDistance(p) > kNear) continue;
    near_[i] = true;
    faults_.raise("near " + bodies[i].name, now_);
  }
}

// Output -------------------------------------------------------------------------------------------------------------

void Simulator::put(SimulatedEvent event) {
  const Duration offset = faults_.vehicle_faults(now_).clock_offset;
  struct Shift {
    Duration by;
    void operator()(Ping& e) const { e.time += by; }
    void operator()(RangeReading& e) const { e.time += by; }
    void operator()(Navigation& e) const { e.time += by; }
    void operator()(Health& e) const { e.time += by; }
    void operator()(PassiveBearing& e) const { e.time += by; }
    void operator()(CameraPair& e) const { e.time += by; }
    void operator()(EchoTruth& e) const { e.time += by; }  // keeps the time of its ping
    void operator()(TrueMotion&) const {}
  };
  if (offset.count() != 0) std::visit(Shift{offset}, event);
  queue_.push_back(std::move(event));
}

/// Whether it has delivered anything.
template <class Channel>
bool Simulator::deliver(Channel& channel) {
  bool any = false;
  while (auto reading = channel.pop(now_)) {
    put(std::move(*reading));
    any = true;
  }
  return any;
}

void Simulator::truth(Time time) {
  TrueMotion motion{time, state_at(time), std::nullopt, {}};
  const Eigen::Vector3d& p = motion.state.X_WB.translation;
  if (const auto bottom = world_->bottom_depth(p.x(), p.y())) motion.altitude_m = *bottom - p.z();
  motion.current_W = water_.current(p.z());
  put(std::move(motion));
}

void Simulator::navigate() {
  const VehicleState& state = plant_->state();
  const Eigen::Vector3d& p = state.X_WB.translation;
  std::vector<NavReading> arrived;
  if (scene_.navigator.kind != NavigatorKind::kTruth) {
    NavigationScene around{std::nullopt, water_.sound_speed(p.z()), water_.current(p.z())};
    if (const auto bottom = world_->bottom_depth(p.x(), p.y())) around.altitude_m = *bottom - p.z();
    for (const NavReading& reading : sensors_.advance(now_, state, around)) {
      const auto channel = std::find_if(reading_channels_.begin(), reading_channels_.end(),
                                        [&reading](const auto& c) { return c.first == reading.source; });
      channel->second.push(now_, reading);
    }
    for (auto& [name, channel] : reading_channels_) {
      while (auto reading = channel.pop(now_)) {
        if (const auto part = parts_.find(name); part != parts_.end()) part->second.heard = now_;
        arrived.push_back(std::move(*reading));
      }
    }
  }
  for (const Navigation& fix : navigator_.advance(now_, state, arrived)) fix_channel_.push(now_, fix);
  deliver(fix_channel_);
}

void Simulator::command_scanning(const ScanCommand& scan) {
  for (const auto& device : devices_) {
    if (device->sonar.config().kind != SonarKind::kScanning) continue;
    if (scan.as_configured) device->sonar.command(settings_of(device->configured));
    return device->sonar.command(scan);
  }
}

void Simulator::ping_all() {
  const auto earliest = [this]() -> Device* {
    Device* first = nullptr;
    for (const auto& device : devices_) {
      if (device->due <= now_ && (!first || device->due < first->due)) first = device.get();
    }
    return first;
  };
  while (Device* device = earliest()) {
    world_->move_to(to_seconds(device->due));
    auto heard = device->sonar.ping(device->due, state_at(device->due).X_WB, device->number++);
    device->due += device->sonar.interval();
    if (!heard.truth.labels.empty()) put(std::move(heard.truth));
    if (heard.ping) device->pings.push(now_, std::move(*heard.ping));
    for (RangeReading& reading : heard.ranges) device->ranges.push(now_, std::move(reading));
  }
  for (const auto& device : devices_) {
    deliver(device->pings);
    if (deliver(device->ranges)) {
      if (const auto part = parts_.find(device->name); part != parts_.end()) part->second.heard = now_;
    }
  }
}

/// The passive array hears what sounds.
void Simulator::listen() {
  if (!hydrophones_) return;
  for (; next_bearings_ <= now_; next_bearings_ += hydrophones_->interval()) {
    world_->move_to(to_seconds(next_bearings_));
    for (const PassiveBearing& heard : hydrophones_->listen(next_bearings_, state_at(next_bearings_), bearings_++)) {
      put(heard);
    }
  }
}

void Simulator::take_pictures() {
  for (Cameras& cameras : cameras_) {
    for (; cameras.due <= now_; cameras.due += cameras.interval) {
      world_->move_to(to_seconds(cameras.due));
      const CameraSimulator simulator(*world_, seed_at(seed_, kTextureSeed, 0), threads_);
      put(cameras.take(simulator, state_at(cameras.due).X_WB));
    }
  }
}

void Simulator::report_health() {
  if (faults_.active("health", now_)) {
    while (next_health_ <= now_) next_health_ += seconds(kHealthInterval);
    return;
  }
  for (; next_health_ <= now_; next_health_ += seconds(kHealthInterval)) {
    const VehicleFaults broken = faults_.vehicle_faults(now_);
    const double used = to_seconds(now_) / (3600 * scene_.vehicle.endurance_h);
    Health health{next_health_, "vehicle", HealthState::kOk, 1, broken.leak, {}};
    health.battery_share = static_cast<float>(std::clamp(1 - used - broken.battery_lost, 0.0, 1.0));
    const bool weak =
        std::any_of(broken.thrust_share.begin(), broken.thrust_share.end(), [](double s) { return s < 1; });
    if (broken.leak) health.note = "water inside";
    if (weak) health.note += std::string(health.note.empty() ? "" : "; ") + "a thruster gives less than it should";
    if (broken.leak || weak) health.state = HealthState::kDegraded;
    put(std::move(health));
  }
  report_parts();
}

void Simulator::watch_parts() {
  const auto watch = [this](const std::string& source, double period_s) {
    parts_[source].silent_s = std::max(kPartSilent, kPartPeriods * period_s);
  };
  if (scene_.navigator.kind != NavigatorKind::kTruth) {
    const NavigationSensorsConfig& sensors = scene_.navigation;
    if (sensors.depth.on) watch("depth", 1 / sensors.depth.rate_hz);
    if (sensors.compass.on) watch("compass", 1 / sensors.compass.rate_hz);
    if (sensors.ahrs.on) watch("ahrs", 1 / sensors.ahrs.rate_hz);
    if (sensors.gyro.on) watch("gyro", 1 / sensors.gyro.rate_hz);
  }
  for (const auto& device : devices_) {
    if (device->name.starts_with("altimeter")) watch(device->name, to_seconds(device->sonar.interval()));
  }
}

void Simulator::report_parts() {
  for (const auto& [source, part] : parts_) {
    if (!(part.silent_s > 0)) continue;
    const bool silent = to_seconds(now_ - part.heard) > part.silent_s;
    report_part(source, silent ? HealthState::kLost : HealthState::kOk, silent ? "silent" : "");
  }
  bool full = false;
  std::map<std::string, double> weak;  // by the source of the fault
  for (std::size_t i = 0; i < faults_.faults().size(); ++i) {
    const FaultConfig& fault = faults_.faults()[i];
    const bool holds = faults_.active_since(i, now_).has_value();
    if (fault.source == "disk") full = full || holds;
    if (fault.kind == FaultKind::kThrusterLoss) {
      double& lost = weak[fault.source];
      lost = std::max(lost, holds ? fault.amount : 0);
    }
  }
  report_part("disk", full ? HealthState::kLost : HealthState::kOk, full ? "full" : "");
  for (const auto& [source, lost] : weak) {
    const HealthState state = lost >= 1 ? HealthState::kLost : lost > 0 ? HealthState::kDegraded : HealthState::kOk;
    report_part(source, state, lost > 0 ? "gives less than it should" : "");
  }
}

void Simulator::report_part(const std::string& source, HealthState state, const char* note) {
  Part& part = parts_[source];
  const bool again = state != HealthState::kOk && now_ >= part.due;
  if (state == part.state && !again) return;
  part.state = state;
  part.due = now_ + seconds(kHealthInterval);
  Health health{now_, source, state, 1, false, note};
  const double used = to_seconds(now_) / (3600 * scene_.vehicle.endurance_h);
  health.battery_share = static_cast<float>(std::clamp(1 - used - faults_.vehicle_faults(now_).battery_lost, 0.0, 1.0));
  put(std::move(health));
}

}  // namespace isobath
