// AdaptiveAutopilot: the autopilot by AdaptiveLaw, and with `control = "model"` the same without adaptation (ledger
// S7-06, S7-07, S7-10, S7-11).
//
// Reference. Depth and heading: the velocity (bandwidth / 2) error, limited to climb rate and yaw rate, as of
// PidAutopilot, so that both follow a set-point with the same lag; the attitude error is the vector part of the error
// quaternion, 2 sign(q0) q. Speeds: the set-point, less kLeadShare force_bandwidth times the lead of the vehicle over a
// point that moves with the set-point from where control began: what a push has taken is given back. The lead is kept
// ahead and across, so that a vehicle that lags behind on a bend does not take that for a drift; it is limited to what
// kCatchUp of the maximum speed regains.
//
// An axis without actuators has the reference of its own velocity: s is 0 there, nothing adapts, and its velocity takes
// part in the Coriolis forces of the others. A vehicle without sway takes its velocity across from CurrentEstimate: the
// water carries it over ground, and Munk moments depend on the flow across the hull alone. A vehicle with sway moves
// across by itself, so that CurrentEstimate does not apply; there the force of the world takes up what a current does.
// The speed ahead through the water is measured.
//
// Thrusters that cannot make all of a demand give the moments and the force up or down first, then the force across,
// and then what is left of the force ahead: a vehicle that is too slow is late, one that loses its depth, heading or
// track is in danger. What falls short in an axis stops the adaptation of that axis only.
#pragma once

#include <isobath/vehicle/adaptive_law.hpp>
#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/current_estimate.hpp>

namespace isobath {

class AdaptiveAutopilot final : public Autopilot {
 public:
  static constexpr double kLeadShare = 0.2;
  static constexpr double kCatchUp = 0.3;

  explicit AdaptiveAutopilot(const VehicleModel& model);

  [[nodiscard]] const AdaptiveLaw& law() const { return law_; }
  /// nu - nu_r of the last update.
  [[nodiscard]] const Vector6& s() const { return s_; }

 private:
  Vector6 wrench(const Step& step) override;
  [[nodiscard]] Vector6 within_reach(const Vector6& demand_B, double flow) const override;
  [[nodiscard]] Vector6 velocity_through_water(const Step& step);
  void refer_to_speeds(const Step& step, const Vector6& velocity, ReferenceMotion& reference);
  void refer_to_attitude(const Step& step, ReferenceMotion& reference);

  AdaptiveLaw law_;
  bool adapts_;
  Vector6 axes_;  ///< 1 where there are actuators
  CurrentEstimate current_;
  Eigen::Vector2d lead_ = Eigen::Vector2d::Zero();  ///< m, ahead and across
  Vector6 s_ = Vector6::Zero();
};

}  // namespace isobath
