// OpeningApproach: the decision on the way to an opening: go on with the helix, go through, or turn away (Horner et al.
// c. 2009, 6; ledger S5-45, S5-47).
//
//   helix      while the helix keeps within the limits (HelixPlan::leave_m) and no obstacle is in the way
//   pass       from there on, if the required share of the opening is known to be free, the opening is wide and high
//              enough for hull and margin, and no occupied voxel lies within hull and margin of the planned path
//   turn away  otherwise; and at once where even the straight path is blocked. This is final.
// While passing, the vehicle turns away from a path that turns out to be blocked, as long as latest_decision_m allows
// it.
//
// Each image makes a new plan from the vehicle's position. Where the map has an occupied voxel within reach of the
// helix, the helix is flown at half its amplitude, then not at all. The paper makes the decision at 20 to 30 m; with a
// torpedo-shaped vehicle at 1.5 m/s and an opening of 25 m by 8 m the distance is 23 m. One thread at a time.
#pragma once

#include <isobath/map/voxel/voxel_map.hpp>
#include <isobath/planning/helix.hpp>
#include <optional>

namespace isobath {

/// Distance along a path to the first occupied voxel nearer to it than `reach_m`, m; empty where there is none. Costs
/// about 0.1 us per voxel within reach.
std::optional<double> first_occupied(const VoxelMap& map, const SpacePath& path, double reach_m);

enum class ApproachPhase : std::uint8_t { kHelix, kPass, kTurnAway };
const char* to_text(ApproachPhase phase);

class OpeningApproach {
 public:
  /// Begins at start_W; the opening must lie ahead. Throws Error where speed or opening are invalid.
  OpeningApproach(const HelixConfig& config, const VehicleParameters& parameters, double speed,
                  const Eigen::Vector3d& start_W, const Opening& opening);

  /// Must be called once per image. `p_W`: position of the vehicle; `known_share`: of the opening (OpeningView, or
  /// awareness() of a map); `map`: null where there is none.
  ApproachPhase step(const Eigen::Vector3d& p_W, const Opening& opening, double known_share, const VoxelMap* map);

  [[nodiscard]] ApproachPhase phase() const { return phase_; }
  /// Valid until the next step.
  [[nodiscard]] const HelixPlan& plan() const { return *plan_; }
  [[nodiscard]] const HelixPlanner& planner() const { return planner_; }
  /// Distance before the opening at which the helix was left; empty before that.
  [[nodiscard]] std::optional<double> left_at_m() const { return left_at_; }
  /// A level heading away from the opening, to the side to which the vehicle is heading.
  [[nodiscard]] Angle away(Angle heading) const;

 private:
  [[nodiscard]] bool fits_through(const Opening& opening) const;
  /// False where even the straight path is blocked.
  bool replan(const Opening& opening, double along_m, const VoxelMap* map);

  HelixConfig config_;
  VehicleParameters parameters_;
  HelixPlanner planner_;
  ApproachPhase phase_ = ApproachPhase::kHelix;
  std::optional<HelixPlan> plan_;
  std::optional<double> left_at_;
  double last_along_ = 0;
};

}  // namespace isobath
