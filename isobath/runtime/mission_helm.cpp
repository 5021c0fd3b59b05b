#include <isobath/runtime/mission_helm.hpp>
#include <utility>

namespace isobath {

MissionHelm::MissionHelm(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config,
                         std::shared_ptr<const MissionPlan> plan, ChartUpdate chart, double echo_contrast)
    : CrewHelm(std::move(plan), std::move(chart), echo_contrast),
      crew_(std::move(seats), vehicle, config, [this](const Envelope& envelope) {
        book_.note(envelope);
        if (listener_) listener_(envelope);
      }) {}

void MissionHelm::hear(const Event& event) {
  book_.frames.clear();
  CrewHelm::hear(event);
  crew_.advance(now());
}

Setpoint MissionHelm::steer() { return crew_.helm(now()); }

}  // namespace isobath
