#include <isobath/base/error.hpp>
#include <isobath/onboard/onboard.hpp>
#include <utility>

namespace isobath {
namespace {

VoxelModelConfig voxels_of(const OnboardConfiguration& configuration, bool wanted) {
  VoxelModelConfig config = configuration.voxels;
  if (!wanted) config.sonars = VoxelModelConfig::Sonars::kNone;
  return config;
}

SphericalModelConfig sphere_of(const OnboardConfiguration& configuration, bool wanted) {
  SphericalModelConfig config = configuration.sphere;
  const auto needs_it = [](const char* key) {
    throw Error("the spherical grid is not kept", {.key = key}, "false, or sphere.keep = true");
  };
  if (!config.keep && configuration.scan.on) needs_it("scan.on");
  if (!config.keep && configuration.mission.chart_room.sphere) needs_it("chart_room.sphere");
  config.keep = config.keep && wanted;
  return config;
}

}  // namespace

Onboard::Onboard(const OnboardConfiguration& configuration, DepthModel& depths, OnboardParts parts)
    : helm_(parts.helm),
      times_(parts.times ? std::move(parts.times) : std::make_shared<StageTimes>()),
      depths_(depths),
      voxels_(voxels_of(configuration, parts.voxels), std::move(parts.voxel_file)),
      sphere_(sphere_of(configuration, parts.sphere)),
      scan_steering_(configuration.scan),
      corner_fixes_(configuration.corner_fix, configuration.sphere.mapper.contrast, std::move(parts.corners)),
      contacts_(configuration.contacts, configuration.mission.memory),
      reach_m_(configuration.mission.space_route.reach_m),
      depths_interval_(seconds(configuration.mission.chart_room.live_s)),
      sphere_steers_(configuration.mission.chart_room.sphere),
      pipeline_(configuration, *this, &depths) {
  pipeline_.watch(&load_);
  if (parts.live) mapping_.emplace(TaskThread::Bounds{kLongestQueue, kLongestQueue, true});
}

// The path of an event -----------------------------------------------------------------------------------------------

void Onboard::on_event(Event event) {
  now_ = time_of(event);
  beside_.enter(Stage::kReport);
  for (OnboardObserver* observer : observers_) observer->on_event(event);
  const std::optional<CornerMove> move = correct(event);
  const auto taken = Clock::now();
  beside_.enter(Stage::kAgents);
  if (helm_) {
    helm_->on_event(event);
    if (move && move->surprises()) helm_->on_decision({{}, "corner fix", "position fix", to_text(*move)});
    times_->heard(Clock::now() - taken);
  }
  beside_.leave();
  if (!mapping_) return map(std::move(event), move, taken);
  mapping_->check();
  const auto kind = std::holds_alternative<Ping>(event) ? TaskThread::Kind::kPing : TaskThread::Kind::kNote;
  mapping_->push(kind, [this, event = std::move(event), move, taken]() mutable { map(std::move(event), move, taken); });
}

/// A fix gets the correction by charted corners. Returns the jump of the position by it.
std::optional<CornerMove> Onboard::correct(Event& event) {
  auto* fix = std::get_if<Navigation>(&event);
  if (!fix) return std::nullopt;
  const std::optional<CornerMove> move = corner_fixes_.correct(*fix);
  for (OnboardObserver* observer : observers_) observer->on_fix(*fix);
  return move;
}

void Onboard::map(Event event, const std::optional<CornerMove>& move, Clock::time_point taken) {
  const Time time = time_of(event);
  const bool is_ping = std::holds_alternative<Ping>(event);
  const std::uint64_t mapped = pipeline_.counts().pings;
  times_->begin(taken);
  const auto begun = Clock::now();
  if (move) {
    pipeline_.jump({move->by.x(), move->by.y(), 0});
    corner_fixes_.follow(*move);
  }
  pipeline_.on_event(std::move(event));
  if (is_ping || pipeline_.counts().pings > mapped) {
    ping_ms_.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begun).count());
  }
  load_.enter(Stage::kAgents);
  tell_depths(time);
  tell_sphere(time);
  tell_contacts(time);
  load_.enter(Stage::kReport);
  for (OnboardObserver* observer : observers_) observer->on_mapped(time, pipeline_, depths_, voxels_);
  load_.leave();
}

/// Planners get the map that grows, not the chart of the start (S1-03).
void Onboard::tell_depths(Time time) {
  if (!helm_ || depths_interval_ <= Duration::zero()) return;
  if (depths_told_ && time - *depths_told_ < depths_interval_) return;
  const DepthCounts& counts = depths_.counts();
  if (counts.readings + counts.soundings == depth_readings_told_) return;
  const auto map = depths_.snapshot();
  if (!map) return;
  depths_told_ = time;
  depth_readings_told_ = counts.readings + counts.soundings;
  world_.depths = map;
  world_.looked_ahead = depths_.looked_ahead();
  helm_->on_world(world_);
}

/// Tells of a scan that has ended since.
void Onboard::tell_sphere(Time time) {
  const auto sphere = sphere_.newest();
  if (!sphere || std::exchange(sphere_told_, sphere->version) == sphere->version) return;
  world_.sphere = sphere;
  if (helm_ && sphere_steers_) helm_->on_world(world_);
  load_.enter(Stage::kReport);
  for (OnboardObserver* observer : observers_) observer->on_sphere(time, sphere);
}

