// Autopilot: turns a set-point for heading, depth and speed into actuator commands (ledger S7-06, S7-07, S7-11).
//
// Three kinds of control, chosen by `[autopilot] control` of the vehicle file:
//   pid       cascaded loops with feed-forward (pid_autopilot.hpp)
//   model     the law of `adaptive` with the parameters of the vehicle file, which stay
//   adaptive  the same law, which estimates the parameters (adaptive_autopilot.hpp, adaptive_law.hpp)
//
// All kinds share what stands here: the ramp of the speed, the pitch by which a vehicle without heave changes depth,
// and the allocation to actuators. The demanded speed ramps at the maximum acceleration. A vehicle that dives by pitch
// takes the pitch that gives the demanded sink rate at the present speed, with an integral on depth against buoyancy.
// An integral stops while the actuators fall short of the demand of its axis, unless it would shrink (anti-windup).
//
// Speeds are over ground. Units SI. One thread at a time; nothing allocates after construction.
#pragma once

#include <algorithm>
#include <isobath/vehicle/dynamics.hpp>
#include <memory>
#include <optional>

namespace isobath {

/// The demand of guidance.
struct Setpoint {
  Angle heading;
  double depth = 0;       ///< m
  double speed = 0;       ///< ahead, m/s
  double sway_speed = 0;  ///< to starboard, m/s; only where thrusters make sway
};

/// A value within [-limit, limit].
inline double limited_to(double value, double limit) { return std::clamp(value, -limit, limit); }

class Autopilot {
 public:
  explicit Autopilot(const VehicleModel& model);
  Autopilot(const Autopilot&) = delete;
  Autopilot& operator=(const Autopilot&) = delete;
  virtual ~Autopilot() = default;

  /// Commands for the next dt seconds. `flow`: measured forward speed through the water, m/s; fins work by it.
  ActuatorVector update(const Setpoint& setpoint, const VehicleState& state, double flow, double dt);
  /// The wrench that the last update demanded, and what the actuators achieve of it.
  [[nodiscard]] const Vector6& demand_B() const { return demand_B_; }
  [[nodiscard]] const Allocation& allocation() const { return allocation_; }
  /// Commands only working actuators; see Allocator.
  void set_known_effectiveness(const ActuatorVector& effectiveness) { allocator_ = Allocator(model_, effectiveness); }

 protected:
  enum Loop : int { kSpeed, kSway, kDepth, kHeading, kLoops };
  /// What an update is given.
  struct Step {
    const Setpoint& setpoint;
    const VehicleState& state;
    double flow, dt;
  };
  /// A point of the ramp of the speed ahead.
  struct SpeedDemand {
    double speed, acceleration;
  };
  /// The demanded wrench, N and N m in B; axes without an actuator do not count.
  virtual Vector6 wrench(const Step& step) = 0;
  /// The part of a demand that goes to the actuators; by default all of it, which the allocator scales if it must.
  [[nodiscard]] virtual Vector6 within_reach(const Vector6& demand_B, double flow) const;
  [[nodiscard]] const Allocator& allocator() const { return allocator_; }

  double integrate(Loop loop, double error, double dt, bool held);
  /// Whether the last commands did not reach the demand of an axis.
  [[nodiscard]] bool falls_short(int axis) const;
  SpeedDemand speed_demand(const Step& step);
  [[nodiscard]] double depth_error(const Step& step) const;
  double depth_pitch(const Step& step);  ///< the pitch that gives the demanded sink rate, rad

  VehicleModel model_;

 private:
  Allocator allocator_;
  Vector6 demand_B_ = Vector6::Zero();
  Allocation allocation_;
  double integral_[kLoops] = {};
  std::optional<double> speed_asked_;  ///< ramps to the set-point at the maximum acceleration
};

/// The kind of control that the vehicle file names.
std::unique_ptr<Autopilot> make_autopilot(const VehicleModel& model);

}  // namespace isobath
