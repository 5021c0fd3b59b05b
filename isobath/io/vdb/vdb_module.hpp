// What isobath_vdb.so takes: the module that links OpenVDB, so that only who writes a .vdb file loads it. OpenVDB has
// fifty thousand places to be filled in when it is loaded.
//
// Plain data on both sides; the module knows nothing else of Isobath. It is found where the loader looks for libraries
// on behalf of the program (its RUNPATH, LD_LIBRARY_PATH, the system's folders); `isobath` looks in ../lib/isobath.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace isobath {

struct VdbGrid {
  std::string name;
  double edge_m = 0;  ///< index (i, j, k) is the voxel with its centre at (i + 1/2, j + 1/2, k + 1/2) edges
  float background = 0;
  std::span<const std::pair<std::string, std::string>> words;  ///< metadata
  std::span<const std::pair<std::string, double>> numbers;
  std::span<const std::array<std::int32_t, 3>> places;
  std::span<const float> values;  ///< of each place
};

/// The module's one function, isobath_write_vdb. False where the file cannot be written, and why.
using WriteVdb = bool(const VdbGrid& grid, const std::string& file, std::string& why);

}  // namespace isobath
