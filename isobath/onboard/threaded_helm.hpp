// ThreadedHelm: runs the same agents as SerialHelm, each in a thread of its own (Herman 1988, 2; ledger S2-12, S6-31,
// S6-33). An agent that plans for long, dies or hangs does not delay the others.
//
// Messages go into mailboxes (threaded_executor.hpp), and each agent handles its own when it has time. Decisions depend
// on the timing of the threads, so live runs are not deterministic. SerialHelm replays a recorded run.
//
// Time is that of the events, as in SerialHelm. If the source runs faster than real time, the caller must call settle
// between its steps; otherwise the watchdog takes agents that are merely slow for hung ones.
//
// Threads: the source thread calls hear, steer and settle; the mapping thread calls on_ping, on_scan and on_world.
// progress, decisions, to_operator and to_group belong to the source thread; progress and decisions return the state at
// its last steer or settle. Throws Error if the agents cannot be set up.
#pragma once

#include <isobath/onboard/agents_helm.hpp>
#include <memory>

namespace isobath {

class ThreadedHelm : public AgentsHelm {
 public:
  static constexpr std::size_t kMaxFrames = 256;  ///< kept for the operator; beyond it the oldest frame is dropped

  /// Takes the same arguments as SerialHelm.
  ThreadedHelm(std::vector<AgentSlot> slots, const VehicleParameters& vehicle, const ExecutorConfig& config,
               std::shared_ptr<const MissionPlan> plan, WorldSnapshot chart, double echo_contrast);
  ThreadedHelm(const ThreadedHelm&) = delete;
  ThreadedHelm& operator=(const ThreadedHelm&) = delete;
  ~ThreadedHelm() override;

  [[nodiscard]] Setpoint steer() override;
  [[nodiscard]] std::uint64_t served() const override;
  [[nodiscard]] MissionReport progress() const override;
  [[nodiscard]] const std::vector<Decision>& decisions() const override;
  void show_messages_to(const Recorder& recorder) override;
  [[nodiscard]] std::vector<FrameBytes> to_operator() override;
  [[nodiscard]] std::vector<FrameBytes> to_group() override;
  [[nodiscard]] std::optional<SonarOrder> take_sonar_order() override;
  [[nodiscard]] bool take_acknowledgement() override;
  [[nodiscard]] ExecutorCounts executor_counts() const override;
  /// Waits until the agents have handled all messages; lost agents are not waited for.
  void settle() override;

 private:
  void moved(Time now) override;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
