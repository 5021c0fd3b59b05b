#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <isobath/display/display_bytes.hpp>
#include <isobath/display/map_display.hpp>
#include <span>
#include <utility>

namespace isobath {
namespace {

constexpr double kProbabilityUnit = 250;
constexpr std::uint8_t kUnknownCell = 255;
constexpr std::uint16_t kUnknownUnits = 65535;
constexpr double kFine_m = 0.01, kCoarse_m = 0.2;  ///< units of depth: the fine one down to 655 m, else the coarse one
constexpr int kOverviewTile = 64;
constexpr std::size_t kFewestBlocks = 16, kLooks = 8;  ///< minimum blocks per call; calls until all changes are shown
constexpr int kVoxelRun = 64;
constexpr std::uint64_t kOverviewRow = 0x4000'0000;  ///< keeps the rows of the overview apart from those of the window

std::uint64_t pair_of(std::int64_t row, std::int64_t column) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(row)) << 32 | static_cast<std::uint32_t>(column);
}

/// The shades of all cells, looked up in a table by log-odds. This takes a tenth of the time of one exponential per
/// cell; a shade is off by at most one, where the exact value lies close to the border of two shades.
std::vector<std::uint8_t> cell_shades(const BodyGrid& grid) {
  constexpr int kSteps = 4096;
  const double least = grid.log_odds_min(), step = (grid.log_odds_max() - least) / kSteps;
  std::array<std::uint8_t, kSteps + 1> table;
  for (int i = 0; i <= kSteps; ++i) {
    table[static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(std::lround(kProbabilityUnit * probability_of(least + i * step)));
  }
  const double unknown_below = log_odds_of(grid.config().threshold / 9), steps_a_unit = 1 / step;
  const double first = least - step / 2;  // lower bound of the values that round to the table's first entry
  std::vector<std::uint8_t> shades(grid.cells().size());
  for (std::size_t i = 0; i < shades.size(); ++i) {
    const double log_odds = grid.log_odds()[i];
    const bool unknown = !grid.is_free(i) && log_odds < unknown_below;
    shades[i] = unknown ? kUnknownCell : table[static_cast<std::size_t>((log_odds - first) * steps_a_unit)];
  }
  return shades;
}

/// Encodes a square of pixels as a tile of the page. Input rows come from the north, output rows from the south.
std::string page_tile_of(std::span<const DepthPixel> pixels, int side, double pixel_m,
                         const Eigen::Vector2d& south_west) {
  double deepest = 0;
  for (const DepthPixel& p : pixels) deepest = p.known() ? std::max(deepest, p.depth_m()) : deepest;
  const double unit = deepest < kUnknownUnits * kFine_m ? kFine_m : kCoarse_m;
  DisplayBytes bytes;
  bytes.add(static_cast<std::uint16_t>(side)).add(std::uint16_t{0}).add(static_cast<float>(pixel_m));
  bytes.add(south_west.x()).add(south_west.y());
  bytes.add(static_cast<float>(unit)).add(std::uint32_t{0});
  // one plane after another, because equal bytes in sequence pack well
  const std::size_t count = pixels.size();
  std::vector<std::uint8_t> planes(4 * count);
  std::size_t to = 0;
  for (int row = side - 1; row >= 0; --row) {
    for (int column = 0; column < side; ++column, ++to) {
      const DepthPixel& p =
          pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(side) + static_cast<std::size_t>(column)];
      const double units = p.known() ? std::clamp(std::round(p.depth_m() / unit), 0.0, kUnknownUnits - 1.0) : 0;
      const std::uint16_t depth = p.known() ? static_cast<std::uint16_t>(units) : kUnknownUnits;
      const unsigned charted = p.known() && !p.has(kSensed) ? 1 : 0;
      const unsigned measured = p.has(kSensed) || p.has(kSeenByDepth) ? 2 : 0;
      planes[to] = static_cast<std::uint8_t>(depth & 0xff);
      planes[count + to] = static_cast<std::uint8_t>(depth >> 8);
      planes[2 * count + to] = static_cast<std::uint8_t>(p.confidence());
      planes[3 * count + to] = static_cast<std::uint8_t>(charted | measured | (p.has(kSeenByObstacle) ? 4U : 0U));
    }
  }
  bytes.append_packed(planes);
  return bytes.take();
}

