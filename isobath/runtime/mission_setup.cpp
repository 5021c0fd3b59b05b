#include <array>
#include <fstream>
#include <isobath/io/native_log.hpp>
#include <isobath/mission/mission_file.hpp>
#include <isobath/mission/safety_officer.hpp>
#include <isobath/mission/standard_crew.hpp>
#include <isobath/runtime/mission_setup.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;

bool is_mcap(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 16> head{};
  in.read(head.data(), head.size());
  return looks_like_mcap({reinterpret_cast<const std::uint8_t*>(head.data()), static_cast<std::size_t>(in.gcount())});
}

}  // namespace

std::vector<Section> vehicle_sections(VehicleSheet& sheet) {
  return {{"vehicle", "Parameters of the vehicle that the agents use.", fields(sheet)}};
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
                                  const std::shared_ptr<StageTimes>& times) {
  std::vector<Seat> seats = whole_crew(setup, configuration);
  for (Seat& seat : seats) {
    const bool plans = seat.name == "navigator";
    if (times) seat = timed(std::move(seat), times, plans);
  }
  return std::make_unique<Crewed>(std::move(seats), setup.vehicle, configuration.crew,
                                  std::make_shared<const MissionPlan>(setup.plan), setup.chart,
                                  configuration.safety.echo_contrast);
}

}  // namespace

std::unique_ptr<MissionHelm> make_mission_helm(const MissionSetup& setup, const Configuration& configuration,
                                               const std::shared_ptr<StageTimes>& times) {
  return make_helm<MissionHelm>(setup, configuration, times);
}

std::unique_ptr<LiveHelm> make_live_helm(const MissionSetup& setup, const Configuration& configuration,
                                         const std::shared_ptr<StageTimes>& times) {
  return make_helm<LiveHelm>(setup, configuration, times);
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

}  // namespace isobath
