// Helm: steers the vehicle in a closed loop. The mission's agents are one helm; the baselines that they are compared
// with are others.
//
// A helm is a function of its events and their times: the same events give the same set-points, unless the helm has
// threads of its own (ThreadedHelm).
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/mission/command/executor.hpp>
#include <isobath/mission/messages/operator_link.hpp>
#include <isobath/world/result_sinks.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

class Helm : public ResultSink {
 public:
  /// Every event on arrival, before the pipeline gets it.
  virtual void on_event(const Event& event) = 0;
  /// All maps that the run has made so far. Called before the scan that new voxels belong to, if a sonar measures
  /// height; at the interval of `chart_room.live_s` while the depth map grows; and at the end of each scan of the
  /// spherical grid with `chart_room.sphere`.
  virtual void on_world(const WorldSnapshot& /*world*/) {}
  /// A decision that was not made by an agent: it goes to the other decisions. The helm sets its time.
  virtual void on_decision(const Decision& /*decision*/) {}
  /// The set-point from now on. Called after each event.
  [[nodiscard]] virtual Setpoint steer() = 0;
  /// Number of the message that the last set-point serves (CommandArbiter::served), if its agents have such numbers.
  [[nodiscard]] virtual std::uint64_t served() const { return 0; }
  [[nodiscard]] virtual MissionReport progress() const = 0;
  /// All decisions so far, in order.
  [[nodiscard]] virtual const std::vector<Decision>& decisions() const = 0;
  /// The obstacles of the last scan, in L, of a helm that finds its own and does not use those of the map; else null.
  [[nodiscard]] virtual const std::vector<Obstacle>* own_obstacles() const { return nullptr; }
  /// Frames for the operator since the last call (operator_link.hpp). Frames that are not fetched may be dropped.
  [[nodiscard]] virtual std::vector<FrameBytes> to_operator() { return {}; }
  /// Likewise for the other vehicles of the group (group_words.hpp).
  [[nodiscard]] virtual std::vector<FrameBytes> to_group() { return {}; }
  /// How the scanning sonar is to look from now on, if that has been ordered since the last call.
  [[nodiscard]] virtual std::optional<SonarOrder> take_sonar_order() { return std::nullopt; }
  /// Whether the operator has acknowledged the alarms since the last call.
  [[nodiscard]] virtual bool take_acknowledgement() { return false; }
  /// `recorder` gets every message of the agents, in order (bus.hpp).
  virtual void show_messages_to(const Recorder& /*recorder*/) {}
  /// Counts of its agents, if it has any.
  [[nodiscard]] virtual ExecutorCounts executor_counts() const { return {}; }
  /// Its agents with what each has sent, if it has any.
  [[nodiscard]] virtual std::vector<AgentReport> crew() const { return {}; }
  /// Waits until all events so far are answered. Returns at once if the helm has no threads of its own.
  virtual void settle() {}
};

}  // namespace isobath
