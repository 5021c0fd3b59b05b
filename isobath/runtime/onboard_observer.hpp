// OnboardObserver: looks on at all that happens on board: recorder, page, judge, report. It changes nothing.
//
// The same calls in every run (onboard.hpp), in the order in which things happened; several observers are called one
// after the other. References hold only during the call. With real threads on_event and on_setpoint are called by the
// thread that senses and steers, all others by the one that maps.
#pragma once

#include <isobath/runtime/pipeline.hpp>
#include <isobath/vehicle/autopilot.hpp>

namespace isobath {

class DepthModel;
class VoxelModel;

class OnboardObserver : public ResultSink {
 public:
  /// Before anything on board has heard it.
  virtual void on_event(const Event& /*event*/) {}
  void on_ping(const PosedPing& /*ping*/) override {}
  void on_scan(const ScanResult& /*scan*/) override {}
  /// An event of this time has been mapped.
  virtual void on_mapped(Time /*time*/, const Pipeline& /*pipeline*/, const DepthModel& /*depths*/,
                         const VoxelModel& /*voxels*/) {}
  /// What the vehicle is told after an event of this time.
  virtual void on_setpoint(Time /*time*/, const Setpoint& /*setpoint*/) {}
};

}  // namespace isobath
