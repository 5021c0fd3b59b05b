// check_path: checks whether a vehicle, or several abreast, can follow a path over a stored map, and names the reason
// if not (ledger S1-41, S1-82); finds the safest, most efficient way from point to point (S1-42, S1-78); plots a course
// along a pipeline, a coast or a contour (S1-24, S1-78); and says how likely a vehicle on the path is detected or
// destroyed (S1-37).
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/map/features/object_store.hpp>
#include <isobath/planning/area_traversability.hpp>
#include <isobath/planning/feature_course.hpp>
#include <isobath/planning/pilot_search.hpp>
#include <isobath/planning/traversability.hpp>
#include <isobath/studies/line_to_follow.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct PathRequest {
  std::filesystem::path map;
  std::vector<GeoPoint> points;            ///< way-points on the globe; or
  std::vector<Eigen::Vector2d> local_m;    ///< north, east of W, for maps without a geographic origin
  double draught_m = 1;                    ///< depth of the vehicle's lowest part
  double obstacle_radius_m = 5;            ///< position uncertainty of charted objects
  PilotSearchConfig search;                ///< its passage also when straight legs are checked
  bool find = false;                       ///< finds a way between the points instead of checking the straight legs
  LineWanted line;                         ///< follows a line from the first point to the second instead
  double offset_m = 0;                     ///< of the course from that line, to starboard
  std::optional<double> altitude_m;        ///< above the bottom, along a line; without it, the depth is the draught
  Formation formation;                     ///< all of them need the water
  std::optional<double> objects_within_m;  ///< lists the objects of the map within this of the first point (S1-21)
  std::filesystem::path threats;           ///< a file of areas (threat_areas.hpp); empty: none
};

/// A point object of the map near the first point of the path.
struct ObjectNear {
  std::string kind;
  std::string name;
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();
  double depth_m = 0;                  ///< of its top; 0 if the map does not say
  double distance_m = 0;               ///< from the first point
  std::vector<ShapeReference> shapes;  ///< newest of each attribute that holds one, by its name (S1-09)
};

/// How many vehicles can go abreast.
struct AbreastOutcome {
  int vehicles = 0;        ///< by every pixel of the map, its confidence and the charted objects
  VehiclesAbreast blocks;  ///< by the depths of blocks of 8 x 8 pixels alone
  double mixed_share = 0;  ///< of the formation's corridor: blocks that do not decide
};

struct ThreatOutcome {
  std::size_t areas = 0;
  PathRisk detection, destruction;                    ///< of the path
  PathRisk straight_detection, straight_destruction;  ///< of the straight legs between the points
};

struct PathOutcome {
  Traversability verdict;            ///< of the straight legs, or of the way that was found or plotted
  std::vector<Eigen::Vector3d> way;  ///< north, east of W, depth; empty: none was asked for, or there is none
  std::int64_t queries = 0;          ///< steps whose corridor the search checked
  std::string reason;                ///< one line; empty if the whole path is clear
  std::string least;                 ///< one line: the least depth on the path and where; empty if none is known
  std::optional<GeoOrigin> origin;   ///< of the map
  double length_m = 0;
  std::size_t obstacles = 0;                 ///< of the map, near enough to the path to be examined (S1-25)
  std::optional<ObjectNear> nearest_object;  ///< to the first point; empty: the map has no objects
  std::vector<ObjectNear> objects;           ///< within objects_within_m, nearest first
  std::optional<AbreastOutcome> abreast;     ///< of more than one vehicle
  std::optional<ThreatOutcome> threats;
};

/// Throws Error if the map cannot be opened, if the path is invalid, or if there is no line to follow.
PathOutcome check_path(const PathRequest& request);

/// " (41.792998, -82.688810)": latitude and longitude of a place in W; empty without an origin.
std::string place_text(const std::optional<GeoOrigin>& origin, const Eigen::Vector2d& place);

/// A mission file whose points are those of the way that was found or plotted. The vehicle is where a way that was
/// found begins; a course along a line begins at its first point.
std::string mission_along(const PathRequest& request, const PathOutcome& outcome);

}  // namespace isobath
