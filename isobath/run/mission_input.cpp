#include <algorithm>
#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <isobath/display/decision_json.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/mission/plan/mission_file.hpp>
#include <isobath/run/mission_input.hpp>
#include <isobath/scenario/scenario.hpp>
#include <utility>

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

std::optional<MissionSetup> mission_setup(const fs::path& mission, const Scenario* scenario, const fs::path& input,
                                          const Simulator* simulator) {
  MissionSetup setup;
  if (!mission.empty()) {
    const std::string text = text_of_file(mission.string());
    setup.plan =
        looks_like_scene(text) ? parse_scenario(text, mission.string()).mission : load_mission(mission.string());
  } else if (scenario) {
    setup.plan = scenario->mission;
  }
  if (setup.plan.points.empty()) return std::nullopt;
  if (simulator) {
    if (const auto origin = simulator->scene().origin()) setup.plan = on_plane_of(std::move(setup.plan), *origin);
    setup.vehicle = parameters_of(simulator->vehicle());
  } else if (const auto text = is_mcap(input) ? attachment_in(input, kVehicleAttachment) : std::nullopt) {
    std::vector<Section> vehicle = vehicle_sections(setup.vehicle);
    read_toml(*text, input.string() + ": " + kVehicleAttachment, vehicle);
  }
  return setup;
}

void check_frame(const MissionPlan& plan, const std::optional<GeoOrigin>& heard) {
  if (!plan.origin || !heard) return;
  const double apart_m = distance_m(*plan.origin, *heard);
  if (apart_m <= 1) return;
  throw Error(fmt::format("the origin of the mission is {:.0f} m away from the origin of the input", apart_m),
              plan.place, "the same origin in both");
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
