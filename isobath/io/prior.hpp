// Priors: what is known of a place before anybody dives (ledger S1-13, S1-14, S1-D07).
//
// read_prior makes of a survey, a chart or a list of soundings a raster of depths with their sigma on the pixels that
// the map wants, and what else stands in it: obstructions, lines, areas. Read are
//   rasters:   GeoTIFF, BAG (uncertainty from its second band), netCDF, AAIGrid, gridded XYZ, Surfer grids
//   charts:    S-57 cells with their updates
//   outlines:  shapefiles and GeoJSON of a water body: land outside, nothing known inside
//   soundings: text with columns (x y z, longitude latitude depth, north east down; see PriorConfig)
// Depths are metres below the map's water surface, positive down; sigma is one standard deviation. Points are (north,
// east) of W. Everything is reprojected to the local plane; where on the globe comes from the file.
//
// Datum: a depth means nothing without its datum. A prior whose datum is unknown, or not that of the map, is refused
// unless the offset to the map's water surface is given. Sign: `automatic` takes the format's own convention (BAG and
// heights up, S-57 and depths down) and refuses where there is none or the numbers contradict it.
//
// Resampling: where cells are finer than pixels, a pixel takes the mean of the cells within it, and their spread joins
// its sigma, or the shoalest. Where cells are coarser, depth is bilinear between cell centres (or the shoalest of the
// four), sigma is bilinear in variance; beside a hole the cell that holds the pixel's centre speaks alone. Rotated
// rasters are followed, not refused. Soundings become a surface with continuous slope (geometry/smooth_surface.hpp).
// On charts soundings, contours and coast make that surface, kept within the limits of its depth areas; where it says
// nothing the shoal end of the area stands. Land is depth 0.
//
// Bad input: what is damaged as a whole, contradicts itself, or does not reach the window is refused with one line
// (Error). Single cells, soundings and objects that are bad are left out and counted by reason. Memory is bounded by
// the window, not by the raster: it is read in tiles. Nothing is printed. Threads: as many calls as wanted. HDF5 files
// (BAG, netCDF-4) go through a library that is not proof against every forgery: convert untrusted ones elsewhere.
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/prior_data.hpp>
#include <optional>

namespace isobath {

/// The middle of what a file covers, where it says so: text does not. Throws Error where it cannot be opened.
std::optional<GeoPoint> centre_of_prior(const std::filesystem::path& file, const PriorConfig& config);

/// Throws Error.
Prior read_prior(const std::filesystem::path& file, const PriorConfig& config, const LocalPlane& plane,
                 const PriorWindow& wanted);

}  // namespace isobath
