// Helm: whoever steers the vehicle in a closed loop. The mission's agents are one; the baselines that they are compared
// with are others.
//
// A helm is a function of the events that it hears and of their times: the same events give the same set-points.
#pragma once

#include <isobath/io/event.hpp>
#include <isobath/map/space_grid.hpp>
#include <isobath/mission/crew.hpp>
#include <isobath/mission/operator_link.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <memory>
#include <vector>

namespace isobath {

class Helm : public ResultSink {
 public:
  /// Every event as it comes, before the pipeline has it.
  virtual void hear(const Event& event) = 0;
  /// What is known of the water around in three dimensions, before the scan that it goes with; never null. Only where a
  /// sonar tells height.
  virtual void on_space(Time /*time*/, const std::shared_ptr<const SpaceGrid>& /*space*/) {}
  /// What the vehicle shall do from now on. Called after each event.
  [[nodiscard]] virtual Setpoint steer() = 0;
  [[nodiscard]] virtual MissionReport progress() const = 0;
  /// All so far, in order.
  [[nodiscard]] virtual const std::vector<Decision>& decisions() const = 0;
  /// Frames for the operator since the last call (operator_link.hpp); not kept for ever where nobody asks.
  [[nodiscard]] virtual std::vector<FrameBytes> to_operator() { return {}; }
  /// Whoever is to see every message of its agents, in order, as a crew's recorder (bus.hpp).
  virtual void show_messages_to(const Recorder& /*recorder*/) {}
  /// Of its agents, where it has any.
  [[nodiscard]] virtual CrewCounts crew_counts() const { return {}; }
  /// Waits until all that was heard is answered; one that has no threads of its own has nothing to wait for.
  virtual void settle() {}
};

}  // namespace isobath
