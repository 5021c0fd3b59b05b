// The interface of isobath_vdb.so, the module that links OpenVDB, so that only programs that write a .vdb file load it:
// OpenVDB has fifty thousand relocations to process when it is loaded.
//
// Both sides exchange plain data; the module uses nothing else of Isobath. The loader searches for it in the library
// paths of the program (its RUNPATH, LD_LIBRARY_PATH, the system's folders); `isobath` searches in ../lib/isobath.
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
  std::span<const float> values;  ///< the value at each of `places`
};

/// The module's only function, isobath_write_vdb. False if the file cannot be written; `why` then holds the reason.
using WriteVdb = bool(const VdbGrid& grid, const std::string& file, std::string& why);

}  // namespace isobath
