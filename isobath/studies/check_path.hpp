// check_path: checks whether a vehicle can follow a path over a stored map, and names the reason if not (ledger S1-41).
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/planning/traversability.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct PathRequest {
  std::filesystem::path map;
  std::vector<GeoPoint> points;          ///< way-points on the globe; or
  std::vector<Eigen::Vector2d> local_m;  ///< north, east of W, for maps without a geographic origin
  double draught_m = 1;                  ///< depth of the vehicle's lowest part
  double obstacle_radius_m = 5;          ///< position uncertainty of charted objects
  PassageConfig passage;
};

struct PathOutcome {
  Traversability verdict;
  std::string reason;               ///< one line; empty if the whole path is clear
  std::string least;                ///< one line: the least depth on the path and where; empty if none is known
  std::optional<GeoOrigin> origin;  ///< of the map
  double length_m = 0;
};

/// Throws Error if the map cannot be opened or the path is invalid.
PathOutcome check_path(const PathRequest& request);

}  // namespace isobath
