// SpaceRouteTask: what a path in three dimensions is asked for, and the settings of its search (space_route.hpp).
#pragma once

#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/base/config.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

struct SpaceRouteConfig {
  double clearance_m = 1.2;         ///< from the hull, all round
  double wished_clearance_m = 2.5;  ///< kept where there is room
  double room_weight = 1;
  double depth_weight = 0.05;  ///< 1/m
  double decide_m = 14;
  double reach_m = 80;
  double margin_m = 20;  ///< of the box, around start and goal
  int max_expanded = 200'000;
};
std::vector<Field> fields(SpaceRouteConfig& config);

struct SpaceRouteTask {
  Eigen::Vector3d start = Eigen::Vector3d::Zero(), goal = Eigen::Vector3d::Zero();
  std::optional<Angle> heading;  ///< at the start; empty: any
  double half_width_m = 0.25;
  double turning_radius_m = 0;
  double steepest = 0.3;  ///< m of depth per metre of path; infinite: the vehicle can rise on the spot
  double min_depth_m = 0, max_depth_m = std::numeric_limits<double>::infinity();  ///< of the path
  std::span<const Hazard> hazards;
};

/// Whether start and goal are finite and within 1e7 m of the origin.
bool is_finite(const SpaceRouteTask& task);

}  // namespace isobath
