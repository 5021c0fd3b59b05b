// Autopilot: turns a set-point for heading, depth and speed into actuator commands (ledger S7-06, S7-11 baseline).
//
// Cascaded loops, the outer one proportional on position, the inner one proportional and integral on rate, with the two
// fast poles at -bandwidth: for inertia I,
//   rate demanded = (bandwidth / 2) error, limited
//   force = I 2 bandwidth (lack + integral_rate sum of lack) + drag at the rate demanded,  lack = rate demanded - rate.
// The demanded speed ramps at the maximum acceleration. Depth is controlled by heave or by pitch: nose down by the
// angle that gives the demanded sink rate at the present speed, with an integral on depth against buoyancy. Roll and
// pitch are levelled where the vehicle can. An integral stops while the actuators fall short of the demand of its axis,
// unless it would shrink (anti-windup).
//
// Speeds are over ground. Units SI. One thread at a time; nothing allocates after construction.
#pragma once

#include <isobath/vehicle/dynamics.hpp>
#include <optional>

namespace isobath {

/// The demand of guidance.
struct Setpoint {
  Angle heading;
  double depth = 0;       ///< m
  double speed = 0;       ///< ahead, m/s
  double sway_speed = 0;  ///< to starboard, m/s; only where thrusters make sway
};

class Autopilot {
 public:
  explicit Autopilot(const VehicleModel& model);

  /// Commands for the next dt seconds. `flow`: measured forward speed through the water, m/s; fins work by it.
  ActuatorVector update(const Setpoint& setpoint, const VehicleState& state, double flow, double dt);
  /// The wrench that the last update demanded, and what the actuators achieve of it.
  [[nodiscard]] const Vector6& demand_B() const { return demand_B_; }
  [[nodiscard]] const Allocation& allocation() const { return allocation_; }
  void reset();
  /// Commands only working actuators; see Allocator.
  void set_known_effectiveness(const ActuatorVector& effectiveness) { allocator_ = Allocator(model_, effectiveness); }

 private:
  enum Loop : int { kSpeed, kSway, kDepth, kHeading, kLoops };
  /// What an update is given.
  struct Step {
    const Setpoint& setpoint;
    const VehicleState& state;
    double flow, dt;
  };
  double integrate(Loop loop, double error, double dt, bool held);
  /// Whether the last commands did not reach the demand of an axis.
  [[nodiscard]] bool falls_short(int axis) const;
  /// Drag at the demanded rate is fed forward: the loops then only correct.
  [[nodiscard]] double drag(int axis, double rate, double flow) const;
  // The demands of the loops, N and N m in B.
  double speed_force(const Step& step);
  double sway_force(const Step& step);
  double heading_moment(const Step& step);
  [[nodiscard]] double depth_error(const Step& step) const;
  double depth_force(const Step& step);  ///< along the down axis of the world
  double depth_pitch(const Step& step);  ///< the pitch that gives the demanded sink rate, rad
  /// About the roll and the pitch axis.
  [[nodiscard]] Eigen::Vector2d attitude_moments(const VehicleState& state, double pitch_wanted) const;

  VehicleModel model_;
  Vector6 inertia_;  ///< diagonal of M
  Allocator allocator_;
  Vector6 demand_B_ = Vector6::Zero();
  Allocation allocation_;
  double integral_[kLoops] = {};
  std::optional<double> speed_asked_;  ///< ramps to the set-point at the maximum acceleration
};

}  // namespace isobath
