// LiveHelm: the same crew as MissionHelm's with real threads, one for each agent (Herman 1988, 2; ledger S2-12, S6-31,
// S6-33): an agent that plans for long, dies or hangs does not keep the others waiting.
//
// Messages reach mailboxes (threaded_crew.hpp) and are answered when their agents come to it: what a run decides
// depends on who is faster. A recorded run is replayed by MissionHelm.
//
// Time is that of the events, here too. Whoever hears a source that is faster than the world must call settle between
// its steps, or the watchdog takes agents that are merely slower for hung.
//
// Threads: two may use it, one that hears and steers, one that maps (on_ping, on_scan); progress, decisions and
// to_operator belong to the first, and say what was known at its last steer or settle. Throws Error where the crew
// cannot be.
#pragma once

#include <isobath/runtime/crew_helm.hpp>
#include <memory>

namespace isobath {

class LiveHelm : public CrewHelm {
 public:
  static constexpr std::size_t kMostFrames = 256;  ///< kept for an operator; the oldest give way

  /// As MissionHelm's.
  LiveHelm(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config,
           std::shared_ptr<const MissionPlan> plan, ChartUpdate chart, double echo_contrast);
  LiveHelm(const LiveHelm&) = delete;
  LiveHelm& operator=(const LiveHelm&) = delete;
  ~LiveHelm() override;

  [[nodiscard]] Setpoint steer() override;
  [[nodiscard]] MissionReport progress() const override;
  [[nodiscard]] const std::vector<Decision>& decisions() const override;
  void show_messages_to(const Recorder& recorder) override;
  [[nodiscard]] std::vector<FrameBytes> to_operator() override;
  [[nodiscard]] CrewCounts crew_counts() const override;
  /// All that was heard is answered, but for agents that are lost.
  void settle() override;

 private:
  void moved(Time now) override;
  void say(Message message, Time now) override;
  void fail(const std::string& agent, bool hangs) override;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
