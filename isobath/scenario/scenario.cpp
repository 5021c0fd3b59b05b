#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/plan/mission_file.hpp>
#include <isobath/mission/plan/planner_budget.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/sim/random_at.hpp>

namespace isobath {
namespace {

std::string list_of(const std::vector<SonarConfig>& sonars) {
  std::string text;
  for (const SonarConfig& s : sonars) {
    text += (text.empty() ? "" : "; ") + fmt::format("{}: {:g} x {:g} deg, {} bins to {:g} m, {:g} kHz", s.name,
                                                     s.width.degrees(), s.height.degrees(), s.bins, s.range_m,
                                                     s.frequency / 1000);
  }
  return text.empty() ? "none" : text;
}

std::string list_of(const std::vector<FaultConfig>& faults) {
  std::string text;
  for (const FaultConfig& f : faults) {
    const std::string since = f.when.empty() ? fmt::format("{:g} s", f.at_s) : f.when;
    text += (text.empty() ? "" : "; ") + fmt::format("{} {} from {}", f.source, to_text(f.kind), since);
  }
  return text.empty() ? "none" : text;
}

constexpr std::uint64_t kVehicleSeed = 0x67726f7570;  // "group"

/// Refuses a step that a scanning sonar of the scene cannot follow.
void check_scans(const Scenario& scenario) {
  const auto& sonars = scenario.scene.sonars;
  const auto head =
      std::ranges::find_if(sonars, [](const SonarConfig& s) { return s.on && s.kind == SonarKind::kScanning; });
  for (const TaskStep& step : scenario.mission.steps) {
    const auto scan = scan_of(step);
    if (!scan) continue;
    Place place = step.place;
    place.key += ".sector_deg";
    if (head == sonars.end()) throw Error("the vehicle has no scanning sonar", place, "a scanning sonar in the scene");
    try {
      (void)commanded(*head, *scan);
    } catch (const Error& error) {
      throw Error(std::string("the scanning sonar cannot do this: ") + error.what(), place);
    }
  }
}

/// The vehicles of the scene are the group of the mission.
void add_group(Scenario& scenario) {
  const Scene& scene = scenario.scene;
  MissionPlan& mission = scenario.mission;
  if (!mission.search.on()) {
    if (scene.group.empty()) return;
    throw Error("several vehicles without an area to share", scene.group.front().place, "a [search_area]");
  }
  mission.group = {{scene.vehicle.name, scene.vehicle.start.head<2>()}};
  for (const GroupVehicle& vehicle : scene.group) mission.group.push_back({vehicle.name, vehicle.start.head<2>()});
  if (scene.group.empty()) return;
  add_waiting_places(mission);
}

}  // namespace

bool is_scene(const std::filesystem::path& input) { return input.empty() || input.extension() == ".toml"; }

Scenario parse_scenario(std::string_view text, const std::string& file) {
  Scenario scenario;
  MissionKeys keys;
  Schema mission = schema(keys);
  mission.sections.push_back({"prior", "The chart on board the vehicle.", fields(scenario.prior)});
  mission.lists.push_back(operator_list(scenario.orders));
  scenario.scene = parse_scene(text, file, mission);
  scenario.mission = make_plan(keys, mission, scenario.scene.origin());
  add_group(scenario);
  if (looks_like_mission(text)) check_mission(scenario.mission);
  check_scans(scenario);
  return scenario;
}

int seed_of_vehicle(int seed, std::size_t vehicle) {
  if (vehicle == 0) return seed;
  return static_cast<int>(seed_at(static_cast<std::uint64_t>(seed), kVehicleSeed, vehicle) & 0x7fffffffU);
}

Scenario Scenario::of_vehicle(std::size_t vehicle) const {
  Scenario one = *this;
  Scene& own = one.scene;
  one.mission.own = vehicle;
  own.about.seed = seed_of_vehicle(own.about.seed, vehicle);
  std::vector<GroupVehicle> all = {
      {scene.vehicle.place, scene.vehicle.name, scene.vehicle.start, scene.vehicle.heading, scene.vehicle.lost_s}};
  all.insert(all.end(), scene.group.begin(), scene.group.end());
  own.group.clear();
  own.vehicle.name = all.at(vehicle).name;
  own.vehicle.start = all[vehicle].start;
  own.vehicle.heading = all[vehicle].heading;
  own.vehicle.lost_s = all[vehicle].lost_s;
  const VehicleModel model = vehicle_model_of(scene);
  for (std::size_t other = 0; other < all.size(); ++other) {
    if (other == vehicle) continue;
    const Eigen::Vector3d& at_W = all[other].start;
    const Cylinder hull{.centre = at_W, .radius = (model.length + model.width) / 4, .length = model.height};
    own.bodies.push_back({.place = all[other].place,
                          .name = all[other].name,
                          .material = "plastic",
                          .path = {-1, at_W.x(), at_W.y(), at_W.z(), 0, at_W.x(), at_W.y(), at_W.z()},
                          .shape = hull});
  }
  return one;
}

void Scenario::keep_vehicles(std::size_t count) {
  scene.group.resize(std::max<std::size_t>(count, 1) - 1);
  mission.points.resize(mission.search.all_stations());
  add_group(*this);
}

std::size_t Scenario::body_of(std::size_t other) const {
  const std::size_t others = mission.group.size() - 1, own = mission.own;
  return scene.bodies.size() - others + other - (other > own ? 1 : 0);
}

Configuration Scenario::with_prior(Configuration configuration) const {
  if (configuration.prior.file.empty() && !prior.file.empty()) configuration.prior = prior;
  return configuration;
}

Scenario load_scenario(const std::string& file) { return parse_scenario(text_of_file(file), file); }

std::string scenario_text(const std::filesystem::path& input) {
  return input.empty() ? std::string(embedded_scene()) : text_of_file(input.string());
}

Scenario open_scenario(const std::filesystem::path& input) {
  return input.empty() ? parse_scenario(embedded_scene(), "scenarios/pandan.toml") : load_scenario(input.string());
}

Scene open_scene(const std::filesystem::path& input) { return open_scenario(input).scene; }

SimulatedSource::SimulatedSource(Scene scene, const SimulationConfig& config, int threads, const CamerasConfig& cameras)
    : simulator_(std::move(scene), config, threads) {
  const Scene& s = simulator_.scene();
  report_.format = "simulation";
  report_.details["scene"] = s.about.title;
  report_.details["seed"] = fmt::format("{}", simulator_.seed());
  report_.details["sonar"] = list_of(s.sonars);
  report_.details["faults"] = list_of(s.faults);
  for (const CameraPairConfig& camera : s.cameras) {
    rigs_.push_back(camera.on ? std::make_unique<CameraRig>(cameras, cameras_of(camera), camera.X_BL()) : nullptr);
  }
  report_.bytes_total = static_cast<std::uint64_t>(simulator_.duration_s() * 1000);  // progress counts milliseconds
  report_.origin = s.origin();
  for (const FaultConfig& fault : s.faults) {
    const bool known =
        std::any_of(host_.begin(), host_.end(), [&](const HostPart& p) { return p.source == fault.source; });
    const bool of_host = fault.source == "link" || fault.source == "planner" || fault.source.starts_with("agent.");
    if (!known && of_host) host_.push_back({fault.source, false});
  }
}

void SimulatedSource::watch_host() {
  const Time now(seconds(simulator_.now_s()));
  for (HostPart& part : host_) {
    const FaultConfig* fault = simulator_.faults().active(part.source, now);
    if (fault && fault->kind == FaultKind::kIntermittent) fault = nullptr;  // of the link: lost frames show it
    if ((fault != nullptr) == part.lost) continue;
    part.lost = fault != nullptr;
    if (part.source == "planner") {
      told_.push_back(planner_report(now, fault ? fault->amount : 1));
      continue;
    }
    Health health{now, part.source, part.lost ? HealthState::kLost : HealthState::kOk, 1, false, {}};
    if (fault && fault->kind == FaultKind::kStuck) health.note = kHangs;
    told_.push_back(std::move(health));
  }
}

void SimulatedSource::add_operator(const std::vector<OperatorOrder>& orders, const MissionPlan& plan) {
  if (!orders.empty()) operator_.emplace(orders, std::make_shared<const MissionPlan>(plan), simulator_.seed());
}

void SimulatedSource::order(OperatorCommand command, const MissionPlan& plan) {
  if (!operator_)
    operator_.emplace(std::vector<OperatorOrder>{}, std::make_shared<const MissionPlan>(plan), simulator_.seed());
  operator_->order(std::move(command));
}

void SimulatedSource::answer(const std::vector<FrameBytes>& frames) {
  if (operator_) operator_->on_frames(frames, simulator_.faults(), Time(seconds(simulator_.now_s())));
}

std::optional<Event> SimulatedSource::next() {
  while (true) {
    if (!told_.empty()) {
      Event event(std::move(told_.front()));
      told_.pop_front();
      return event;
    }
    auto event = simulator_.next();
    if (!event) return std::nullopt;
    watch_host();
    if (operator_) {
      for (OperatorFrame& frame : operator_->due(simulator_.faults(), Time(seconds(simulator_.now_s())))) {
        told_.emplace_back(std::move(frame));
      }
    }
    report_.bytes_read = static_cast<std::uint64_t>(simulator_.now_s() * 1000);
    if (auto* ping = std::get_if<Ping>(&*event)) return std::move(*ping);
    if (auto* reading = std::get_if<RangeReading>(&*event)) return std::move(*reading);
    if (auto* fix = std::get_if<Navigation>(&*event)) {
      if (!rigs_.empty() && rigs_.front()) rigs_.front()->on_fix(*fix);
      return std::move(*fix);
    }
    if (const auto* pair = std::get_if<CameraPair>(&*event)) {
      CameraRig& rig = *rigs_[pair->rig];
      auto swath = rig.on_pair(*pair);
      rig.describe(simulator_.scene().cameras[pair->rig].name, report_.details);
      if (!swath) {
        ++report_.rejected[to_text(rig.fault())];
        continue;
      }
      return *std::move(swath);
    }
    if (auto* health = std::get_if<Health>(&*event)) return std::move(*health);
    if (auto* heard = std::get_if<PassiveBearing>(&*event)) return *heard;
    for (TruthSink* sink : truth_) {
      if (const auto* echoes = std::get_if<EchoTruth>(&*event)) sink->on_truth(*echoes);
      if (const auto* motion = std::get_if<TrueMotion>(&*event)) sink->on_truth(*motion);
    }
  }
}

}  // namespace isobath
