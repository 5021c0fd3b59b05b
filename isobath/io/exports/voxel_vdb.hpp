// Voxel maps for OpenVDB readers (Blender, Houdini, Paraview): one grid of floats in a .vdb file.
//
// Grid `log_odds`: ln P / (1 - P) of all layers together, active where any sensor has observed, the prior elsewhere. z
// is up as in the other exports: x east, y north, metres about the origin of W; index (i, j, k) is the voxel with its
// centre at (i + 1/2, j + 1/2, k + 1/2) edges. Metadata state the prior, the two thresholds, the sensors and the axes.
// The same map gives the same bytes.
//
// Needs a library that was built with OpenVDB (ISOBATH_OPENVDB) and the module isobath_vdb.so, which the first call
// loads (vdb/vdb_module.hpp). Otherwise has_openvdb() is false and writing throws.
// Cost: 0.2 us per observed voxel. One thread at a time.
#pragma once

#include <filesystem>
#include <isobath/map/voxel/voxel_map.hpp>

namespace isobath {

[[nodiscard]] bool has_openvdb();
inline constexpr const char* kVdbRemedy =
    "install libopenvdb-dev and build again; isobath_vdb.so belongs in ../lib/isobath of the program";
/// Throws Error if the file cannot be written or the library has no OpenVDB.
void write_vdb(const VoxelMap& map, const std::filesystem::path& file);

}  // namespace isobath
