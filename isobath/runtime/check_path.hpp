// Whether a vehicle can go along a path over a stored map, and the reason where it cannot (ledger S1-41).
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/planning/traversability.hpp>
#include <string>
#include <vector>

namespace isobath {

struct PathRequest {
  std::filesystem::path map;
  std::vector<GeoPoint> points;          ///< way-points on the globe; or
  std::vector<Eigen::Vector2d> local_m;  ///< north, east of W, for maps without a place on the globe
  double draught_m = 1;                  ///< depth of the vehicle's lowest part
  double obstacle_radius_m = 5;          ///< doubt about the place of charted objects
  PassageConfig passage;
};

struct PathOutcome {
  Traversability verdict;
  std::string reason;  ///< one line; empty where the whole path is clear
  std::string least;   ///< one line: the least water on the way and where; empty where none is known
  double length_m = 0;
};

/// Throws Error where the map cannot be opened or the path is none.
PathOutcome check_path(const PathRequest& request);

}  // namespace isobath
