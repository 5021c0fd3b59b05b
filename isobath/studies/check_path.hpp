// check_path: checks whether a vehicle can follow a path over a stored map, and names the reason if not (ledger S1-41);
// or finds the safest, most efficient way from point to point (S1-42).
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/planning/pilot_search.hpp>
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
  PilotSearchConfig search;              ///< its passage also when straight legs are checked
  bool find = false;                     ///< finds a way between the points instead of checking the straight legs
};

struct PathOutcome {
  Traversability verdict;            ///< of the straight legs, or of the way that was found
  std::vector<Eigen::Vector2d> way;  ///< that was found, north, east of W; empty: none was asked for, or there is none
  std::int64_t queries = 0;          ///< steps whose corridor the search checked
  std::string reason;                ///< one line; empty if the whole path is clear
  std::string least;                 ///< one line: the least depth on the path and where; empty if none is known
  std::optional<GeoOrigin> origin;   ///< of the map
  double length_m = 0;
};

/// Throws Error if the map cannot be opened or the path is invalid.
PathOutcome check_path(const PathRequest& request);

/// " (41.792998, -82.688810)": latitude and longitude of a place in W; empty without an origin.
std::string place_text(const std::optional<GeoOrigin>& origin, const Eigen::Vector2d& place);

/// A mission file whose points are those of the way that was found, at the depth of the vehicle's lowest part.
std::string mission_along(const PathRequest& request, const PathOutcome& outcome);

}  // namespace isobath
