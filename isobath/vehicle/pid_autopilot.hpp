// PidAutopilot: the autopilot by cascaded loops with feed-forward (ledger S7-11, baseline).
//
// The outer loop is proportional on position, the inner one proportional and integral on rate, with the two fast poles
// at -bandwidth: for inertia I,
//   rate demanded = (bandwidth / 2) error, limited
//   force = I 2 bandwidth (lack + integral_rate sum of lack) + drag at the rate demanded,  lack = rate demanded - rate.
// Depth is controlled by heave or by pitch. Roll and pitch are levelled where the vehicle can.
#pragma once

#include <isobath/vehicle/autopilot.hpp>

namespace isobath {

class PidAutopilot final : public Autopilot {
 public:
  explicit PidAutopilot(const VehicleModel& model);

 private:
  Vector6 wrench(const Step& step) override;
  /// Drag at the demanded rate is fed forward: the loops then only correct.
  [[nodiscard]] double drag(int axis, double rate, double flow) const;
  // The demands of the loops, N and N m in B.
  double speed_force(const Step& step);
  double sway_force(const Step& step);
  double heading_moment(const Step& step);
  double depth_force(const Step& step);  ///< along the down axis of the world
  /// About the roll and the pitch axis.
  [[nodiscard]] Eigen::Vector2d attitude_moments(const VehicleState& state, double pitch_wanted) const;

  Vector6 inertia_;  ///< diagonal of M
};

}  // namespace isobath
