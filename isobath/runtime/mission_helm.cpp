#include <algorithm>
#include <isobath/runtime/mission_helm.hpp>
#include <utility>

namespace isobath {
namespace {

std::vector<std::string> names_of(const std::vector<Seat>& seats) {
  std::vector<std::string> names;
  for (const Seat& seat : seats) names.push_back(seat.name);
  return names;
}

}  // namespace

MissionHelm::MissionHelm(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config,
                         std::shared_ptr<const MissionPlan> plan, double echo_contrast)
    : names_(names_of(seats)),
      crew_(std::move(seats), vehicle, config, [this](const Envelope& envelope) { note(envelope); }),
      ears_(
          std::move(plan), echo_contrast, [this](Message message, Time now) { crew_.hear(std::move(message), now); },
          [this](const std::string& agent, bool hangs) { fail(agent, hangs); }) {}

void MissionHelm::note(const Envelope& envelope) {
  if (const auto* decision = std::get_if<Decision>(&envelope.message)) decisions_.push_back(*decision);
  if (const auto* report = std::get_if<MissionReport>(&envelope.message)) report_ = *report;
}

void MissionHelm::fail(const std::string& agent, bool hangs) {
  if (std::find(names_.begin(), names_.end(), agent) == names_.end()) return;
  if (hangs) {
    crew_.hang(agent);
  } else {
    crew_.kill(agent);
  }
}

void MissionHelm::hear(const Event& event) {
  ears_.hear(event);
  crew_.advance(ears_.now());
}

void MissionHelm::on_ping(const PosedPing& ping) { ears_.on_ping(ping); }

void MissionHelm::on_scan(const ScanResult& scan) { ears_.on_scan(scan); }

Setpoint MissionHelm::steer() { return crew_.helm(ears_.now()); }

}  // namespace isobath
