// DepthPrior: charts, grids and outlines as the prior of a depth map (ledger S1-13, S1-14, S1-46, S1-73, S1-81).
//
// Each file is read onto squares that are quadrants of the map, 4096 across the area (or `pixel_m` wide), so that a
// coarse prior is a small tree. A later file fills only what earlier files leave unknown. A charted pixel has the base
// confidence of the rules for a sigma of a third of the margin, and less, down to the threshold, for larger ones: the
// map believes the first sonar that contradicts a doubtful chart.
//
// Rough ground (S1-72), if `rough_m` is set: the confidence is at most round(20 / (1 + var / rough_m^2)), var the
// variance of the charted depths of the 3 x 3 squares around, but never below the threshold. Off by default. A higher
// base delays the map, so smooth ground gains nothing (same base, same delay, same false obstacles), and rough ground
// trades false obstacles for earlier detection: of 1000 readings with 5 % spurious ones, standing still, 41 make
// obstacles instead of 4, and a real one is seen after 1 reading instead of 4 (docs/detection-delay.md, bases 2 and 5).
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/charts/read_prior.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/perception/depth_parts.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct DepthPriorConfig {
  std::string file;                     ///< chart, grid, outline or soundings; empty: none
  double pixel_m = 0;                   ///< side of its squares; 0: follows from the size of the area
  double rough_m = 0;                   ///< standard deviation of depths that makes ground rough; 0: off
  std::string datum = "water surface";  ///< the map's depths are below it
  PriorConfig reading;
};
std::vector<Field> fields(DepthPriorConfig& config);

struct DepthPrior {
  std::vector<std::string> sources;
  std::vector<Prior> files;  ///< what they hold besides depths; their rasters are freed
  std::optional<RegionQuadtree> depth, state;

  /// Trees of a new map.
  [[nodiscard]] DepthTrees trees(int levels) const;
};

/// `mapper`: its rules give the confidences. Throws Error if a file cannot be used.
DepthPrior read_depth_prior(const std::vector<std::string>& files, const DepthPriorConfig& config,
                            const DepthMapperParts& mapper, const DepthArea& area,
                            const std::optional<GeoOrigin>& origin);

}  // namespace isobath
