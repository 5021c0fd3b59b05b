// PathFinder: candidate paths past obstacles that move, in order of preference (Rodin, Amin c. 1988, 2.1, 2.2; ledger
// S3-08, S3-09, S3-11, S3-13, S3-16, S3-17).
//
// Typical use, once a cycle: `set_obstacle` with the outline of each track now, or where it is predicted to be,
// `remove_obstacle` for tracks that ended, then `candidates` from the vehicle to the goal. The triangulation is kept
// from cycle to cycle; points move within it. A planner in time tries the paths one after the other, each with its own
// speeds.
//
// 1. Each obstacle is covered by convex parts, at first by one of at most six corners, and grown by the radius.
// 2. The road map is the dual of the triangulation of the parts' borders; see road_map.hpp for what it keeps.
// 3. NAMOA* finds the paths that are best in length, deviation from the straight line, and delay in narrow water.
//    They are straightened as far as they keep their clearance. The shortest path of the visibility graph joins them.
// 4. If there is no path, the obstacles in the way get a finer shape (S3-13), which they keep, and it begins again.
//
// All paths keep `radius_m` from all outlines. Motion is not considered here. Units: m, s, any level frame. Errors:
// Error for places that are not finite or beyond the region, and where more points are needed than `max_points`. Cost
// of a cycle with 50 bodies of 6 corners that all move, across 200 m (one core of 2.0 GHz): 2.2 ms for their outlines
// and 3.1 ms for the candidates with points 1 m apart along the sides, 0.4 ms and 1.6 ms with points 4 m apart.
#pragma once

#include <cstddef>
#include <cstdint>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <isobath/base/error.hpp>
#include <isobath/geometry/dynamic_delaunay.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/planning/roadmap/grown_obstacles.hpp>
#include <isobath/planning/roadmap/obstacle_shapes.hpp>
#include <isobath/planning/roadmap/pareto_search.hpp>
#include <isobath/planning/roadmap/road_map.hpp>
#include <map>
#include <span>
#include <vector>

namespace isobath {

struct PathFinderConfig {
  Eigen::AlignedBox2d region{Eigen::Vector2d(-100, -100), Eigen::Vector2d(100, 100)};  ///< of obstacles, start and goal
  double radius_m = 2;   ///< of the vehicle, with what it must keep off obstacles
  int sides = 12;        ///< of the polygon for a disc; more: obstacles grow by less than 1 / cos(pi / sides)
  double spacing_m = 1;  ///< of points along sides; larger: less to do, but narrow gaps may be lost (road_map.hpp)
  double wished_clearance_m = 5;  ///< below it the vehicle is slower in proportion
  double speed_m_s = 1.5;
  Preference preference = {};
  double tolerance = 0.05;  ///< paths that are worse than another by less than this share are left out
  std::size_t max_labels = 20'000;
  std::size_t max_candidates = 6;
  int max_points = 20'000;  ///< of all outlines, with those along their sides
};

struct PathCandidate {
  std::vector<Eigen::Vector2d> points;  ///< from the start to the goal
  double length_m = 0;
  double deviation_m2 = 0;  ///< integral of the distance to the straight line
  double delay_s = 0;       ///< from lower speed where the clearance is below the wished one
  double clearance_m =
      0;  ///< least distance to the shapes of obstacles, which hold them; at most 2 x wished_clearance_m
};

enum class PathRefusal : std::uint8_t { kStartBlocked, kGoalBlocked, kNoPath };
const char* to_text(PathRefusal refusal);

struct PathCandidates {
  std::vector<PathCandidate> paths;  ///< at least one, the preferred one first
  bool complete = true;              ///< false: the search stopped at max_labels
};

class PathFinder {
 public:
  explicit PathFinder(const PathFinderConfig& config);

  /// The outline of an obstacle now: new, moved, or changed. Simple outlines can show their concave water. Corners
  /// that are not finite are refused with Error. False where it reaches beyond the region; then it is left out.
  bool set_obstacle(int id, const Polygon& outline);
  void remove_obstacle(int id);
  Result<PathCandidates, PathRefusal> candidates(const Eigen::Vector2d& start, const Eigen::Vector2d& goal);

  /// The level of detail that an obstacle has now.
  [[nodiscard]] ShapeDetail detail(int id) const { return obstacles_.at(id).detail; }

 private:
  struct Part {
    int label = 0;
    Polygon outline;
    std::vector<int> points;  ///< of the triangulation, along the border
  };
  struct Obstacle {
    Polygon outline;
    ShapeDetail detail = ShapeDetail::kEnclosure;
    std::vector<Part> parts;
  };

  void shape(Obstacle& obstacle);
  void outline_points(Part& part);
  void clear(Obstacle& obstacle);
  [[nodiscard]] GrownObstacles grow() const;
  bool refine(int id);
  bool refine_covering(const GrownObstacles& grown, const Eigen::Vector2d& p);
  bool refine_shut(const RoadMap& map, const GrownObstacles& grown, std::span<const int> from);
  [[nodiscard]] PathCandidates found(const RoadMap& map, const GrownObstacles& grown, const Eigen::Vector2d& start,
                                     const Eigen::Vector2d& goal) const;
  [[nodiscard]] PathCandidate measured(const GrownObstacles& grown, std::vector<Eigen::Vector2d> points) const;
  void straighten(const GrownObstacles& grown, std::vector<Eigen::Vector2d>& points) const;
  [[nodiscard]] double delay(double length_m, double clearance_m) const;

  PathFinderConfig config_;
  Eigen::AlignedBox2d border_;
  DynamicDelaunay points_;
  std::map<int, Obstacle> obstacles_;
  std::vector<int> free_labels_;
  int labels_ = 0;
  std::vector<Eigen::Vector2d> scratch_;
};

}  // namespace isobath
