#include <isobath/runtime/mission_helm.hpp>
#include <utility>

namespace isobath {

void Logbook::note(const Envelope& envelope) {
  if (const auto* decision = std::get_if<Decision>(&envelope.message)) decisions.push_back(*decision);
  if (const auto* said = std::get_if<MissionReport>(&envelope.message)) report = *said;
  const auto* frame = std::get_if<LinkFrame>(&envelope.message);
  if (frame && frame->way == LinkFrame::Way::kToOperator) frames.push_back(frame->bytes);
}

MissionHelm::MissionHelm(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config,
                         std::shared_ptr<const MissionPlan> plan, ChartUpdate chart, double echo_contrast)
    : crew_(std::move(seats), vehicle, config,
            [this](const Envelope& envelope) {
              book_.note(envelope);
              if (listener_) listener_(envelope);
            }),
      ears_(
          std::move(plan), std::move(chart), echo_contrast,
          [this](Message message, Time now) { crew_.hear(std::move(message), now); },
          [this](const std::string& agent, bool hangs) { fail(agent, hangs); }) {}

void MissionHelm::fail(const std::string& agent, bool hangs) {
  if (!crew_.has(agent)) return;
  if (hangs) {
    crew_.hang(agent);
  } else {
    crew_.kill(agent);
  }
}

void MissionHelm::hear(const Event& event) {
  book_.frames.clear();
  ears_.hear(event);
  crew_.advance(ears_.now());
}

void MissionHelm::on_ping(const PosedPing& ping) { ears_.on_ping(ping); }

void MissionHelm::on_scan(const ScanResult& scan) { ears_.on_scan(scan); }

void MissionHelm::on_space(Time time, const std::shared_ptr<const SpaceGrid>& space) { ears_.on_space(time, space); }

Setpoint MissionHelm::steer() { return crew_.helm(ears_.now()); }

}  // namespace isobath
