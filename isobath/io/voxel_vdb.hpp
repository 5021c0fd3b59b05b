// Voxel maps for OpenVDB's readers (Blender, Houdini, Paraview): one grid of floats in a .vdb file.
//
// Grid `log_odds`: ln P / (1 - P) of all layers together, active where any sensor has said anything, the prior
// elsewhere. z is up as in the other exports: x east, y north, metres about the origin of W; index (i, j, k) is the
// voxel with its centre at (i + 1/2, j + 1/2, k + 1/2) edges. Metadata say the prior, the two thresholds, the sensors
// and the axes. The same map gives the same bytes.
//
// Only where the library was built with OpenVDB (ISOBATH_OPENVDB) and isobath_vdb.so is found, which is loaded by the
// first who asks (vdb/vdb_module.hpp): else has_openvdb() is false and writing throws.
// Cost: 0.2 us a voxel seen. One thread.
#pragma once

#include <filesystem>
#include <isobath/map/voxel_map.hpp>

namespace isobath {

[[nodiscard]] bool has_openvdb();
inline constexpr const char* kVdbRemedy =
    "install libopenvdb-dev and build again; isobath_vdb.so stands in ../lib/isobath of the program";
/// Throws Error where the file cannot be written, and where the library has no OpenVDB.
void write_vdb(const VoxelMap& map, const std::filesystem::path& file);

}  // namespace isobath
