// SteppedRun: a run of one vehicle that goes in steps, so that the vehicles of a group run side by side
// (vehicle_group.hpp).
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/mission/messages/frame_bytes.hpp>
#include <isobath/scenario/scenario.hpp>
#include <vector>

namespace isobath {

class SteppedRun {
 public:
  SteppedRun() = default;
  SteppedRun(const SteppedRun&) = delete;
  SteppedRun& operator=(const SteppedRun&) = delete;
  virtual ~SteppedRun() = default;

  /// Handles the events up to this time of the simulated vehicle's clock. Returns false once the run has ended.
  virtual bool advance(double until_s) = 0;
  /// Whether the mission has been over for a while. A vehicle of a group goes on, so that the others hear it.
  [[nodiscard]] virtual bool mission_is_over() const = 0;
  /// The simulated vehicle; null: the input is a log.
  [[nodiscard]] virtual Simulator* simulator() = 0;
  /// The scenario as this vehicle sees it; only of a simulated vehicle.
  [[nodiscard]] virtual const Scenario& scenario() const = 0;
  /// Packets for the other vehicles since the last call.
  [[nodiscard]] virtual std::vector<FrameBytes> take_packets() = 0;
  /// A packet of another vehicle arrives at a simulated one.
  virtual void hear(OperatorFrame packet) = 0;
};

}  // namespace isobath
