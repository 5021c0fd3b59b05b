// Priors: depths and objects that are known before the first dive (ledger S1-13, S1-14, S1-D07).
//
// read_prior reads a survey, a chart or a list of soundings into a raster of depths with their sigma, on the pixels of
// the map, and lists the file's obstructions, lines and areas. It reads
//   rasters:   GeoTIFF, BAG (uncertainty from its second band), netCDF, AAIGrid, gridded XYZ, Surfer grids
//   charts:    S-57 cells with their updates
//   outlines:  shapefiles, GeoJSON and GeoPackages of a water body: land outside, unknown depth inside
//   soundings: text with columns (x y z, longitude latitude depth, north east down; see PriorConfig)
// Depths are metres below the map's water surface, positive down; sigma is one standard deviation. Points are (north,
// east) of W. Everything is reprojected to the local plane; the file states its position on the globe.
//
// Datum: a depth means nothing without its datum. A prior whose datum is unknown, or differs from that of the map, is
// refused unless the offset to the map's water surface is configured. Sign: `automatic` uses the format's own
// convention (BAG and heights up, S-57 and depths down) and refuses a file if there is none or the numbers contradict
// it.
//
// Resampling: if cells are finer than pixels, a pixel takes the mean of the cells within it, and their spread is added
// to its sigma, or it takes the shoalest cell. If cells are coarser, depth is bilinear between cell centres (or the
// shoalest of the four) and sigma is bilinear in variance; beside a hole, only the cell that holds the pixel's centre
// counts. Rotated rasters are resampled, not refused. Soundings become a surface with continuous slope
// (geometry/smooth_surface.hpp). On charts, soundings, contours and coast make that surface, and the depth areas limit
// it; where the surface has no value, the shoal limit of the area is used. Land is depth 0.
//
// Bad input: a file that is damaged as a whole, contradicts itself, or does not reach the window is refused with one
// line (Error). Single bad cells, soundings and objects are left out and counted by reason. Memory is bounded by the
// window, not by the raster, which is read in tiles. Nothing is printed. Threads: calls may run in parallel. HDF5 files
// (BAG, netCDF-4) go through a library that is not proof against every forgery: convert untrusted ones elsewhere.
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/charts/prior_data.hpp>
#include <optional>

namespace isobath {

/// The centre of the area that a file covers; empty if the file does not state it, as for text. Throws Error if the
/// file cannot be opened.
std::optional<GeoPoint> centre_of_prior(const std::filesystem::path& file, const PriorConfig& config);

/// Throws Error.
Prior read_prior(const std::filesystem::path& file, const PriorConfig& config, const LocalPlane& plane,
                 const PriorWindow& wanted);

}  // namespace isobath
