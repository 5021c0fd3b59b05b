// Helm: whoever steers the vehicle in a closed loop. The mission's agents are one; the baselines that they are compared
// with are others.
//
// A helm is a function of the events that it hears and of their times: the same events give the same set-points.
#pragma once

#include <isobath/io/event.hpp>
#include <isobath/mission/messages.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <vector>

namespace isobath {

class Helm : public ResultSink {
 public:
  /// Every event as it comes, before the pipeline has it.
  virtual void hear(const Event& event) = 0;
  /// What the vehicle shall do from now on. Called after each event.
  [[nodiscard]] virtual Setpoint steer() = 0;
  [[nodiscard]] virtual MissionReport progress() const = 0;
  /// All so far, in order.
  [[nodiscard]] virtual const std::vector<Decision>& decisions() const = 0;
};

}  // namespace isobath
