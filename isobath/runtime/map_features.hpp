// What stands in and around the water of a map, beside depths: obstructions, wrecks, rocks as objects; coast, contours,
// pipelines as lines (ledger S1-07, S1-20 to S1-25).
//
// All is kept in the map's object store: an object of its kind each, its depth as the attribute "depth" or "clear to",
// a line's points as the attribute "points". The trees that find what is near are made when the map is opened.
#pragma once

#include <cstdint>
#include <Eigen/Geometry>
#include <isobath/io/prior.hpp>
#include <isobath/map/depth_map.hpp>
#include <isobath/map/object_store.hpp>
#include <isobath/map/pmr_quadtree.hpp>
#include <isobath/map/pr_quadtree.hpp>
#include <isobath/planning/traversability.hpp>
#include <memory>
#include <string>
#include <vector>

namespace isobath {

inline constexpr std::uint32_t kChartedObject = 1U << 0;  ///< capability: from a chart
inline constexpr std::uint32_t kBlocksPassage = 1U << 1;  ///< a vehicle must not touch it
inline constexpr std::uint32_t kLineFeature = 1U << 2;
inline constexpr std::uint32_t kFoundObject = 1U << 3;  ///< capability: found by sonar (found_objects)

/// Writes points and lines of priors into the store, in one transaction. Returns how many objects.
std::size_t store_features(ObjectStore& store, const std::vector<Prior>& priors, Time time);

/// What an area covers, north and east in m.
Eigen::AlignedBox2d box_of(const DepthArea& area);

struct MapFeatures {
  struct Line {
    ObjectId id = 0;
    std::string kind;
    std::vector<Eigen::Vector2d> points;
    bool blocks = false;
  };
  std::vector<MapObject> objects;  ///< of the points
  std::vector<Line> lines;
  PrQuadtree points;     ///< index into `objects`
  PmrQuadtree segments;  ///< id: line index << 32 | segment
};
MapFeatures load_features(const ObjectStore& store, const DepthArea& area);

/// What a passage through a window (north, east) must keep away from: objects that block and lines that are solid, with
/// `radius_m` of doubt around each. Only what is near is looked at (S1-25).
std::vector<ChartObstacle> obstacles_near(const MapFeatures& features, const Eigen::AlignedBox2d& window,
                                          double radius_m);

/// The same of priors, without a store between.
std::vector<ChartObstacle> obstacles_of(const std::vector<Prior>& priors);

}  // namespace isobath
