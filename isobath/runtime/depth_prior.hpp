// DepthPrior: charts, grids and outlines as the prior of a depth map (ledger S1-13, S1-14, S1-46, S1-73, S1-81).
//
// Each file is read onto squares of the map's own quadrants, as fine as 4096 of them span the area (or as `pixel_m`
// says), so that a coarse prior is a small tree. Later files stand where earlier ones say nothing. A charted pixel's
// confidence is that of the rules for a sigma of a third of the margin, and falls to the threshold with larger ones:
// the first sonar that contradicts a doubtful chart is believed.
//
// Rough ground (S1-72), where `rough_m` is set: confidence round(20 / (1 + var / rough_m^2)) where that is less, var
// the variance of the charted depths of the 3 x 3 squares around, but never below the threshold. Off by default: a base
// is a delay, so smooth ground gains nothing (same base, same delay, same false obstacles) and rough ground trades
// false obstacles for an earlier belief: of 1000 readings with 5 % spurious ones, standing still, 41 make obstacles
// instead of 4, and a real one is seen after 1 reading instead of 4 (docs/detection-delay.md, bases 2 and 5).
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/prior.hpp>
#include <isobath/map/depth_map.hpp>
#include <isobath/perception/depth_parts.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct DepthPriorConfig {
  std::string file;                     ///< chart, grid, outline or soundings; empty: none
  double pixel_m = 0;                   ///< side of its squares; 0: by the size of the area
  double rough_m = 0;                   ///< standard deviation of depths that makes ground rough; 0: none is
  std::string datum = "water surface";  ///< what the map's depths are below
  PriorConfig reading;
};
std::vector<Field> fields(DepthPriorConfig& config);

struct DepthPrior {
  std::vector<std::string> sources;
  std::vector<Prior> files;  ///< what stands in them beside depths; their rasters are let go
  std::optional<RegionQuadtree> depth, state;

  /// Trees of a new map.
  [[nodiscard]] DepthTrees trees(int levels) const;
};

/// Confidences by the rules of the mapper that goes on with it. Throws Error where a file cannot be used.
DepthPrior read_depth_prior(const std::vector<std::string>& files, const DepthPriorConfig& config,
                            const DepthMapperParts& mapper, const DepthArea& area,
                            const std::optional<GeoOrigin>& origin);

}  // namespace isobath