/// Whether at least one sensor holds any of the kVoxelRun voxels for more likely occupied than not.
bool any_speaks_for(const std::vector<const LogOdds16*>& evidence, int run) {
  LogOdds16 most = kUnseen;
  for (const LogOdds16* block : evidence) {
    for (int i = run; i < run + kVoxelRun; ++i) most = std::max(most, block[i]);
  }
  return most > 0;
}

using Shades = std::array<std::uint8_t, VoxelBlocks::kVolume>;

std::string voxel_bytes(double voxel_m, const VoxelIndex& corner, std::uint32_t count, const Shades& shades) {
  DisplayBytes bytes;
  bytes.add(static_cast<float>(voxel_m)).add(corner.x()).add(corner.y()).add(corner.z()).add(count);
  return bytes.append_packed(shades).take();
}

VoxelIndex cube_of(const VoxelIndex& voxel) {
  constexpr int kLog2 = std::countr_zero(static_cast<unsigned>(MapDisplay::kCube));
  return {voxel.x() >> kLog2, voxel.y() >> kLog2, voxel.z() >> kLog2};
}

std::uint64_t region_of(const VoxelIndex& voxel) { return VoxelBlocks::key_of(cube_of(voxel)); }

/// The bounding window of all pixels with a charted depth; its width is 0 if there are none.
PixelWindow known_of(const DepthTrees& trees) {
  int west = 0, north = 0, east = 0, south = 0;
  bool any = false;
  trees.prior().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow& leaf) {
    if (word == DepthPixel::kUnknownDepth) return;
    west = any ? std::min(west, leaf.column) : leaf.column;
    north = any ? std::min(north, leaf.row) : leaf.row;
    east = any ? std::max(east, leaf.column + leaf.width) : leaf.column + leaf.width;
    south = any ? std::max(south, leaf.row + leaf.height) : leaf.row + leaf.height;
    any = true;
  });
  return {west, north, east - west, south - north};
}

}  // namespace

void MapDisplay::show(Time time, const BodyGrid& grid, const Pose& X_WB) {
  if (!show_again(grid_shown_, time, kGridInterval)) return;
  grid_shown_ = time;
  const CartesianGrid& cells = grid.cells();
  // W from L, L from G: position and orientation of the grid's corner
  const Pose X_WL = level(X_WB);
  const Eigen::Vector2d corner_L = grid.to_level_body(Eigen::Vector2d::Zero());
  const Eigen::Vector2d ahead_L = grid.to_level_body(Eigen::Vector2d::UnitX()) - corner_L;
  const auto in_W = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return (X_WL * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>();
  };
  const Eigen::Vector2d corner = in_W(corner_L), ahead = in_W(corner_L + ahead_L) - corner;
  const std::vector<std::uint8_t> shades = cell_shades(grid);
  DisplayBytes bytes;
  bytes.add(static_cast<std::uint16_t>(cells.cells_x)).add(static_cast<std::uint16_t>(cells.cells_y));
  bytes.add(static_cast<float>(cells.cell_m)).add(corner.x()).add(corner.y());
  bytes.add_floats({std::atan2(ahead.y(), ahead.x()), grid.config().threshold});
  items_.set(DisplayKind::kGrid, 0, time, bytes.append_packed(shades).take());
}

void MapDisplay::show(Time time, std::shared_ptr<const DepthSnapshot> depths) {
  depths_shown_ = time;
  if (!overview_shown_) show_overview(time, *depths);
  overview_shown_ = true;
  const DepthWindow& window = depths->window();
  const Pixel first = window.first_tile();
  for (int row = first.row; row < first.row + window.tiles(); ++row) {
    for (int column = first.column; column < first.column + window.tiles(); ++column) {
      const Pixel at{column, row};
      const TilePtr& tile = window.tile(at);
      if (!tile || (depths_ && depths_->window().holds_tile(at) && depths_->window().tile(at) == tile)) continue;
      const auto spoken = [](const DepthPixel& p) { return p.flags() != 0; };
      if (std::any_of(tile->pixels.begin(), tile->pixels.end(), spoken)) show_tile(time, at, depths->grid(), *tile);
    }
  }
  depths_ = std::move(depths);
}

