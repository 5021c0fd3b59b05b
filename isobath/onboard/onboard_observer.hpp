// OnboardObserver: receives all that happens on board: recorder, live page, scorer and report. It changes nothing.
//
// Onboard makes the same calls in every run (onboard.hpp), in the order in which things happen, to one observer after
// the other. References are valid only during the call. In a live run the source thread calls on_event, on_fix and
// on_setpoint, and the mapping thread calls all others.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/map/spherical/grid_snapshots.hpp>
#include <isobath/vehicle/autopilot.hpp>
#include <isobath/world/result_sinks.hpp>
#include <memory>
#include <span>

namespace isobath {

class DepthModel;
class Pipeline;
class VoxelModel;

class OnboardObserver : public ResultSink {
 public:
  /// Called before anything on board receives the event.
  virtual void on_event(const Event& /*event*/) {}
  /// A fix as everything on board receives it: with the correction by charted corners (corner_navigation.hpp). Called
  /// after on_event with the fix of the source.
  virtual void on_fix(const Navigation& /*fix*/) {}
  void on_ping(const PosedPing& /*ping*/) override {}
  void on_scan(const ScanResult& /*scan*/) override {}
  /// An event of this time has been mapped.
  virtual void on_mapped(Time /*time*/, const Pipeline& /*pipeline*/, const DepthModel& /*depths*/,
                         const VoxelModel& /*voxels*/) {}
  /// The spherical grid at the end of a scan; never null.
  virtual void on_sphere(Time /*time*/, const std::shared_ptr<const GridSnapshot>& /*sphere*/) {}
  /// The sounds that a passive array hears have been judged anew.
  virtual void on_contacts(Time /*time*/, std::span<const Contact> /*contacts*/) {}
  /// The set-point for the vehicle after an event of this time.
  virtual void on_setpoint(Time /*time*/, const Setpoint& /*setpoint*/) {}
};

}  // namespace isobath
