#include <array>
#include <fstream>
#include <isobath/io/native_log.hpp>
#include <isobath/mission/mission_file.hpp>
#include <isobath/mission/safety_officer.hpp>
#include <isobath/mission/standard_crew.hpp>
#include <isobath/runtime/mission_run.hpp>
#include <isobath/runtime/run_recorder.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;

constexpr Duration kBelievedInterval = std::chrono::milliseconds(95);  // ten a second, whatever the jitter

bool is_mcap(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 16> head{};
  in.read(head.data(), head.size());
  return looks_like_mcap({reinterpret_cast<const std::uint8_t*>(head.data()), static_cast<std::size_t>(in.gcount())});
}

}  // namespace

std::vector<Section> vehicle_sections(VehicleSheet& sheet) {
  return {{"vehicle", "What command must know of the vehicle.", fields(sheet)}};
}

std::optional<MissionSetup> mission_setup(const fs::path& mission, const fs::path& input, const Simulator* simulator) {
  MissionSetup setup;
  if (!mission.empty()) {
    const std::string text = text_of_file(mission.string());
    setup.plan =
        looks_like_scene(text) ? parse_scenario(text, mission.string()).mission : load_mission(mission.string());
  } else if (simulator) {
    setup.plan = open_scenario(input).mission;
  }
  if (setup.plan.points.empty()) return std::nullopt;
  if (simulator) {
    setup.vehicle = sheet_of(simulator->vehicle());
  } else if (const auto text = is_mcap(input) ? attachment_in(input, kVehicleAttachment) : std::nullopt) {
    std::vector<Section> vehicle = vehicle_sections(setup.vehicle);
    read_toml(*text, input.string() + ": " + kVehicleAttachment, vehicle);
  }
  return setup;
}

std::vector<Seat> whole_crew(const MissionSetup& setup, const Configuration& configuration) {
  std::vector<Seat> seats = standard_crew(configuration.mission, setup.vehicle);
  if (!configuration.crew.gate.safety_officer.empty()) {
    seats.push_back({configuration.crew.gate.safety_officer, AgentLevel::kSupervisory,
                     std::make_unique<SafetyOfficer>(configuration.safety, setup.vehicle)});
  }
  for (const AgentFile& agent : configuration.agents) seats.push_back(load_agent(agent));
  return seats;
}

namespace {

template <class Crewed>
std::unique_ptr<Crewed> make_helm(const MissionSetup& setup, const Configuration& configuration,
                                  std::vector<Seat> seats) {
  return std::make_unique<Crewed>(std::move(seats), setup.vehicle, configuration.crew,
                                  std::make_shared<const MissionPlan>(setup.plan), setup.chart,
                                  configuration.safety.echo_contrast);
}

}  // namespace

std::unique_ptr<MissionHelm> make_mission_helm(const MissionSetup& setup, const Configuration& configuration) {
  return make_helm<MissionHelm>(setup, configuration, whole_crew(setup, configuration));
}

std::unique_ptr<LiveHelm> make_live_helm(const MissionSetup& setup, const Configuration& configuration) {
  return make_helm<LiveHelm>(setup, configuration, whole_crew(setup, configuration));
}

std::optional<Recorded> compare_with_log(const std::vector<Decision>& decisions, const fs::path& input) {
  if (!is_mcap(input)) return std::nullopt;
  const std::vector<std::string> recorded = decisions_in(input);
  if (recorded.empty()) return std::nullopt;
  Recorded found{recorded.size(), 0};
  while (found.the_same < std::min(recorded.size(), decisions.size()) &&
         recorded[found.the_same] == decision_json(decisions[found.the_same])) {
    ++found.the_same;
  }
  return found;
}

MissionRun::MissionRun(const MissionSetup& setup, const Configuration& configuration, bool live)
    : plan_(setup.plan), times_(std::make_shared<StageTimes>()) {
  std::vector<Seat> seats = whole_crew(setup, configuration);
  for (Seat& seat : seats) {
    const bool plans = seat.name == "navigator";
    seat = timed(std::move(seat), times_, plans);
  }
  if (live) {
    helm_ = make_helm<LiveHelm>(setup, configuration, std::move(seats));
  } else {
    helm_ = make_helm<MissionHelm>(setup, configuration, std::move(seats));
  }
}

void MissionRun::hear(const Event& event) {
  const auto begun = StageTimes::Clock::now();
  helm_->hear(event);
  times_->heard(StageTimes::Clock::now() - begun);
  const auto* fix = std::get_if<Navigation>(&event);
  if (!fix || !fix->X_WB.is_finite()) return;
  if (!believed_.empty() && fix->time - believed_.back().time < kBelievedInterval) return;
  believed_.push_back({fix->time, fix->X_WB.translation.head<2>(), fix->X_WB.translation.z()});
}

void MissionRun::on_ping(const PosedPing& ping) {
  times_->mapped();
  helm_->on_ping(ping);
  times_->aside();
}

void MissionRun::on_scan(const ScanResult& scan) {
  times_->detected(scan.detection.time);
  helm_->on_scan(scan);
  times_->aside();
  const Pose X_WL = level(scan.detection.X_WB);
  for (const Obstacle& o : scan.detection.obstacles) {
    if (o.behind) continue;
    SeenObstacle& seen = seen_.emplace_back(SeenObstacle{scan.detection.time, {}, o.existence});
    for (const Eigen::Vector2d& p : o.outline) {
      seen.outline.emplace_back((X_WL * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>());
    }
  }
}

MissionOutcome MissionRun::outcome() const {
  MissionOutcome outcome;
  outcome.plan = plan_;
  outcome.report = helm_->progress();
  outcome.decisions = helm_->decisions();
  outcome.believed = believed_;
  outcome.seen = seen_;
  outcome.timings = times_->timings();
  outcome.crew = helm_->crew_counts();
  return outcome;
}

}  // namespace isobath
