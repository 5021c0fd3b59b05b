// SerialHelm: runs the agents that steer the vehicle: events become messages (agents_helm.hpp), and messages become
// set-points (Ganesan 2015, 5.1; ledger S6-32, S6-42, S6-57, S6-D09).
//
// The same class steers in simulation, in the replay of a log and on a vehicle. Its only inputs are the events and the
// results of the pipeline. Every event advances its clock, so the agents notice a sensor that has fallen silent. A
// health report of "agent.NAME" is a fault of this computer: the agent hangs if the note says so, otherwise it dies.
// Both faults are permanent.
//
// The set-points are a function of the events. One thread; in ThreadedHelm each agent has its own. Throws Error if the
// agents cannot be set up (executor.hpp).
#pragma once

#include <isobath/mission/command/executor.hpp>
#include <isobath/onboard/agents_helm.hpp>
#include <memory>
#include <utility>
#include <vector>

namespace isobath {

class SerialHelm : public AgentsHelm {
 public:
  /// `echo_contrast`: contrast of the echoes that the Safety Officer receives (sonar_health_sample.hpp).
  SerialHelm(std::vector<AgentSlot> slots, const VehicleParameters& vehicle, const ExecutorConfig& config,
             std::shared_ptr<const MissionPlan> plan, WorldSnapshot chart, double echo_contrast);
  SerialHelm(const SerialHelm&) = delete;
  SerialHelm& operator=(const SerialHelm&) = delete;
  ~SerialHelm() override = default;

  void on_event(const Event& event) override;
  [[nodiscard]] Setpoint steer() override;
  [[nodiscard]] std::uint64_t served() const override { return executor_.served(); }
  [[nodiscard]] MissionReport progress() const override { return book_.report; }
  [[nodiscard]] const std::vector<Decision>& decisions() const override { return book_.decisions; }
  void show_messages_to(const Recorder& recorder) override { listener_ = recorder; }
  /// The frames since the last event.
  [[nodiscard]] std::vector<FrameBytes> to_operator() override { return std::exchange(book_.frames, {}); }
  [[nodiscard]] std::vector<FrameBytes> to_group() override { return std::exchange(book_.group_frames, {}); }
  [[nodiscard]] std::optional<SonarOrder> take_sonar_order() override {
    return std::exchange(book_.sonar, std::nullopt);
  }
  [[nodiscard]] bool take_acknowledgement() override { return std::exchange(book_.acknowledged, false); }
  [[nodiscard]] ExecutorCounts executor_counts() const override { return executor_.counts(); }

  [[nodiscard]] const Executor& executor() const { return executor_; }

 private:
  MissionLog book_;
  Recorder listener_;
  Executor executor_;  ///< last, because its recorder uses the other members
};

}  // namespace isobath