void MapDisplay::show_tile(Time time, Pixel tile, const PixelGrid& grid, const DepthTile& pixels) {
  const double side_m = DepthTile::kSide * grid.pixel_m;
  const Eigen::Vector2d south_west(grid.corner_m.x() - (tile.row + 1) * side_m,
                                   grid.corner_m.y() + tile.column * side_m);
  items_.set(DisplayKind::kDepth, pair_of(tile.row, tile.column), time,
             page_tile_of(pixels.pixels, DepthTile::kSide, grid.pixel_m, south_west));
}

void MapDisplay::show_overview(Time time, const DepthSnapshot& depths) {
  const PixelWindow known = known_of(depths.trees());
  if (known.width == 0) return;
  int each = 1;
  while (std::max(known.width, known.height) > kOverview * each) each *= 2;
  const PixelGrid grid = depths.grid();
  const int span = kOverviewTile * each;
  std::vector<DepthPixel> pixels(kOverviewTile * kOverviewTile);
  for (int row = 0; row * span < known.height; ++row) {
    for (int column = 0; column * span < known.width; ++column) {
      bool any = false;
      for (std::size_t i = 0; i < pixels.size(); ++i) {
        const int x = known.column + column * span + static_cast<int>(i % kOverviewTile) * each + each / 2;
        const int y = known.row + row * span + static_cast<int>(i / kOverviewTile) * each + each / 2;
        pixels[i] = depths.trees().at({x, y});
        any = any || pixels[i].known();
      }
      if (!any) continue;
      const Eigen::Vector2d south_west(grid.corner_m.x() - (known.row + (row + 1) * span) * grid.pixel_m,
                                       grid.corner_m.y() + (known.column + column * span) * grid.pixel_m);
      items_.set(DisplayKind::kDepth, pair_of(static_cast<std::int64_t>(kOverviewRow) + row, column), time,
                 page_tile_of(pixels, kOverviewTile, each * grid.pixel_m, south_west));
    }
  }
}

void MapDisplay::voxels_moved(Time time) {
  for (const auto& [block, count] : blocks_) items_.remove(DisplayKind::kVoxels, block, time);
  for (const auto& [region, cubes] : regions_) items_.remove(DisplayKind::kCubes, region, time);
  blocks_.clear();
  regions_.clear();
  changed_.clear();
  voxel_revision_ = 0;
  voxels_shown_.reset();
}

void MapDisplay::show(Time time, const VoxelMap& voxels) {
  if (changed_.empty()) {
    if (!show_again(voxels_shown_, time, kVoxelInterval)) return;
    voxels_shown_ = time;
    changed_ = voxels.changed_after(voxel_revision_);
    voxel_revision_ = voxels.revision();
    a_look_ = std::max(kFewestBlocks, changed_.size() / kLooks + 1);
    std::sort(changed_.begin(), changed_.end(), [](const VoxelIndex& a, const VoxelIndex& b) {
      return std::pair(region_of(a), VoxelBlocks::key_of(a)) < std::pair(region_of(b), VoxelBlocks::key_of(b));
    });
  }
  for (std::size_t i = 0; i < a_look_ && !changed_.empty(); ++i, changed_.pop_back()) {
    show_block(time, voxels, changed_.back());
  }
  for (const std::uint64_t region : told_anew_) show_cubes(time, kCube * voxels.voxel_m(), region);
  told_anew_.clear();
}