/// Tells which obstacles the sounds come from, if they have been judged anew.
void Onboard::tell_contacts(Time time) {
  load_.enter(Stage::kObstacles);
  if (!contacts_.update(time)) return;
  load_.enter(Stage::kAgents);
  for (const Decision& decision : contacts_.news()) {
    if (helm_) helm_->on_decision(decision);
  }
  load_.enter(Stage::kReport);
  for (OnboardObserver* observer : observers_) observer->on_contacts(time, contacts_.contacts());
}

Setpoint Onboard::steer() {
  beside_.enter(Stage::kAgents);
  const Setpoint setpoint = helm_->steer();
  if (helm_->take_acknowledgement()) {
    pipeline_.acknowledge_alarms();
    depths_.acknowledge_alarms();
  }
  if (const auto order = helm_->take_sonar_order()) {
    const std::lock_guard lock(scan_mutex_);
    scan_ordered_ = order->scan.has_value();
    scan_command_ = order->scan.value_or(ScanCommand{.as_configured = true});
  }
  beside_.enter(Stage::kReport);
  for (OnboardObserver* observer : observers_) observer->on_setpoint(now_, setpoint);
  beside_.leave();
  return setpoint;
}

std::optional<ScanCommand> Onboard::take_scan_command() {
  const std::lock_guard lock(scan_mutex_);
  return std::exchange(scan_command_, std::nullopt);
}

void Onboard::settle() {
  if (mapping_) {
    mapping_->settle();
    mapping_->check();
  }
  if (helm_) helm_->settle();
}

void Onboard::finish() {
  pipeline_.finish();
  sphere_.end_scan();
  tell_sphere(now_);
  if (contacts_.update(now_, true)) {
    for (OnboardObserver* observer : observers_) observer->on_contacts(now_, contacts_.contacts());
  }
  load_.leave();
  depths_.finish(depths_.snapshot() ? voxels_.tops() : std::vector<ColumnTop>{});
  settle();
}

// Results of the pipeline --------------------------------------------------------------------------------------------

void Onboard::on_ping(const PosedPing& ping) {
  times_->mapped();
  load_.enter(Stage::kAgents);
  if (helm_) helm_->on_ping(ping);
  times_->aside();
  load_.enter(Stage::kVoxels);
  voxels_.update(ping);
  load_.enter(Stage::kSphere);
  sphere_.update(ping);
  scan_steering_.on_ping(ping.ping);
  corner_fixes_.on_ping(ping);
  load_.enter(Stage::kReport);
  for (OnboardObserver* observer : observers_) observer->on_ping(ping);
  times_->resume();
}

void Onboard::on_scan(const ScanResult& scan) {
  load_.enter(Stage::kSphere);
  sphere_.end_scan();
  corner_fixes_.on_sweep(scan.posed);
  contacts_.on_scan(scan, pipeline_.position_sigma_m());
  if (sphere_.grid()) {
    if (const auto command = scan_steering_.on_sweep(*sphere_.grid(), scan.detection.X_WB)) {
      const std::lock_guard lock(scan_mutex_);
      if (!scan_ordered_) scan_command_ = command;
    }
  }
  load_.enter(Stage::kVoxels);
  const auto space = voxels_.space_around(scan, reach_m_);
  if (space) world_.voxels = space;
  times_->detected(scan.detection.time);
  load_.enter(Stage::kAgents);
  if (helm_ && space) helm_->on_world(world_);
  if (helm_) helm_->on_scan(scan);
  times_->aside();
  load_.enter(Stage::kReport);
  for (OnboardObserver* observer : observers_) observer->on_scan(scan);
  times_->resume();
}

void Onboard::on_vertical_ping(const PosedPing& ping) {
  load_.enter(Stage::kVoxels);
  voxels_.update(ping);
  load_.enter(Stage::kSphere);
  sphere_.update(ping);
  load_.enter(Stage::kReport);
  for (OnboardObserver* observer : observers_) observer->on_vertical_ping(ping);
}

void Onboard::on_reading(const RangeReading& reading, const Pose& X_WB) {
  load_.enter(Stage::kSphere);
  sphere_.update(reading, X_WB);
  load_.enter(Stage::kDepths);
}

void Onboard::on_bearing(const PassiveBearing& heard, const ListeningPose& pose) { contacts_.on_bearing(heard, pose); }

void Onboard::on_soundings(const Swath& swath, const Pose& X_WB) {
  load_.enter(Stage::kVoxels);
  voxels_.update(swath, X_WB);
  load_.enter(Stage::kSphere);
  sphere_.update(swath, X_WB);
  load_.enter(Stage::kReport);
  for (OnboardObserver* observer : observers_) observer->on_soundings(swath, X_WB);
}

void Onboard::on_jump(const Eigen::Vector3d& by_W) {
  voxels_.move_along(by_W);
  sphere_.move_along(by_W);
  corner_fixes_.on_jump(by_W);
  contacts_.on_jump(by_W.head<2>());
  world_.voxels.reset();
  if (helm_) helm_->on_jump(by_W);
  for (OnboardObserver* observer : observers_) observer->on_jump(by_W);
}

}  // namespace isobath
