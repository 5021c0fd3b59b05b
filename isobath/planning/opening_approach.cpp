#include <algorithm>
#include <cmath>
#include <isobath/planning/opening_approach.hpp>

namespace isobath {

using Eigen::Vector3d;

std::optional<double> first_occupied(const VoxelMap& map, const SpacePath& path, double reach_m) {
  const double voxel = map.voxel_m();
  // Half the diagonal of a voxel: its content may lie in its nearest corner.
  const double reach = reach_m + 0.5 * std::sqrt(3.0) * voxel;
  const int parts = std::max(1, static_cast<int>(std::ceil(path.length() / voxel)));
  for (int i = 0; i <= parts; ++i) {
    const double s = path.length() * i / parts;
    const Vector3d p = path.frame_at(s).p_W;
    const VoxelIndex least = map.voxel_at(p.array() - reach), most = map.voxel_at(p.array() + reach);
    for (int x = least.x(); x <= most.x(); ++x) {
      for (int y = least.y(); y <= most.y(); ++y) {
        for (int z = least.z(); z <= most.z(); ++z) {
          const VoxelIndex v(x, y, z);
          if ((map.centre_of(v) - p).squaredNorm() > reach * reach) continue;
          if (map.space(v) == Space::kOccupied) return s;
        }
      }
    }
  }
  return std::nullopt;
}

const char* to_text(ApproachPhase phase) {
  switch (phase) {
    case ApproachPhase::kHelix: return "helix";
    case ApproachPhase::kPass: return "pass";
    case ApproachPhase::kTurnAway: return "turn away";
  }
  return "";
}

OpeningApproach::OpeningApproach(const HelixConfig& config, const VehicleParameters& parameters, double speed,
                                 const Vector3d& start_W, const Opening& opening)
    : config_(config), parameters_(parameters), planner_(config, parameters, speed, start_W, opening) {
  plan_ = planner_.plan(opening, 0);
}

bool OpeningApproach::fits_through(const Opening& opening) const {
  const double least = 2 * (parameters_.half_width_m + config_.margin_m);
  return opening.width_m >= least && opening.height_m >= least;
}

bool OpeningApproach::replan(const Opening& opening, double along_m, const VoxelMap* map) {
  const HelixPlanner before = planner_;
  for (const double amplitude : {1.0, 0.5, 0.0}) {
    planner_ = before;
    plan_ = planner_.plan(opening, along_m, amplitude);
    if (!map || !first_occupied(*map, plan_->path, parameters_.half_width_m + config_.margin_m)) return true;
  }
  return false;
}

ApproachPhase OpeningApproach::step(const Vector3d& p_W, const Opening& opening, double known_share,
                                    const VoxelMap* map) {
  if (phase_ == ApproachPhase::kTurnAway) return phase_;
  const double along = planner_.along(p_W);
  const double distance = planner_.along(opening.X_WO.translation) - along;
  const bool committed = phase_ == ApproachPhase::kPass && distance < planner_.latest_m();  // too late to turn away
  const bool clear = replan(opening, along, map);
  // Leave now if it would be too late by the next image.
  const bool leaves = distance - (along - last_along_) <= plan_->leave_m;
  last_along_ = along;
  if (phase_ == ApproachPhase::kHelix && leaves) {
    left_at_ = distance;
    planner_.leave();
    const bool known = known_share >= config_.pass_share;
    phase_ = clear && known && fits_through(opening) ? ApproachPhase::kPass : ApproachPhase::kTurnAway;
  } else if (!clear && !committed) {
    if (!left_at_) left_at_ = distance;
    phase_ = ApproachPhase::kTurnAway;
  }
  return phase_;
}

Angle OpeningApproach::away(Angle heading) const {
  const Angle line = planner_.X_WL().rotation.heading();
  const double side = (heading - line).wrapped().radians() < 0 ? -1 : 1;
  // A third of a circle at a time: a set-point straight behind has no side.
  const Angle behind = line + Angle::degrees(180);
  const Angle rest = (behind - heading).wrapped_positive();
  const double to_go = side > 0 ? rest.degrees() : 360 - rest.degrees();
  return to_go > 120 ? (heading + Angle::degrees(120 * side)).wrapped() : behind.wrapped();
}

}  // namespace isobath