void MapDisplay::show_block(Time time, const VoxelMap& voxels, const VoxelIndex& corner) {
  std::vector<const LogOdds16*> evidence;
  for (const std::string& sensor : voxels.sensors()) {
    if (const LogOdds16* block = voxels.find_layer(sensor)->find(corner)) evidence.push_back(block);
  }
  Shades shades{};
  constexpr int kCubes = VoxelBlocks::kSide / kCube;  // along an edge of the block
  std::array<std::uint8_t, kCubes * kCubes * kCubes> cubes{};
  std::uint32_t count = 0;
  for (int run = 0; run < VoxelBlocks::kVolume; run += kVoxelRun) {
    if (!any_speaks_for(evidence, run)) continue;  // true for most of the water
    for (int i = run; i < run + kVoxelRun; ++i) {
      const auto speaks_for = [i](const LogOdds16* block) { return block[i] > 0; };
      if (std::none_of(evidence.begin(), evidence.end(), speaks_for)) continue;
      const VoxelIndex place = VoxelBlocks::place_of(i);
      const double p = voxels.probability(corner + place);
      if (p < 0.5) continue;
      const auto shade = static_cast<std::uint8_t>(std::lround(kProbabilityUnit * p));
      shades[static_cast<std::size_t>(i)] = shade;
      const int cube = (place.x() / kCube * kCubes + place.y() / kCube) * kCubes + place.z() / kCube;
      std::uint8_t& most = cubes[static_cast<std::size_t>(cube)];
      most = std::max(most, shade);
      ++count;
    }
  }
  const std::uint64_t number = VoxelBlocks::key_of(corner);
  const auto known = blocks_.find(number);
  const std::uint32_t before = known == blocks_.end() ? 0 : known->second;
  if (count == 0 && before == 0) return;
  if (count == 0) {
    blocks_.erase(known);
    items_.remove(DisplayKind::kVoxels, number, time);
  } else {
    blocks_[number] = count;
    items_.set(DisplayKind::kVoxels, number, time, voxel_bytes(voxels.voxel_m(), corner, count, shades));
  }

  Region& region = regions_[region_of(corner)];
  region.voxels += count - before;
  for (int i = 0; i < kCubes * kCubes * kCubes; ++i) {
    const VoxelIndex at = cube_of(corner) + VoxelIndex(i / (kCubes * kCubes), i / kCubes % kCubes, i % kCubes);
    region.cubes[static_cast<std::size_t>(VoxelBlocks::offset(at))] = cubes[static_cast<std::size_t>(i)];
  }
  told_anew_.insert(region_of(corner));
}

void MapDisplay::show_cubes(Time time, double cube_m, std::uint64_t region) {
  const Region& cubes = regions_.at(region);
  if (cubes.voxels == 0) {
    regions_.erase(region);
    items_.remove(DisplayKind::kCubes, region, time);
    return;
  }
  items_.set(DisplayKind::kCubes, region, time,
             voxel_bytes(cube_m, VoxelBlocks::corner_of(region), cubes.voxels, cubes.cubes));
}

void MapDisplay::show(Time time, const GridSnapshot& sphere) {
  if (!show_again(sphere_shown_, time, kSphereInterval)) return;
  sphere_shown_ = time;
  const SphericalGrid& grid = sphere.grid;
  struct Cell {
    std::uint16_t layer, azimuth, elevation, state;
  };
  constexpr int kLocked = 0x8000;
  std::vector<Cell> cells;
  grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      if (!grid.is_obstacle(cell)) continue;
      cells.push_back({static_cast<std::uint16_t>(cell.layer), static_cast<std::uint16_t>(d.azimuth),
                       static_cast<std::uint16_t>(d.elevation),
                       static_cast<std::uint16_t>(std::lround(kProbabilityUnit * SphericalGrid::probability(cell)) |
                                                  (cell.locked ? kLocked : 0))});
    }
  });
  std::stable_sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.layer < b.layer; });
  const std::size_t all = cells.size();
  cells.resize(std::min(all, kSphereCells));
  const DirectionBuckets& buckets = grid.buckets();
  const Eigen::Vector3d& at = sphere.X_WB.translation;
  DisplayBytes bytes;
  bytes.add(at.x()).add(at.y()).add_floats({at.z()});
  bytes.add_floats({(buckets.azimuth_edge(0) + grid.remainder() - grid.turned()).radians(),
                    buckets.elevation_edge(0).radians(), buckets.step().radians()});
  bytes.add(static_cast<std::uint32_t>(grid.layers().count()));
  bytes.add(static_cast<std::uint32_t>(cells.size())).add(static_cast<std::uint32_t>(all));
  for (int i = 0; i < grid.layers().count(); ++i) bytes.add(static_cast<float>(grid.layers().outer(i)));
  for (const Cell& cell : cells) {
    bytes.add(cell.layer).add(cell.azimuth).add(cell.elevation).add(cell.state);
  }
  items_.set(DisplayKind::kSphere, 0, time, bytes.take());
}

}  // namespace isobath
