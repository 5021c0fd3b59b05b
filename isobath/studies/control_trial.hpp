// ControlTrial: one run of a vehicle under one kind of control through a task in which something changes half-way
// (ledger S7-06 to S7-12, S7-16). The control keeps the vehicle file; the plant, the water, an actuator or the
// navigation is what changes.
//
// Tasks, at half the maximum speed of a vehicle that hovers and 0.6 of it for one that does not:
//   station  hold a place and a heading (StationKeeper); a vehicle that cannot hover circles it
//   line     a straight line, square  round a square (LineOfSight)
//   helix    down round an upright axis (PathHelm)
// The error is the distance from the place, the circle or the path, in the plane and in depth; both of the true state.
// The control gets the state with white noise in each step of 20 ms (kNavigationNoise), guidance acts every 0.1 s.
//
// A run is a function of its request: its number draws the heading of the task, the time of the change within a quarter
// of a leg, the direction of the current and the noise, the same for each kind of control. SI units.
#pragma once

#include <cmath>
#include <cstdint>
#include <isobath/vehicle/plant.hpp>
#include <vector>

namespace isobath {

enum class ControlTask : std::uint8_t { kStation, kLine, kSquare, kHelix };
inline constexpr ControlTask kControlTasks[] = {ControlTask::kStation, ControlTask::kLine, ControlTask::kSquare,
                                                ControlTask::kHelix};
const char* to_text(ControlTask task);

enum class ControlChange : std::uint8_t {
  kNone,
  kMass,
  kDrag,
  kBuoyant,
  kHeavy,
  kDensity,
  kCurrent,
  kStrongCurrent,
  kActuator,
  kNavigation,
  kTether
};
inline constexpr ControlChange kControlChanges[] = {
    ControlChange::kNone,     ControlChange::kMass,       ControlChange::kDrag,    ControlChange::kBuoyant,
    ControlChange::kHeavy,    ControlChange::kDensity,    ControlChange::kCurrent, ControlChange::kStrongCurrent,
    ControlChange::kActuator, ControlChange::kNavigation, ControlChange::kTether};
const char* to_text(ControlChange change);
/// What changes, with its numbers.
const char* explained(ControlChange change);

/// Standard deviations of the state that the control gets, and the delay of place and speeds.
struct NavigationNoise {
  double position = 0.01;  ///< m, in the plane
  double depth = 0.005;    ///< m
  double speed = 0.005;    ///< m/s, an axis
  Angle attitude = Angle::degrees(0.1);
  Angle rate = Angle::degrees(0.2);  ///< a second
  double delay_s = 0;
};
inline const NavigationNoise kNavigationNoise;
/// After the change of the navigation.
inline const NavigationNoise kPoorNavigation{0.04, 0.02, 0.02, Angle::degrees(0.4), Angle::degrees(0.5), 0.14};

struct ControlTrialRequest {
  ControlTask task = ControlTask::kStation;
  ControlChange change = ControlChange::kNone;
  ControlKind control = ControlKind::kAdaptive;
  int run = 0;
};

/// A sample every 0.1 s.
struct ControlSample {
  double time_s = 0;
  double level_m = 0, depth_m = 0;  ///< error in the plane, in depth; not negative
  [[nodiscard]] double off_m() const { return std::hypot(level_m, depth_m); }
};

struct ControlTrial {
  double change_s = 0;
  double leg_s = 0;  ///< the length of the intervals that are compared: before, at and after the change
  std::vector<ControlSample> samples;
};

/// Throws Error if the vehicle cannot do the task. The kind of control of the model does not matter.
ControlTrial fly_trial(const VehicleModel& model, const ControlTrialRequest& request);

/// The result of a run. Before: the last leg before the change. At: the leg after it. After: the last leg of the run.
struct ControlScore {
  double before_rms_m = 0, at_rms_m = 0, after_rms_m = 0;
  double before_max_m = 0, at_max_m = 0, after_max_m = 0;
  double at_depth_max_m = 0, at_level_max_m = 0;
  double final_depth_m = 0, final_level_m = 0;  ///< the largest of the last half leg
  /// From the change until the error stays within that before it, and 0.05 m; infinite: it never does.
  double recovery_s = 0;
};
ControlScore score(const ControlTrial& trial);

}  // namespace isobath
