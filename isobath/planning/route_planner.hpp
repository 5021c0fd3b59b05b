// RoutePlanner: a way past what is in the way (Ganesan 2015, 5.2.2, algorithm 1; ledger S6-44 to S6-52).
//
// A* over cells with eight neighbours, no corner cut; then the way is pulled straight as far as the clearance allows,
// and its corners are checked to be ones that the vehicle can turn. Pure: a function of map, request and configuration;
// the budget counts expansions, so that the same request gives the same answer on any machine.
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/planning/hazard_map.hpp>

namespace isobath {

struct RouteConfig {
  double cell_m = 1;
  double clearance_m = 3;  ///< from the vehicle's hull to a hazard
  int most_expanded = 200'000;
};
std::vector<Field> fields(RouteConfig& config);

enum class RouteRefusal : std::uint8_t { kNotFinite, kStartBlocked, kGoalBlocked, kNoPath, kOutOfBudget };
const char* to_text(RouteRefusal refusal);

struct RouteTask {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  std::optional<double> heading;  ///< at the start, from x towards y; empty: any
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();
  double half_width_m = 0.5;
  double turning_radius_m = 0;
};

struct RoutePath {
  std::vector<Eigen::Vector2d> points;  ///< start, corners, goal
  double length_m = 0;
  double clearance_m = 0;  ///< least distance of the way to a hazard; infinite without
  int expanded = 0;
};

Result<RoutePath, RouteRefusal> plan_route(const HazardMap& map, const RouteTask& request, const RouteConfig& config);

}  // namespace isobath
