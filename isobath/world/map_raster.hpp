// MapRaster: a depth map as plain rows of numbers, for pictures, GeoTIFF and arrays.
//
// Rows from the north, columns from the west. If cells are coarser than pixels, a cell has the values of its shoalest
// known pixel: depth, confidence, age and source. The chart thus errs only to the safe side.
#pragma once

#include <filesystem>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/map/depth/pixel_grid.hpp>
#include <isobath/perception/reading_evidence.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

enum class DepthSource : std::uint8_t { kNone, kPrior, kDepthSonar, kObstacleSonar, kBoth };

struct MapRaster {
  PixelGrid grid;                        ///< grid of the cells
  PixelWindow window;                    ///< in cells
  std::vector<float> depth_m;            ///< NaN: unknown
  std::vector<std::uint8_t> confidence;  ///< 0..20; 255: unknown
  std::vector<std::uint8_t> flags;       ///< PixelFlag
  std::vector<float> age_min;            ///< minutes from the map's epoch to the last reading; NaN: no reading
};

/// The bounding window of all pixels with a charted or sensed depth; its width is 0 if there are none.
PixelWindow known_extent(const DepthTrees& trees);
/// Cells of `pixels_a_cell` pixels a side; 0: as fine as 16 million cells allow.
MapRaster read_raster(const DepthSnapshot& snapshot, const PixelWindow& pixels, int pixels_a_cell = 0);
/// A snapshot of a stored map.
std::shared_ptr<const DepthSnapshot> snapshot_of(const StoredMap& map);

/// Total vertical uncertainty of each cell at 95 %, m, as the map's revisits have shown it; NaN where no depth sonar
/// has measured, and everywhere without revisits. `margin`: within which soundings of the map agree.
std::vector<float> vertical_uncertainty(const MapRaster& raster, const RevisitRecord& revisits,
                                        const ReadingEvidenceConfig& margin);
/// Bands: depth (m), confidence (0..1), age (days before the map's last reading), source (DepthSource as a number),
/// total vertical uncertainty (m). Throws Error if the file cannot be written.
void write_map_geotiff(const MapRaster& raster, const MapFacts& facts, const ReadingEvidenceConfig& margin,
                       const std::filesystem::path& file);

}  // namespace isobath
