// voxel_pages: what a run writes of its voxel map: pictures from above and from the side, an OctoMap tree, points, and
// the part of the report that shows them.
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/chart_layout.hpp>
#include <isobath/world/voxel_model.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// PNG files; empty if nothing was observed.
struct VoxelPictures {
  std::string above, from_south, from_east, at_depth;
};

/// Writes voxels.bt, voxels.ply, voxels.vdb (with `vdb`), voxels.png, voxels-south.png, voxels-east.png and
/// voxels-depth.png into `folder`, and appends their names to `files`. Blocks outside the range of the tree are counted
/// in `outcome`. Pictures name the `source`, and show latitude and longitude with an origin. Throws Error if a file
/// cannot be written.
VoxelPictures write_voxel_files(const VoxelMap& map, bool vdb, ChartSource source,
                                const std::optional<GeoOrigin>& origin, const std::filesystem::path& folder,
                                VoxelOutcome& outcome, std::vector<std::filesystem::path>& files);
void add_voxels(HtmlReport& page, const VoxelOutcome& outcome, const VoxelPictures& pictures);

}  // namespace isobath
