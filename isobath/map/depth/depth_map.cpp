#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/depth_map.hpp>

namespace isobath {
namespace {

constexpr int kMaxLevels = 20;  // 2^20 pixels a side: 524 km of 0.5 m

/// Calls take(pixel, index) for the pixels of `wanted` that lie within `held`; index counts row by row in `wanted`.
template <class Take>
void for_overlap(const PixelWindow& wanted, const PixelWindow& held, Take take) {
  const int left = std::max(wanted.column, held.column), top = std::max(wanted.row, held.row);
  const int right = std::min(wanted.column + wanted.width, held.column + held.width);
  const int bottom = std::min(wanted.row + wanted.height, held.row + held.height);
  for (int row = top; row < bottom; ++row) {
    for (int column = left; column < right; ++column) {
      const std::size_t slot = static_cast<std::size_t>(row - wanted.row) * wanted.width + (column - wanted.column);
      take(Pixel{column, row}, slot);
    }
  }
}

}  // namespace

std::vector<Field> fields(DepthMapConfig& c) {
  return {Field::real("pixel_m", &c.pixel_m, {0.01, 100}, "m", "Side of a pixel of the depth map."),
          Field::integer("window_pixels", &c.window_pixels, {64, 4096}, "1",
                         "Side of the local window in pixels; a power of two."),
          Field::real("area_m", &c.area_m, {64, 500000}, "m",
                      "Minimum side of the operational area around the origin; an existing map keeps the side that it "
                      "was made with.")};
}

DepthArea area_of(const DepthMapConfig& config) {
  if (!std::has_single_bit(static_cast<unsigned>(config.window_pixels))) {
    throw Error(fmt::format("window_pixels is {}", config.window_pixels), {}, "a power of two, 64 .. 4096");
  }
  DepthArea area;
  const double pixels = config.area_m / config.pixel_m;
  area.levels = std::max(5, static_cast<int>(std::ceil(std::log2(pixels))));
  if (area.levels > kMaxLevels) {
    throw Error(fmt::format("an area of {} m has more than 2^{} pixels of {} m a side", config.area_m, kMaxLevels,
                            config.pixel_m),
                {}, {}, "take a smaller area or larger pixels");
  }
  const double half = 0.5 * std::ldexp(config.pixel_m, area.levels);
  area.grid = {{half, -half}, config.pixel_m};
  return area;
}

// Snapshots ----------------------------------------------------------------------------------------------------------

DepthPixel DepthSnapshot::at(Pixel p) const { return window_.contains(p) ? window_.at(p) : trees_->at(p); }

void DepthSnapshot::read(PixelWindow window, std::span<DepthPixel> out) const {
  trees_->read(window, out);
  for_overlap(window, window_.extent(), [&](Pixel p, std::size_t slot) { out[slot] = window_.at(p); });
}

void DepthSnapshot::read_blocks(const PixelWindow& blocks, std::span<DepthBlock> out) const {
  ISOBATH_ASSERT(out.size() == static_cast<std::size_t>(blocks.width) * blocks.height);
  std::fill(out.begin(), out.end(), DepthBlock{});
  constexpr int kA = DepthTile::kBlocks;
  DepthTile from_trees;
  for (int row = blocks.row >> 2; row << 2 < blocks.row + blocks.height; ++row) {
    for (int column = blocks.column >> 2; column << 2 < blocks.column + blocks.width; ++column) {
      const Pixel tile{column, row};
      const DepthTile* source = &from_trees;
      if (window_.holds_tile(tile)) {
        source = &*window_.tile(tile);
      } else {
        trees_->read_tile(tile, from_trees);
      }
      for_overlap(blocks, {column * kA, row * kA, kA, kA}, [&](Pixel block, std::size_t slot) {
        const std::size_t row_of_tile = static_cast<std::uint32_t>(block.row) & 3U;
        out[slot] = source->blocks[row_of_tile * kA + (static_cast<std::uint32_t>(block.column) & 3U)];
      });
    }
  }
}

bool DepthSnapshot::may_be_shallower(const PixelWindow& window, double depth_m) const {
  constexpr int kB = DepthBlock::kPixels;
  const auto block_of = [](std::int32_t pixel) { return pixel >= 0 ? pixel / kB : -((kB - 1 - pixel) / kB); };
  const PixelWindow blocks{block_of(window.column), block_of(window.row),
                           block_of(window.column + window.width - 1) - block_of(window.column) + 1,
                           block_of(window.row + window.height - 1) - block_of(window.row) + 1};
  std::vector<DepthBlock> found(static_cast<std::size_t>(blocks.width) * static_cast<std::size_t>(blocks.height));
  read_blocks(blocks, found);
  return std::any_of(found.begin(), found.end(), [&](const DepthBlock& b) { return 0.01 * b.min_cm < depth_m; });
}

// The map ------------------------------------------------------------------------------------------------------------

DepthMap::DepthMap(const DepthMapConfig& config, const DepthArea& area, DepthTrees trees, const Eigen::Vector2d& start)
    : pool_(std::make_shared<TilePool>()),
      area_(area),
      trees_(std::move(trees)),
      published_(std::make_shared<const DepthTrees>(trees_)),
      window_(config.window_pixels / DepthTile::kSide) {
  ISOBATH_ASSERT(trees_.levels() == area_.levels);
  // The window, the one that is made beside it, and the tiles that are cloned while both exist.
  pool_->reserve(static_cast<std::size_t>(window_.tiles()) * window_.tiles() * 4);
  const auto shift = begin_shift(centred(start));
  shift->run();
  finish_shift(*shift);
}

DepthMap::~DepthMap() = default;

Pixel DepthMap::centred(const Eigen::Vector2d& north_east) const {
  const Pixel tile = DepthWindow::tile_of(area_.grid.at(north_east));
  const int half = window_.tiles() / 2;
  const auto nearest_border = [](double p) { return static_cast<int>(std::lround(p)); };
  const double side = area_.grid.pixel_m * DepthTile::kSide;
  const double east = (north_east.y() - area_.grid.corner_m.y()) / side - tile.column;
  const double south = (area_.grid.corner_m.x() - north_east.x()) / side - tile.row;
  return {tile.column + nearest_border(east) - half, tile.row + nearest_border(south) - half};
}

std::optional<Pixel> DepthMap::wanted(const Eigen::Vector2d& north_east, const Shift* under_way) const {
  const Pixel p = area_.grid.at(north_east);
  const PixelWindow all = under_way != nullptr ? under_way->extent() : window_.extent();
  const int margin = window_.pixels() / 4;
  const bool inside =
      PixelWindow{all.column + margin, all.row + margin, all.width - 2 * margin, all.height - 2 * margin}.contains(p);
  if (inside) return std::nullopt;
  return centred(north_east);
}

DepthMap::Shift::Shift(DepthMap& map, Pixel target) : map_(map), frozen_(map.window_), next_(map.window_) {
  next_.move_to(target);
  extent_ = next_.extent();
}

void DepthMap::Shift::run() {
  const int side = next_.tiles();
  const bool first = !frozen_.tile(frozen_.first_tile());
  for (int i = 0; i < side * side && !first; ++i) {
    const Pixel tile{frozen_.first_tile().column + i % side, frozen_.first_tile().row + i / side};
    if (!next_.holds_tile(tile)) pixels_lost_ += map_.trees_.write_tile(tile, *frozen_.tile(tile));
  }
  for (int i = 0; i < side * side; ++i) {
    TilePtr& tile = next_.tile({next_.first_tile().column + i % side, next_.first_tile().row + i / side});
    if (tile) continue;
    tile = map_.pool_->take();
    map_.trees_.read_tile({next_.first_tile().column + i % side, next_.first_tile().row + i / side}, tile.own());
  }
  published_ = std::make_shared<const DepthTrees>(map_.trees_);
}

std::unique_ptr<DepthMap::Shift> DepthMap::begin_shift(Pixel first_tile) {
  ISOBATH_ASSERT(!shifting_);
  shifting_ = true;
  return std::unique_ptr<Shift>(new Shift(*this, first_tile));
}

void DepthMap::finish_shift(Shift& shift) {
  ISOBATH_ASSERT(shifting_ && shift.published_);
  window_ = std::move(shift.next_);
  published_ = std::move(shift.published_);
  pixels_lost_ += static_cast<std::uint64_t>(shift.pixels_lost_);
  shifting_ = false;
}

void DepthMap::write(std::span<const std::pair<Pixel, DepthPixel>> pixels) {
  ISOBATH_ASSERT(!shifting_);
  DepthTile tile;
  for (std::size_t i = 0; i < pixels.size();) {
    const Pixel at = DepthWindow::tile_of(pixels[i].first);
    const bool here = window_.holds_tile(at);
    if (!here) trees_.read_tile(at, tile);
    DepthTile& into = here ? window_.tile(at).own() : tile;
    for (; i < pixels.size() && DepthWindow::tile_of(pixels[i].first) == at; ++i) {
      DepthWindow::set(into, DepthWindow::index_in_tile(pixels[i].first), pixels[i].second);
    }
    if (!here) pixels_lost_ += static_cast<std::uint64_t>(trees_.write_tile(at, tile));
  }
}

void DepthMap::flush() {
  ISOBATH_ASSERT(!shifting_);
  const int side = window_.tiles();
  for (int i = 0; i < side * side; ++i) {
    const Pixel at{window_.first_tile().column + i % side, window_.first_tile().row + i / side};
    TilePtr& tile = window_.tile(at);
    if (std::all_of(tile->changed.begin(), tile->changed.end(), [](std::uint32_t row) { return row == 0; })) continue;
    pixels_lost_ += static_cast<std::uint64_t>(trees_.write_tile(at, *tile));
    tile.own().changed.fill(0);
  }
  published_ = std::make_shared<const DepthTrees>(trees_);
}

std::shared_ptr<const DepthSnapshot> DepthMap::snapshot() const {
  auto snapshot = std::make_shared<DepthSnapshot>();
  snapshot->pool_ = pool_;
  snapshot->trees_ = published_;
  snapshot->window_ = window_;
  snapshot->grid_ = area_.grid;
  snapshot->version_ = ++version_;
  return snapshot;
}

}  // namespace isobath
