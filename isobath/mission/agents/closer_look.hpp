// CloserLookDriver: the back-seat driver that takes the vehicle near to an obstacle, for a camera (Auran, Silven 1995,
// 2; ledger S4-53).
//
// "look": to a viewing pose before the obstacle nearest to the point, within `range_m` of it, with a free line of
// sight, and where the vehicle keeps the clearance of its route from all that it knows. The last leg leads towards the
// obstacle, so that the vehicle arrives with its bow to it; the Navigator plans the way there. All pieces of a
// connected obstacle are looked at as one. The driver does not bid where it knows no obstacle within `within_m` of the
// point, or where no such pose is free, and says why.
#pragma once

#include <isobath/mission/agents/back_seat.hpp>
#include <memory>
#include <optional>
#include <span>

namespace isobath {

struct CloserLookConfig {
  double range_m = 8, within_m = 30;  ///< where the task gives none
  double speed = 0.5;
};
std::vector<Field> fields(CloserLookConfig& config);

/// A place to look at an obstacle from.
struct ViewingPose {
  Eigen::Vector2d place, seen;               ///< north, east: the vehicle, the nearest point of the obstacle
  std::optional<Eigen::Vector2d> from = {};  ///< where the leg towards the obstacle begins, where there is room
  [[nodiscard]] double range_m() const { return (seen - place).norm(); }
};

/// The viewing pose nearest to the vehicle, of 48 directions; empty where none is free. `piece`: any piece of the
/// obstacle. `keep_m`: distance of the vehicle's reference point from the outlines, beyond their margins.
std::optional<ViewingPose> viewing_pose(std::span<const RememberedObstacle> obstacles, std::size_t piece,
                                        double range_m, double keep_m, double lead_m, const Eigen::Vector2d& vehicle);

class CloserLookDriver final : public BackSeatDriver {
 public:
  /// `keep_m`: half-width of the vehicle and clearance of its routes.
  CloserLookDriver(const CloserLookConfig& config, double keep_m, double turning_radius_m)
      : BackSeatDriver("closer look"), config_(config), keep_m_(keep_m), turning_radius_m_(turning_radius_m) {}

 private:
  [[nodiscard]] std::optional<Offer> offer(const Task& task, const MissionPoint& at,
                                           const std::optional<Eigen::Vector2d>& vehicle) const override;
  void hear(const Message& message) override;

  CloserLookConfig config_;
  double keep_m_, turning_radius_m_;
  std::shared_ptr<const KnownObstacles> known_;
};

}  // namespace isobath
