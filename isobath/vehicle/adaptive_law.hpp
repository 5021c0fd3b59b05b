// AdaptiveLaw: passivity-based adaptive control in six degrees of freedom (ledger S7-07, S7-10; Slotine and Li 1987;
// Fossen 1994, 6.1.4; Fossen 2011, 13.3).
//
// With the velocity nu through the water, a reference nu_r, s = nu - nu_r and the plant of dynamics.hpp,
//   tau = Y(nu_r', nu_r, nu, R_WB) theta + known(nu_r', nu_r, nu) - K s,       theta' = -Gamma Y^T s.
// C is the skew-symmetric matrix of M, so that s^T C s = 0, and V = (s^T M s + dtheta^T Gamma^-1 dtheta) / 2 has
// V' = -s^T (K + D(nu)) s <= 0: V never rises, whatever the parameters are.
//
// theta, 25 numbers, in which Y theta is linear:
//   mass of each axis (6), with its part of C: the Munk moments follow from the estimated masses
//   linear and quadratic drag of each axis (12)
//   force of the world (3), N in W: current and other steady forces; its down component is the net weight
//   moment of the weight (3): weight p_BG - buoyancy p_BC, N m; righting moments are its cross product with down
//   moment about the yaw axis (1), N m
// `known` has the rest of the vehicle file: the elements beside the diagonals of mass and drag, and the lift.
//
// Gains. The feedback is K_i = 2 p_i m_i with the bandwidth p_i of axis i (`force_bandwidth` for surge, sway and heave,
// `attitude_bandwidth`, `heading_bandwidth`) and the mass m_i of the file. The gain of the force of the world is
// p_i^2 m_i: a constant force then gives two equal poles at -p_i. Each of the others has `kShare` of that at the
// acceleration and the speed that the file allows, so that all together keep the loop well damped.
//
// Bounds. Each estimate stays within a range about the file's value (ParameterRange), whatever is measured. Masses,
// drags and the height of the centre of gravity leak back to the file's values with the time constant kMemory_s, so
// that noise, which has a mean in their equations, cannot carry them away while nothing excites them. Forces and trim
// moments do not leak: that would leave an error. An axis whose actuators fall short of its demand does not adapt.
//
// SI units. Nothing allocates. Immutable but for `theta`; one thread at a time.
#pragma once

#include <isobath/vehicle/vehicle_model.hpp>

namespace isobath {

inline constexpr int kPlantParameters = 25;
using ParameterVector = Eigen::Matrix<double, kPlantParameters, 1>;
using Regressor = Eigen::Matrix<double, 6, kPlantParameters>;

/// First index of each group of theta.
enum PlantParameter : int { kMasses = 0, kLinearDrag = 6, kQuadraticDrag = 12, kForce = 18, kMoment = 21, kYaw = 24 };

/// A reference velocity through the water and its derivative, in B.
struct ReferenceMotion {
  Vector6 velocity = Vector6::Zero();
  Vector6 acceleration = Vector6::Zero();
};

/// The parameters of a model: of its file, or of a plant that a test knows.
ParameterVector plant_parameters(const VehicleModel& model);

struct ParameterRange {
  ParameterVector low, high;
};
/// Masses 0.3 to 3 times the file's; drags up to 4 times it, at least 0; forces and moments up to what the actuators
/// make, beside the file's value.
ParameterRange parameter_range(const VehicleModel& model);

class AdaptiveLaw {
 public:
  static constexpr double kShare = 0.5;
  static constexpr double kMemory_s = 200;

  explicit AdaptiveLaw(const VehicleModel& model);

  [[nodiscard]] Regressor regressor(const ReferenceMotion& reference, const Vector6& velocity,
                                    const Eigen::Matrix3d& R_WB) const;
  /// What theta leaves out.
  [[nodiscard]] Vector6 known(const ReferenceMotion& reference, const Vector6& velocity) const;
  /// tau, with the present estimates.
  [[nodiscard]] Vector6 wrench(const Regressor& Y, const Vector6& known, const Vector6& s) const {
    return Y * theta_ + known - feedback_.cwiseProduct(s);
  }
  /// theta' without projection and leakage. Elements of `s` that are 0 do not adapt.
  [[nodiscard]] ParameterVector rate(const Regressor& Y, const Vector6& s) const {
    return -gains_.cwiseProduct(Y.transpose() * s);
  }
  /// Moves theta on by dt, with leakage and projection. Ignores values that are not finite.
  void adapt(const Regressor& Y, const Vector6& s, double dt);

  [[nodiscard]] const ParameterVector& theta() const { return theta_; }
  void set_theta(const ParameterVector& theta) { theta_ = theta; }
  [[nodiscard]] const ParameterRange& range() const { return range_; }
  [[nodiscard]] const ParameterVector& gains() const { return gains_; }
  [[nodiscard]] const Vector6& feedback() const { return feedback_; }

 private:
  Matrix6 coupled_mass_, coupled_linear_, coupled_quadratic_, lift_;  ///< beside the diagonals; lift whole
  ParameterVector file_, theta_, gains_, leakage_;
  ParameterRange range_;
  Vector6 feedback_;
};

}  // namespace isobath
