#include <algorithm>
#include <cmath>
#include <isobath/base/round_step.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/sonar/fan_stance.hpp>

namespace isobath {
namespace {

// Chosen on two harbour recordings. A wall or bottom that a beam grazes fills tens of bins and would become its own
// reference. A voxel spans hundreds of cells, and none of them may hold a false echo. The transmission rings for up to
// 1 m.
constexpr double kSounderFalseAlarm = 1e-4, kSounderBlind = 1;
constexpr int kSounderGuard = 16, kSounderReference = 48;
constexpr std::size_t kMaxWaiting = 256;  // measurements held for a fix; beyond it the oldest is placed without one

SonarModels models_of(const SensorConfig& sensor) {
  if (sensor.model.empty()) return {};
  const std::string text = text_of_file(sensor.model);
  if (!looks_like_fan_model(text)) return {read_sensor_model(text, sensor.model), nullptr};
  return {std::nullopt, std::make_shared<const FanModel>(read_fan_model(text, sensor.model))};
}

using Ratios = std::shared_ptr<const LikelihoodRatios>;

Ratios ratios_of(const std::string& file) {
  if (file.empty()) return nullptr;
  return std::make_shared<const LikelihoodRatios>(std::make_shared<const HistogramModel>(load_histogram_model(file)));
}

bool leaves_method_open(const OnboardConfiguration& configuration, const SonarModels& models, const Ratios& ratios) {
  return configuration.echoes.method == DetectionMethod::kAutomatic && !models.sensor && !ratios;
}

/// A vertical fan receives the bottom in some beams only, and at a different range in each: the background across the
/// beams is not usable.
EchoDetectorConfig for_vertical(const OnboardConfiguration& configuration, const SonarModels& models,
                                const Ratios& ratios) {
  EchoDetectorConfig echoes = configuration.echoes;
  if (leaves_method_open(configuration, models, ratios)) echoes.method = DetectionMethod::kLearnt;
  return echoes;
}

EchoDetectorConfig for_sounder(const OnboardConfiguration& configuration, const SonarModels& models,
                               const Ratios& ratios) {
  EchoDetectorConfig echoes = configuration.echoes;
  if (!leaves_method_open(configuration, models, ratios)) return echoes;
  echoes.method = DetectionMethod::kOrderedStatistic;
  echoes.false_alarm = std::min(echoes.false_alarm, kSounderFalseAlarm);
  echoes.blanking_m = std::max(echoes.blanking_m, kSounderBlind);
  echoes.cfar.guard = kSounderGuard;
  echoes.cfar.reference = kSounderReference;
  return echoes;
}

/// About 100 cells each way from the vehicle in the middle, about 200 for a fan, whose beams are narrower. A
/// cell of a scanning head that n bins cross receives n times as many false echoes, and two of them look like a target:
/// the prior is lowered by n squared, yet stays so far above p_min that a cell can become free.
BodyGridConfig fitted(BodyGridConfig grid, const RangeWindow& window, bool fan) {
  const double reach_m = window.end_m();
  grid.cell_m = fan ? round_step(reach_m / 200, {1, 1.5, 2, 3, 5, 7}) : round_step(reach_m / 100, {1, 2, 5});
  grid.cells_x = grid.cells_y = 2 * static_cast<int>(std::ceil(1.05 * reach_m / grid.cell_m)) + 1;
  grid.home_x = grid.home_y = 0.5;
  if (!fan) {
    const double bins = std::max(1.0, grid.cell_m / window.bin_m);
    grid.prior = std::min(grid.prior, std::max(4 * grid.p_min, grid.prior / (bins * bins)));
  }
  return grid;
}

constexpr const char* kNoBearing = "passive bearing without any navigation: no position";
constexpr const char* kNoPlace = "range or sounding without any navigation: no position in the depth map";

/// Joins the moving bodies to the still obstacles of a scan, nearest first.
void add_moving(std::vector<Obstacle>& obstacles, std::vector<Obstacle> moving) {
  int last = 0;
  for (const Obstacle& o : obstacles) last = std::max(last, o.number);
  for (Obstacle& o : moving) {
    o.number = ++last;
    obstacles.push_back(std::move(o));
  }
  const auto nearer = [](const Obstacle& a, const Obstacle& b) { return a.range_m < b.range_m; };
  std::stable_sort(obstacles.begin(), obstacles.end(), nearer);
}

bool grid_fits(const BodyGridConfig& grid, double reach_m) {
  const double half = 0.5 * grid.cell_m * std::min(grid.cells_x, grid.cells_y);
  return reach_m <= half && reach_m > half / 4;
}

}  // namespace

Pipeline::Pipeline(const OnboardConfiguration& configuration, ResultSink& sink, SoundingSink* depths)
    : configuration_(configuration),
      sink_(sink),
      depths_(depths),
      alarms_(configuration.collision, configuration.state),
      gate_(configuration.gate),
      poses_(configuration.poses),
      ratios_(ratios_of(configuration.sensor.histogram)),
      vertical_ratios_(configuration.sensor.histogram_vertical.empty()
                           ? ratios_
                           : ratios_of(configuration.sensor.histogram_vertical)),
      models_(models_of(configuration.sensor)),
      echoes_(configuration.echoes, models_.sensor, ratios_, models_.fan),
      vertical_echoes_(for_vertical(configuration, models_, vertical_ratios_), models_.sensor, vertical_ratios_),
      sounder_echoes_(for_sounder(configuration, models_, ratios_), models_.sensor, ratios_),
      soundings_(configuration.map.sounding_band_m),
      sweeps_(configuration.map.fan_scan_s),
      bodies_(configuration.bodies),
      detector_(configuration.obstacles) {
  waiting_.reserve(kMaxWaiting);
}

Pipeline::~Pipeline() = default;

// What happens to an event -------------------------------------------------------------------------------------------

EchoDetector& Pipeline::detector_of(const Ping& ping) {
  return lies_flat(ping) ? echoes_ : looks_down(ping) ? sounder_echoes_ : vertical_echoes_;
}

bool Pipeline::listen(const Ping& ping) {
  if (check(ping) != PingFault::kNone) return false;
  return detector_of(ping).listen(ping);
}

void Pipeline::end_learning() {
  echoes_.end_learning();
  vertical_echoes_.end_learning();
  sounder_echoes_.end_learning();
}

void Pipeline::on_event(Event event) {
  enter(Stage::kDepths);
  alarms_.on_event(event);                  // raw ranges and health: first, so that nothing delays an alarm
  const auto verdict = gate_.judge(event);  // finite, in order, fresh; else rejected and counted by reason
  if (verdict == EventGate::Verdict::kRejected) return;
  if (verdict == EventGate::Verdict::kRestarted) restart();
  const Time now = time_of(event);
  if (const auto* fix = std::get_if<Navigation>(&event)) add_fix(*fix);
  if (auto* ping = std::get_if<Ping>(&event)) hold(std::move(*ping));
  if (auto* range = std::get_if<RangeReading>(&event)) hold(std::move(*range));
  if (auto* swath = std::get_if<Swath>(&event)) hold(std::move(*swath));
  if (const auto* heard = std::get_if<PassiveBearing>(&event)) hold(*heard);
  release(now, false);
}

// What happens to a ping whose pose is known -------------------------------------------------------------------------

void Pipeline::map_ping(const Ping& ping, const Pose& X_WB, bool posed) {
  enter(Stage::kEchoes);
  if (!lies_flat(ping)) return map_vertical(ping, X_WB, posed);
  fit_map(ping, posed);                                   // a grid of the sonar's size
  const WaterColumn water = water_at(ping, X_WB, posed);  // where bottom and surface are
  echoes_.detect(ping, decisions_, water);                // intensities -> decisions
  enter(Stage::kPlane);
  if (posed) take_bodies(ping, decisions_, echoes_.looks(), X_WB);  // echoes of bodies that move -> tracks
  const PosedPing posed_ping{ping, X_WB, decisions_, echoes_.looks()};
  update_grid(posed_ping.look_ping(), posed_ping.look_decisions(), X_WB, posed);
  sink_.on_ping(posed_ping);
  enter(Stage::kPlane);
  count(decisions_);
  counts_.no_bottom += water.above_bottom_m ? 0 : 1;
  counts_.dead_reckoned += motion_is_measured(posed) ? 0 : 1;
  note_mapped(ping, X_WB, posed, water);  // at the end of a scan: body grid -> obstacles
}

/// Tracks the bodies, and takes the echoes of those that move out of the decisions, so that no map keeps them.
void Pipeline::take_bodies(const Ping& ping, EchoDecisions& decisions, FanLooks* looks, const Pose& X_WB) {
  std::optional<MovingBodies::Water> water;
  if (mapper_ && last_) water.emplace(MovingBodies::Water{mapper_->grid(), last_->from.X_WB});
  bodies_.look(looks ? looks->ping : ping, looks ? looks->decisions : decisions, X_WB, water);
  counts_.of_moving += bodies_.withhold(ping, X_WB, decisions);
  if (looks) bodies_.withhold(looks->ping, X_WB, looks->decisions);
}

void Pipeline::map_vertical(const Ping& ping, const Pose& X_WB, bool posed) {
  const bool sounds = looks_down(ping);
  WaterColumn water = water_at(ping, X_WB, posed);
  if (sounds) water.above_bottom_m.reset();
  detector_of(ping).detect(ping, decisions_, water);
  if (sounds && leaves_method_open(configuration_, models_, ratios_)) side_lobes_.leave_out(ping, decisions_);
  sink_.on_vertical_ping({ping, X_WB, decisions_});
  ++counts_.vertical;
}

// What happens to ranges and soundings whose pose is known -----------------------------------------------------------

/// A sounding in the water is an echo that the sonar has decided itself.
void Pipeline::map_soundings(const Swath& swath, const Pose& X_WB, bool posed) {
  sink_.on_soundings(swath, X_WB);
  enter(Stage::kPlane);
  if (!soundings_.update(swath, X_WB)) return;
  const Ping& ping = soundings_.ping();
  if (!mapper_ || counts_.pings == 0) fit_map(ping, posed);  // where a sonar with pings has made the grid, it stays
  if (posed) take_bodies(ping, soundings_.decisions(), nullptr, level(X_WB));
  update_grid(ping, soundings_.decisions(), level(X_WB), posed);
  note_mapped(ping, X_WB, posed, water_at(ping, X_WB, posed));
}

void Pipeline::map_depth(const Waiting& sensed, const PoseEstimate& pose) {
  if (const auto* range = std::get_if<RangeReading>(&sensed)) depths_->on_range(*range, pose);
  const auto* swath = std::get_if<Swath>(&sensed);
  if (swath && !swath->is_flat()) depths_->on_swath(*swath, pose);
}

/// A depth of 0 is that of a boat, or of a log without depth; the distance to the surface then stays unknown.
WaterColumn Pipeline::water_at(const Ping& ping, const Pose& X_WB, bool posed) const {
  const Pose X_WS = X_WB * ping.X_BS;
  WaterColumn water{X_WS.rotation, {}, {}};
  if (!posed) return water;
  const double depth = X_WS.translation.z();
  auto bottom = bottom_.depth(ping.time);
  if (!bottom && depths_) bottom = depths_->bottom_depth(X_WS.translation.head<2>());
  if (bottom && *bottom > depth) water.above_bottom_m = *bottom - depth;
  if (depth > 0) water.below_surface_m = depth;
  return water;
}

void Pipeline::end_scan() {
  enter(Stage::kObstacles);
  counts_.bodies = bodies_.counts();
  bodies_.clear_trails(mapper_->grid(), last_->time, last_->from.X_WB);
  Detection found = detector_.detect(mapper_->grid(), last_->time, last_->from.X_WB);
  bodies_.mark_doubtful(found.time, found.X_WB, found.obstacles);
  add_moving(found.obstacles, bodies_.obstacles(found.time, found.X_WB));
  numbers_.keep(found.obstacles, level(found.X_WB), found.time);  // each obstacle keeps its number
  label_obstacles(found.obstacles, last_->from, sink_.heights());
  sink_.on_scan({static_cast<int>(++counts_.scans), last_->posed, found, mapper_->grid()});
  sweep_open_ = false;
}

void Pipeline::finish() {
  release(Time::max(), true);
  if (sweep_open_) end_scan();
}

// Poses --------------------------------------------------------------------------------------------------------------

void Pipeline::restart() {
  release(Time::max(), true);
  poses_.clear();
  bottom_ = {};
  numbers_.forget();
  bodies_.restart();
  last_.reset();
  mapper_.reset();
}

void Pipeline::add_fix(const Navigation& fix) {
  if (const Eigen::Vector3d jump = poses_.add(fix); !jump.isZero(0)) follow(jump);
  alarms_.moved(fix);
  ++counts_.navigation;
  if (depths_) depths_->on_passage(fix.time, fix.X_WB);
}

void Pipeline::jump(const Eigen::Vector3d& by_W) {
  poses_.move(by_W);
  follow(by_W);
}

void Pipeline::follow(const Eigen::Vector3d& jump) {
  ++counts_.jumps;
  counts_.farthest_jump_m = std::max(counts_.farthest_jump_m, jump.norm());
  jumped_ += jump;
  if (last_ && last_->posed) last_->from.X_WB.translation += jump;
  numbers_.move(jump.head<2>());
  bodies_.shift(jump.head<2>());
  alarms_.jumped(jump);
  sink_.on_jump(jump);
}

void Pipeline::hold(Waiting sensed) {
  counts_.ranges += std::holds_alternative<RangeReading>(sensed) ? 1 : 0;
  counts_.swaths += std::holds_alternative<Swath>(sensed) ? 1 : 0;
  if (waiting_.size() == kMaxWaiting) {
    place(waiting_.front());
    waiting_.erase(waiting_.begin());
  }
  waiting_.push_back(std::move(sensed));
}

/// Places the measurements whose pose no later fix can improve, or that have waited long enough.
void Pipeline::release(Time now, bool all) {
  const Duration patience = seconds(configuration_.poses.wait_s);
  std::size_t done = 0;
  const auto time_of = [](const Waiting& w) { return std::visit([](const auto& sensed) { return sensed.time; }, w); };
  while (done < waiting_.size() &&
         (all || poses_.settled(time_of(waiting_[done])) || now - time_of(waiting_[done]) > patience)) {
    place(waiting_[done++]);
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
}

void Pipeline::place(const PassiveBearing& heard) {
  if (poses_.empty()) return gate_.count(kNoBearing);
  const auto X_WB = poses_.at(heard.time);
  if (!X_WB) return gate_.count(to_text(X_WB.error()));
  sink_.on_bearing(heard, {*X_WB, poses_.sigma_m(), std::sqrt(poses_.heading_variance())});
}

void Pipeline::place(const Waiting& sensed) {
  enter(Stage::kDepths);
  if (const auto* heard = std::get_if<PassiveBearing>(&sensed)) return place(*heard);
  const auto* ping = std::get_if<Ping>(&sensed);
  const auto* range = std::get_if<RangeReading>(&sensed);
  const auto* swath = std::get_if<Swath>(&sensed);
  if (!ping && !range && !swath && !depths_) return;
  if (poses_.empty()) {
    if (swath) map_soundings(*swath, Pose{}, false);
    if (!ping && !depths_) return;
    if (!ping) return gate_.count(kNoPlace);
    ++counts_.unposed;  // no navigation at all: the vehicle is assumed to stand still
    return map_ping(*ping, Pose{}, false);
  }
  const Time time = std::visit([](const auto& s) { return s.time; }, sensed);
  const auto X_WB = poses_.at(time);
  if (!X_WB && !ping && !range && !depths_) return;
  if (!X_WB) return gate_.count(to_text(X_WB.error()));
  if (ping) return map_ping(*ping, *X_WB, true);
  if (swath) map_soundings(*swath, *X_WB, true);
  if (range) bottom_.update(*range, *X_WB);
  if (range) sink_.on_reading(*range, *X_WB);
  if (depths_) map_depth(sensed, {*X_WB, poses_.sigma_m()});
}

// The map ------------------------------------------------------------------------------------------------------------

/// Creates the grid at the first ping; again if the range of the sonar no longer fits it, or when navigation sets in.
void Pipeline::fit_map(const Ping& ping, bool posed) {
  const bool moored = last_ && last_->posed != posed;
  if (mapper_ && !moored && (!configuration_.map.fit || grid_fits(mapper_->grid().config(), ping.window.end_m())))
    return;
  BodyGridConfig grid = configuration_.grid;
  if (configuration_.map.fit) grid = fitted(grid, ping.window, ping.fan->beams() >= FanDetector::kMinBeams);
  mapper_ = std::make_unique<GridMapper>(grid, configuration_.update);
}

/// Moves the grid, then updates it. A jump of the position does not move it.
void Pipeline::update_grid(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB, bool posed) {
  const Pose smooth{X_WB.rotation, X_WB.translation - jumped_};
  mapper_->update(ping, decisions, smooth,
                  {.position_fix = false,
                   .velocity_log = motion_is_measured(posed),
                   .heading_variance = poses_.heading_variance()});
}

void Pipeline::note_mapped(const Ping& ping, const Pose& X_WB, bool posed, const WaterColumn& water) {
  last_ = Placed{ping.time, posed, {X_WB, ping.X_BS, ping.fan->height, water}};
  sweep_open_ = true;
  if (sweeps_.add(ping)) end_scan();
}

std::string Pipeline::undecided() const {
  if (echoes_.state() != DetectorState::kReady) return to_text(echoes_.state());
  const DetectorState vertical = vertical_echoes_.state();
  const bool other = counts_.vertical > 0 && vertical == DetectorState::kHistogramOfOther;
  return other ? std::string("vertical fans: ") + to_text(vertical) : "";
}

void Pipeline::count(const EchoDecisions& decisions) {
  ++counts_.pings;
  std::uint64_t usable = 0, hits = 0;
  for (int w = 0; w < decisions.words(); ++w) {
    usable += static_cast<std::uint64_t>(std::popcount(decisions.usable()[w]));
    for (int b = 0; b < decisions.beams(); ++b) {
      hits += static_cast<std::uint64_t>(std::popcount(decisions.hits(b)[w] & decisions.usable()[w]));
      if (!decisions.dim(b)) continue;
      const std::uint64_t dim = decisions.dim(b)[w] & decisions.usable()[w];
      counts_.dim += static_cast<std::uint64_t>(std::popcount(dim));
      for (std::uint64_t left = dim; left != 0; left &= left - 1) {
        counts_.blind += decisions.tells(b, 64 * w + std::countr_zero(left)) ? 0 : 1;
      }
    }
  }
  counts_.bins += usable * static_cast<std::uint64_t>(decisions.beams());
  counts_.hits += hits;
}

}  // namespace isobath
