// MissionHelm: the crew of agents at the helm: events become messages (crew_helm.hpp), messages set-points (Ganesan
// 2015, 5.1; ledger S6-32, S6-42, S6-57, S6-D09).
//
// The same object steers in the closed loop, before a log and on a vehicle: it knows nothing but the events that it
// hears and what the pipeline makes of them. Every event moves its clock, so that agents notice what has fallen silent.
// A health report of "agent.NAME" is a fault of this computer: the agent hangs where the note says so, else it dies;
// both are for good.
//
// A function of the events. One thread; live_helm.hpp has real ones. Throws Error where the crew cannot be (crew.hpp).
#pragma once

#include <isobath/mission/crew.hpp>
#include <isobath/runtime/crew_helm.hpp>
#include <memory>
#include <utility>
#include <vector>

namespace isobath {

class MissionHelm : public CrewHelm {
 public:
  /// `echo_contrast`: of the echoes that the Safety Officer is shown (sonar_look.hpp).
  MissionHelm(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config,
              std::shared_ptr<const MissionPlan> plan, ChartUpdate chart, double echo_contrast);
  MissionHelm(const MissionHelm&) = delete;
  MissionHelm& operator=(const MissionHelm&) = delete;
  ~MissionHelm() override = default;

  void hear(const Event& event) override;
  [[nodiscard]] Setpoint steer() override;
  [[nodiscard]] MissionReport progress() const override { return book_.report; }
  [[nodiscard]] const std::vector<Decision>& decisions() const override { return book_.decisions; }
  void show_messages_to(const Recorder& recorder) override { listener_ = recorder; }
  /// Those of the last event.
  [[nodiscard]] std::vector<FrameBytes> to_operator() override { return std::exchange(book_.frames, {}); }
  [[nodiscard]] CrewCounts crew_counts() const override { return crew_.counts(); }

  [[nodiscard]] const Crew& crew() const { return crew_; }

 private:
  void say(Message message, Time now) override { crew_.hear(std::move(message), now); }
  void fail(const std::string& agent, bool hangs) override { inject_failure(crew_, agent, hangs); }

  Logbook book_;
  Recorder listener_;
  Crew crew_;  ///< last: it tells the others
};

}  // namespace isobath
