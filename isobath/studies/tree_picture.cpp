#include <cmath>
#include <fmt/format.h>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/tree_picture.hpp>
#include <vector>

namespace isobath {
namespace {

constexpr int kTreePixels = 560;
constexpr double kOutlined_px = 5;  // smaller leaves have no outline
constexpr Colour kEdge{0.13, 0.14, 0.16, 0.8};

/// Light for a large leaf, dark for a single pixel.
Colour leaf_colour(int side, int levels, bool known) {
  const double share = std::log2(static_cast<double>(side)) / std::max(1, levels);
  const double light = 0.35 + 0.6 * std::min(1.0, 2 * share);
  return known ? Colour{0.45 * light, 0.72 * light, light, 1} : Colour{0.9 * light, 0.9 * light, 0.88 * light, 1};
}

}  // namespace

std::string tree_picture(const RegionQuadtree& tree, const PixelGrid& grid, std::uint32_t unknown,
                         const std::string& title) {
  const auto box_of = [&](const PixelWindow& w) {
    const double half = 0.5 * grid.pixel_m;
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p :
         {grid.centre({w.column, w.row}), grid.centre({w.column + w.width - 1, w.row + w.height - 1})}) {
      box.extend(Eigen::Vector2d(p.array() - half)).extend(Eigen::Vector2d(p.array() + half));
    }
    return box;
  };
  const Eigen::AlignedBox2d box = box_of(tree.square());
  const RegionQuadtree::Statistics s = tree.statistics();
  PlanPicture picture(frame_around(box), kTreePixels,
                      {fmt::format("{}: {} leaves, {} words", title, s.leaves, s.words), "north (m)", "east (m)"});
  picture.raster([&](double north, double east) {
    if (!box.contains(Eigen::Vector2d(north, east))) return palette::kPaper;
    const RegionQuadtree::Leaf leaf = tree.leaf_at(grid.at({north, east}));
    return leaf_colour(leaf.window.width, tree.levels(), leaf.value != unknown);
  });
  const double px_a_pixel = kTreePixels / static_cast<double>(tree.side());
  const int outlined = std::max(1, static_cast<int>(std::ceil(kOutlined_px / px_a_pixel)));
  tree.for_each_leaf(tree.square(), [&](std::uint32_t, const PixelWindow& w) {
    if (w.width < outlined) return;
    const Eigen::AlignedBox2d square = box_of(w);
    const Eigen::Vector2d& low = square.min();
    const Eigen::Vector2d& high = square.max();
    picture.polyline(std::vector<Eigen::Vector2d>{low, {high.x(), low.y()}, high, {low.x(), high.y()}, low},
                     {kEdge, 0.7, false});
  });
  picture.finish({{leaf_colour(1, tree.levels(), true), "known, single pixels"},
                  {leaf_colour(tree.side(), tree.levels(), true), "known, large leaves"},
                  {leaf_colour(tree.side(), tree.levels(), false), "not known"}});
  return picture.png();
}

}  // namespace isobath
