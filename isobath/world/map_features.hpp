// MapFeatures: the features of a map beside depths: obstructions, wrecks and rocks as objects; coast, contours and
// pipelines as lines (ledger S1-07, S1-20, S1-22 to S1-25).
//
// The map's object store holds one object per feature, with its kind. The attribute "depth" or "clear to" holds its
// depth, and the attribute "points" holds the points of a line. The trees for spatial queries are built when the map is
// opened.
#pragma once

#include <cstdint>
#include <Eigen/Geometry>
#include <isobath/io/charts/read_prior.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/map/features/object_store.hpp>
#include <isobath/map/features/pmr_quadtree.hpp>
#include <isobath/map/features/pr_quadtree.hpp>
#include <isobath/perception/corner_fix.hpp>
#include <isobath/planning/traversability.hpp>
#include <memory>
#include <string>
#include <vector>

namespace isobath {

inline constexpr std::uint32_t kChartedObject = 1U << 0;  ///< capability: from a chart
inline constexpr std::uint32_t kBlocksPassage = 1U << 1;  ///< a vehicle must not touch it
inline constexpr std::uint32_t kLineFeature = 1U << 2;
inline constexpr std::uint32_t kFoundObject = 1U << 3;  ///< capability: found by sonar (found_objects)

/// Writes points, lines and coasts of priors into the store, in one transaction. Returns the number of features.
std::size_t store_features(ObjectStore& store, const std::vector<Prior>& priors, Time time);

/// The extent of an area: north and east, m.
Eigen::AlignedBox2d box_of(const DepthArea& area);

struct MapFeatures {
  explicit MapFeatures(const DepthArea& area);  ///< none yet

  struct Line {
    ObjectId id = 0;
    std::string kind;
    std::string name;
    double depth_m = 0;  ///< 0 if the chart does not say
    std::vector<Eigen::Vector2d> points;
    bool blocks = false;
  };
  std::vector<MapObject> objects;  ///< the point features
  std::vector<Line> lines;
  PrQuadtree points;     ///< index into `objects`
  PmrQuadtree segments;  ///< id: line index << 32 | segment
};
MapFeatures load_features(const ObjectStore& store, const DepthArea& area);

/// The obstacles that a passage through a window (north, east) must avoid: blocking objects and blocking lines, each
/// with `radius_m` of uncertainty around it. Only features near the window are examined (S1-25).
std::vector<ChartObstacle> obstacles_near(const MapFeatures& features, const Eigen::AlignedBox2d& window,
                                          double radius_m);

/// The straight parts of charted coast, structures and obstructions, for position fixes by their corners (S4-49).
std::vector<ChartedWall> walls_of(const MapFeatures& features);
std::vector<ChartedWall> walls_of(const std::vector<Prior>& priors);

/// The obstacles of priors, without an object store.
std::vector<ChartObstacle> obstacles_of(const std::vector<Prior>& priors);

}  // namespace isobath
