// What a run writes of its three-dimensional map: pictures from above and from the side, an OctoMap tree, points, and
// the part of the report that shows them.
#pragma once

#include <filesystem>
#include <isobath/runtime/html_report.hpp>
#include <isobath/runtime/voxel_model.hpp>
#include <string>
#include <vector>

namespace isobath {

/// PNG; empty where nothing was seen.
struct VoxelPictures {
  std::string above, from_south, from_east, at_depth;
};

/// Writes voxels.bt, voxels.ply, voxels.vdb where it is wanted, voxels.png, voxels-south.png, voxels-east.png and
/// voxels-depth.png into `folder`; their names are appended to `files`, and what has no place in the tree is counted in
/// `outcome`. Throws Error where they cannot be written.
VoxelPictures write_voxel_files(const VoxelMap& map, bool vdb, const std::filesystem::path& folder,
                                VoxelOutcome& outcome, std::vector<std::filesystem::path>& files);
void add_voxels(HtmlReport& page, const VoxelOutcome& outcome, const VoxelPictures& pictures);

}  // namespace isobath
