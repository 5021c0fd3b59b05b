#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/mission/mission_file.hpp>
#include <isobath/runtime/run_log.hpp>

namespace isobath {
namespace {

const std::filesystem::path& checked(const std::filesystem::path& file) {
  if (file.extension() == ".mcap") return file;
  throw Error("cannot write this kind of file", {file.string(), {}, {}, {}, {}}, "a name that ends in .mcap");
}

bool same(const Setpoint& a, const Setpoint& b) {
  return a.heading.radians() == b.heading.radians() && a.depth == b.depth && a.speed == b.speed &&
         a.sway_speed == b.sway_speed;
}

constexpr const char* kToml = "application/toml";

}  // namespace

RunLog::RunLog(const std::filesystem::path& file, const Simulator& simulator, const std::string& scenario_toml,
               const Configuration& configuration)
    : log_(checked(file)) {
  log_.set_details({{"scene", simulator.scene().about.title}, {"seed", fmt::format("{}", simulator.seed())}});
  if (const auto origin = simulator.scene().origin()) log_.set_origin(*origin);
  log_.attach(kScenarioAttachment, kToml, scenario_toml);
  log_.attach(kConfigurationAttachment, kToml, to_toml(configuration, false));
}

void RunLog::attach(const MissionSetup& setup) {
  VehicleSheet vehicle = setup.vehicle;
  log_.attach(kMissionAttachment, kToml, write_mission(setup.plan));
  log_.attach(kVehicleAttachment, kToml, write_toml(vehicle_sections(vehicle), false));
}

void RunLog::write(Time time, const Setpoint& setpoint, const std::vector<Decision>& decisions) {
  for (; decided_ < decisions.size(); ++decided_) {
    log_.write_decision(decisions[decided_].time, decision_json(decisions[decided_]));
  }
  if (last_ && same(*last_, setpoint)) return;
  log_.write(time, setpoint);
  last_ = setpoint;
}

}  // namespace isobath
