// What sonar has changed in a depth map against its charts, region by region, and where the vehicle went: read from the
// trees alone, after the mission or at the end of a run (Oskard 1990, III-A; ledger S1-77, S1-18).
//
// A sensed pixel is changed where it lies shoaler or deeper than the charted depth by more than the margin. Changed
// pixels of one sense that touch, corners included, are one region. Which kind of sonar changed a region is told by the
// flags of its pixels: an obstacle is a shoaler region most of which only forward sonar has spoken of. Sensed pixels
// over uncharted water change nothing; they are counted.
//
// Depths positive down, m; places (north, east) of W. Memory goes with the number of regions and the width of the map,
// not with its area; only tiles that hold something are read.
#pragma once

#include <isobath/map/map_folder.hpp>
#include <isobath/runtime/map_raster.hpp>
#include <string>
#include <vector>

namespace isobath {

struct ChangedRegion {
  bool shoaler = false;  ///< than charted; else deeper
  Eigen::Vector2d south_west{0, 0}, north_east{0, 0};
  double area_m2 = 0;
  std::uint64_t pixels = 0;
  Eigen::Vector2d shoalest_at{0, 0};
  double shoalest_m = 0;
  double charted_m = 0;                                                  ///< there
  int confidence = 0;                                                    ///< there, of 20
  std::uint64_t by_depth_sonar = 0, by_obstacle_sonar = 0, by_both = 0;  ///< pixels
  std::uint32_t last_minute = 0;  ///< of the map, at which a reading last spoke of it

  /// The kind of sonar that changed most of it.
  [[nodiscard]] DepthSource source() const;
  /// Found by forward sonar where the chart has water.
  [[nodiscard]] bool is_obstacle() const { return shoaler && source() == DepthSource::kObstacleSonar; }
};

struct MapChanges {
  std::vector<ChangedRegion> regions;  ///< obstacles first; then by area, the largest first
  std::uint64_t sensed_pixels = 0;
  std::uint64_t uncharted_pixels = 0;  ///< sensed where there is no chart
  std::uint64_t changed_pixels = 0;
  std::vector<PixelWindow> track;  ///< where the vehicle was: stretches of a row, from the north-west
  std::uint64_t track_pixels = 0;

  [[nodiscard]] std::size_t obstacles() const;
};

MapChanges find_changes(const DepthTrees& trees, const PixelGrid& grid, double margin_m);

const char* to_text(DepthSource source);
/// "obstacle", "shoaler", "deeper".
const char* kind_of(const ChangedRegion& region);

}  // namespace isobath
