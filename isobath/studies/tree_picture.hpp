// tree_picture: a quadtree of a depth map as squares, one a leaf (Oskard, Hong, Shaffer 1990, III-A; ledger S1-11,
// S1-12, S1-D06, S1-D07). A large leaf is light, a single pixel dark; the outline is drawn where a leaf is large enough
// on the picture. What the tree says is known is blue, what it does not know is grey.
#pragma once

#include <isobath/map/depth/pixel_grid.hpp>
#include <isobath/map/depth/region_quadtree.hpp>
#include <string>

namespace isobath {

/// PNG. `unknown`: the value of a leaf without a depth.
std::string tree_picture(const RegionQuadtree& tree, const PixelGrid& grid, std::uint32_t unknown,
                         const std::string& title);

}  // namespace isobath
