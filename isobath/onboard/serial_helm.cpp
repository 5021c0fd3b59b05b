#include <isobath/onboard/serial_helm.hpp>
#include <utility>

namespace isobath {

SerialHelm::SerialHelm(std::vector<AgentSlot> slots, const VehicleParameters& vehicle, const ExecutorConfig& config,
                       std::shared_ptr<const MissionPlan> plan, WorldSnapshot chart, double echo_contrast)
    : AgentsHelm(std::move(plan), std::move(chart), echo_contrast),
      executor_(std::move(slots), vehicle, config, [this](const Envelope& envelope) {
        book_.note(envelope);
        if (listener_) listener_(envelope);
      }) {
  steer_by(executor_);
}

void SerialHelm::on_event(const Event& event) {
  book_.frames.clear();
  book_.group_frames.clear();
  AgentsHelm::on_event(event);
  executor_.advance(now());
}

Setpoint SerialHelm::steer() { return executor_.helm(now()); }

}  // namespace isobath
