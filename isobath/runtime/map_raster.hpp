// MapRaster: a depth map as plain rows of numbers, for pictures, GeoTIFF and whoever wants arrays.
//
// Rows from the north, columns from the west. Where cells are coarser than pixels, a cell is the shoalest known pixel
// in it, with that pixel's confidence, age and source: a chart may err to the safe side only.
#pragma once

#include <filesystem>
#include <isobath/map/map_folder.hpp>
#include <isobath/runtime/depth_chart.hpp>
#include <optional>
#include <vector>

namespace isobath {

enum class DepthSource : std::uint8_t { kNone, kPrior, kDepthSonar, kObstacleSonar, kBoth };

struct MapRaster {
  PixelGrid grid;                        ///< of the cells
  PixelWindow window;                    ///< in cells
  std::vector<float> depth_m;            ///< NaN: nobody knows
  std::vector<std::uint8_t> confidence;  ///< 0..20; 255: nobody knows
  std::vector<std::uint8_t> flags;       ///< PixelFlag
  std::vector<float> age_min;            ///< minutes since the map's epoch at the last reading; NaN: none
};

/// The least window that holds all that is known, in pixels; empty (width 0) where nothing is.
PixelWindow known_extent(const DepthTrees& trees);
/// Cells of `pixels_a_cell` pixels; 0: as fine as at most 16 million cells allow.
MapRaster read_raster(const DepthSnapshot& snapshot, const PixelWindow& pixels, int pixels_a_cell = 0);
/// Of a stored map.
std::shared_ptr<const DepthSnapshot> snapshot_of(const StoredMap& map);

/// Bands: depth (m), confidence (0..1), age (days before the map's last reading), source (DepthSource as a number).
/// Throws Error where the file cannot be written.
void write_map_geotiff(const MapRaster& raster, const MapFacts& facts, const std::filesystem::path& file);

/// What a chart is drawn from: charted depths and those of depth sonars, not the bounds that forward sonars set.
/// Tracks, shore and obstructions are for the caller to add.
DepthChart chart_of(const MapRaster& raster, const MapFacts& facts);

}  // namespace isobath
