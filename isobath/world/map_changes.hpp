// MapChanges: the regions in which sonar has changed a depth map against its charts, and the track of the vehicle. They
// are read from the trees alone, after the mission or at the end of a run (Oskard 1990, III-A; ledger S1-77, S1-18).
//
// A sensed pixel counts as changed if it is shoaler or deeper than the charted depth by more than the margin. Changed
// pixels of the same sense that touch, corners included, form one region. The flags of the pixels tell which kind of
// sonar changed a region. An obstacle is a shoaler region of which most pixels were seen by forward sonar only. Sensed
// pixels over uncharted water are counted, but belong to no region.
//
// Depths are in m, positive down; positions are (north, east) in W. Memory grows with the number of regions and the
// width of the map, not with its area; only tiles with sensed pixels or track are read.
#pragma once

#include <isobath/map/depth/map_folder.hpp>
#include <isobath/world/map_raster.hpp>
#include <string>
#include <vector>

namespace isobath {

struct ChangedRegion {
  bool shoaler = false;  ///< shoaler than charted; else deeper
  Eigen::Vector2d south_west{0, 0}, north_east{0, 0};
  double area_m2 = 0;
  std::uint64_t pixels = 0;
  Eigen::Vector2d shoalest_at{0, 0};
  double shoalest_m = 0;
  double charted_m = 0;                                                  ///< at the shoalest pixel
  int confidence = 0;                                                    ///< at the shoalest pixel, 0..20
  std::uint64_t by_depth_sonar = 0, by_obstacle_sonar = 0, by_both = 0;  ///< pixels
  std::uint32_t last_minute = 0;  ///< minutes from the map's epoch to the newest reading of the region

  /// The kind of sonar that changed most of the region.
  [[nodiscard]] DepthSource source() const;
  /// Found by forward sonar where the chart has water.
  [[nodiscard]] bool is_obstacle() const { return shoaler && source() == DepthSource::kObstacleSonar; }
};

struct MapChanges {
  std::vector<ChangedRegion> regions;  ///< obstacles first; then by area, the largest first
  std::uint64_t sensed_pixels = 0;
  std::uint64_t uncharted_pixels = 0;  ///< sensed pixels without a charted depth
  std::uint64_t changed_pixels = 0;
  std::vector<PixelWindow> track;  ///< pixels that the vehicle passed, as row segments from the north-west
  std::uint64_t track_pixels = 0;

  [[nodiscard]] std::size_t obstacles() const;
};

MapChanges find_changes(const DepthTrees& trees, const PixelGrid& grid, double margin_m);

const char* to_text(DepthSource source);
/// "obstacle", "shoaler", "deeper".
const char* kind_of(const ChangedRegion& region);

}  // namespace isobath
