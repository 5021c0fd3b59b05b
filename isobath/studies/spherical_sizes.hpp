// SphericalSizes: how many cells a spherical grid, a grid of uniform layers and a cubic grid of the same resolution
// need (Auran, Silven 1995, 4.2; ledger S4-04, S4-06, S4-E07, S4-D03).
#pragma once

#include <cstdint>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <string>

namespace isobath {

struct SphericalSizes {
  double range_m = 0;
  int layers = 0, uniform_layers = 0;  ///< layers of the finest thickness throughout
  std::uint64_t cells = 0;             ///< of the whole spherical grid
  std::uint64_t uniform_cells = 0;     ///< with layers of the finest thickness
  std::uint64_t cubic_cells = 0;       ///< cubes of the finest thickness, over +- range
  std::uint64_t slice_cells = 0;       ///< of one ring of directions
  std::uint64_t square_cells = 0;      ///< squares of the finest thickness, over +- range
};

/// Counts the cells of a grid with the layers and directions of `config`, up to `range_m`. Throws Error where
/// SphericalLayers does.
SphericalSizes spherical_sizes(const SphericalGridConfig& config, double range_m);

/// PNG: one slice to `range_m`, in spherical cells ahead and in squares behind.
std::string spherical_slice_picture(const SphericalGridConfig& config, double range_m);

}  // namespace isobath
