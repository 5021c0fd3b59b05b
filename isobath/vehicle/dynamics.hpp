// VehicleDynamics: a vehicle in the water with six degrees of freedom (ledger S7-01 .. S7-06; Fossen 2011, chapter 8).
//
//   M nu_r' + C(nu_r) nu_r = tau + damping(nu_r) + restoring(R_WB),   nu_r = nu - (R_WB^T current_W, 0)
//
// with M rigid body plus added mass, and C built from M. Newton's laws hold in a frame that drifts with a steady,
// irrotational current, so that one M and one C act on nu_r alone; written for the velocity over ground nu this is M_RB
// nu' + M_A nu_r' + C_RB(nu) nu + C_A(nu_r) nu_r = ... with d(current_B)/dt = -w x current_B. A current that changes
// between steps does not change the velocity over ground; the force of an accelerating flow is neglected. Density
// scales buoyancy, added mass, damping and fin lift.
//
// Attitude is a unit quaternion. `step` is one classical Runge-Kutta step of fourth order. Actuators: saturation, dead
// zone, then a first-order lag solved exactly within the step, then the effectiveness. Thrust does not depend on the
// inflow. Fin stall is neglected: keep max_deflection below it. There is no water surface: the vehicle may rise above
// depth 0.
//
// Accuracy: kinetic energy of a free body to 1e-9 over 100 s at 5 ms; fourth order also with current and lag. Cost: 0.3
// us a step. Units SI. One thread at a time. Nothing allocates after construction.
#pragma once

#include <isobath/vehicle/vehicle_model.hpp>
#include <isobath/vehicle/vehicle_state.hpp>

namespace isobath {

/// The water at the vehicle.
struct WaterConditions {
  double density = kSeaWater;                           ///< kg/m3
  Eigen::Vector3d current_W = Eigen::Vector3d::Zero();  ///< m/s
};

class VehicleDynamics {
 public:
  explicit VehicleDynamics(const VehicleModel& model, const VehicleState& initial = {});

  /// dt in s, above 0. `external_B`: any further wrench, for example of a tether, or a demanded one.
  void step(const ActuatorVector& commands, const WaterConditions& water, double dt,
            const Vector6& external_B = Vector6::Zero());

  [[nodiscard]] const VehicleState& state() const { return state_; }
  void set_state(const VehicleState& state) { state_ = state; }
  [[nodiscard]] const VehicleModel& model() const { return model_; }
  /// From now on a plant with other parameters and the same actuators, as after a change of payload; the state and the
  /// thrusts in force stay. Throws Error if the model is not physical.
  void set_model(const VehicleModel& model);
  /// Thrusts and deflections in force, before their effectiveness.
  [[nodiscard]] const ActuatorVector& actuators() const { return actuators_; }
  /// 1: as in the file; 0: no effect.
  void set_effectiveness(int actuator, double effectiveness);

 private:
  struct Motion;
  struct Forces;
  void set_density(double density);
  void set_step(double dt);
  Forces forces_of(const ActuatorVector& actuators) const;
  Motion rate(const Motion& at, const Forces& forces, const Eigen::Vector3d& current_W) const;

  VehicleModel model_;
  VehicleState state_;
  ActuatorVector actuators_;
  ActuatorVector effectiveness_;
  ActuatorMatrix wrenches_;  ///< of one newton, or of one radian at one metre a second

  double density_ = 0;  ///< for which the following hold
  Matrix6 mass_;
  Matrix6 inverse_mass_;
  Matrix6 linear_, lift_, quadratic_;
  double fin_share_ = 1;
  double net_weight_ = 0;          ///< weight less buoyancy, N
  Eigen::Vector3d weight_moment_;  ///< W p_BG - B p_BC

  double dt_ = 0;
  ActuatorVector half_decay_, decay_;  ///< remaining share of a difference after half a step, a step
};

/// The result of an allocation.
struct Allocation {
  ActuatorVector commands;
  Vector6 achieved_B = Vector6::Zero();  ///< steady wrench of the commands
  double scale = 1;                      ///< factor of the thrusters' part of the demand
};

/// Allocates a demanded wrench to commands (ledger S7-06): the smallest commands, weighted by each actuator's limit,
/// that give the demand in the axes that the vehicle file assigns to them. Thrusters that cannot reach the demand are
/// scaled together, which keeps its direction. Each fin saturates on its own, because rudder and stern planes are
/// independent. Pseudo-inverses are computed once. Immutable; may be shared by threads.
class Allocator {
 public:
  /// `effectiveness`: that of known lost actuators; empty: all work.
  explicit Allocator(const VehicleModel& model, const ActuatorVector& effectiveness = {});

  /// `flow`: forward speed through the water, m/s.
  [[nodiscard]] Allocation allocate(const Vector6& demand_B, double flow, double density) const;

 private:
  using Inverse = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMaxActuators, 6>;
  int thrusters_;
  int fins_;
  ActuatorMatrix wrenches_;
  Inverse thruster_inverse_, fin_inverse_;
  ActuatorVector low_, high_;
  double min_flow_;
  double reference_density_;
};

}  // namespace isobath
