// GeoTIFF: rasters of maps for geographic information systems, written by GDAL.
//
// With an origin on the globe, the coordinate system is the azimuthal equidistant projection of WGS 84 around it: east
// and north of W in metres (within 4 mm of the tangent plane at 10 km, 4 m at 100 km). Without an origin, it is a local
// engineering system that is not tied to the globe. Rasters may be rotated: the geotransform holds the rotation. The
// same cells give the same bytes. Errors: throws Error if the file cannot be written.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <filesystem>
#include <isobath/base/angle.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <optional>
#include <span>
#include <string>

namespace isobath {

/// Position and orientation of a raster in the horizontal plane of W.
struct RasterFrame {
  int columns = 0;
  int rows = 0;
  double cell_m = 0;
  Eigen::Vector2d corner_m = {0, 0};  ///< north, east of the outer corner of the first cell (top left)
  Angle up;                           ///< direction in which columns run upwards, clockwise from north
  std::optional<GeoOrigin> origin;
};

struct RasterMeaning {
  std::string name;  ///< "occupancy probability"
  std::string unit;  ///< "m"; empty: none
};

struct RasterBand {
  RasterMeaning meaning;
  std::span<const float> cells;
};

/// Several bands of one frame, such as a depth and its sigma. Rows from the top, columns from the left; NaN: no data.
void write_geotiff(const std::filesystem::path& file, const RasterFrame& frame, std::span<const RasterBand> bands);
/// One band.
void write_geotiff(const std::filesystem::path& file, const RasterFrame& frame, const RasterMeaning& meaning,
                   std::span<const float> cells);
/// `no_data` is the value of unknown cells.
void write_geotiff(const std::filesystem::path& file, const RasterFrame& frame, const RasterMeaning& meaning,
                   std::span<const std::uint8_t> cells, std::optional<std::uint8_t> no_data);

}  // namespace isobath
