// OpeningApproach: the decision on the way to an opening: go on with the helix, go through, or turn away (Horner et al.
// c. 2009, 6; ledger S5-45, S5-47).
//
//   helix      while the helix can be kept within the limits (HelixPlan::leave_m) and nothing is in the way
//   pass       from there on, where the opening is known to be free in the share wanted, wide and high enough for hull
//              and margin, and no occupied voxel lies within hull and margin of the planned path
//   turn away  else; and at once where even the straight way is blocked. It is final.
// While passing, a way that turns out to be blocked is turned away from as long as latest_decision_m allows it.
//
// Each image makes a new plan from where the vehicle is. Where the map has something within reach of the helix, the
// helix is flown at half its amplitude, then not at all. The paper says 20 to 30 m; with a torpedo-shaped vehicle
// at 1.5 m/s and an opening of 25 m by 8 m it is 23 m. One thread at a time.
#pragma once

#include <isobath/map/voxel_map.hpp>
#include <isobath/planning/helix.hpp>
#include <optional>

namespace isobath {

/// Along a path to the first occupied voxel nearer to it than `reach_m`, m; empty where there is none. Costs about 0.1
/// us a voxel within reach.
std::optional<double> first_occupied(const VoxelMap& map, const SpacePath& path, double reach_m);

enum class ApproachPhase : std::uint8_t { kHelix, kPass, kTurnAway };
const char* to_text(ApproachPhase phase);

class OpeningApproach {
 public:
  /// Begins at start_W; the opening must lie ahead. Throws Error where speed or opening make no sense.
  OpeningApproach(const HelixConfig& config, const VehicleSheet& sheet, double speed, const Eigen::Vector3d& start_W,
                  const Opening& opening);

  /// Once an image. `p_W`: of the vehicle; `known_share` of the opening (OpeningView, or awareness() of a map); `map`:
  /// none where there is no map.
  ApproachPhase step(const Eigen::Vector3d& p_W, const Opening& opening, double known_share, const VoxelMap* map);

  [[nodiscard]] ApproachPhase phase() const { return phase_; }
  /// Good until the next step.
  [[nodiscard]] const HelixPlan& plan() const { return *plan_; }
  [[nodiscard]] const HelixPlanner& planner() const { return planner_; }
  /// Before the opening, where the helix was left; empty before.
  [[nodiscard]] std::optional<double> left_at_m() const { return left_at_; }
  /// A level course away from the opening, to the side that the vehicle heads for.
  [[nodiscard]] Angle away(Angle heading) const;

 private:
  [[nodiscard]] bool fits_through(const Opening& opening) const;
  /// False where even the straight way is blocked.
  bool replan(const Opening& opening, double along_m, const VoxelMap* map);

  HelixConfig config_;
  VehicleSheet sheet_;
  HelixPlanner planner_;
  ApproachPhase phase_ = ApproachPhase::kHelix;
  std::optional<HelixPlan> plan_;
  std::optional<double> left_at_;
  double last_along_ = 0;
};

}  // namespace isobath
