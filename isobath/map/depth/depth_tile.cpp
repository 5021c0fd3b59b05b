#include <bit>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/depth_tile.hpp>
#include <mutex>

namespace isobath {

// Tiles --------------------------------------------------------------------------------------------------------------

void DepthTile::survey(int block) {
  const int first = block / kBlocks * DepthBlock::kPixels * kSide + block % kBlocks * DepthBlock::kPixels;
  DepthBlock found;
  found.unknown = 0;
  for (int row = 0; row < DepthBlock::kPixels; ++row) {
    for (int column = 0; column < DepthBlock::kPixels; ++column) {
      const DepthPixel& pixel = pixels[first + row * kSide + column];
      if (!pixel.known()) {
        ++found.unknown;
        continue;
      }
      found.min_cm = std::min(found.min_cm, pixel.depth_cm());
      found.max_cm = std::max(found.max_cm, pixel.depth_cm());
    }
  }
  blocks[block] = found;
}

void DepthTile::survey() {
  for (int block = 0; block < kBlocks * kBlocks; ++block) survey(block);
}

struct TilePool::Shelf {
  mutable std::mutex lock;
  std::vector<std::unique_ptr<DepthTile>> all;
  std::vector<DepthTile*> free;
};

TilePool::TilePool() : shelf_(std::make_unique<Shelf>()) {}

TilePool::~TilePool() { ISOBATH_ASSERT(shelf_->free.size() == shelf_->all.size()); }

void TilePool::reserve(std::size_t count) {
  const std::scoped_lock guard(shelf_->lock);
  while (shelf_->free.size() < count) {
    shelf_->all.push_back(std::make_unique<DepthTile>());
    shelf_->all.back()->pool_ = this;
    shelf_->free.reserve(shelf_->all.size());
    shelf_->free.push_back(shelf_->all.back().get());
  }
}

TilePtr TilePool::take() {
  const std::scoped_lock guard(shelf_->lock);
  if (shelf_->free.empty()) {
    shelf_->all.push_back(std::make_unique<DepthTile>());
    shelf_->all.back()->pool_ = this;
    shelf_->free.reserve(shelf_->all.size());
    return TilePtr(shelf_->all.back().get());
  }
  DepthTile* tile = shelf_->free.back();
  shelf_->free.pop_back();
  return TilePtr(tile);
}

void TilePool::give_back(DepthTile* tile) {
  const std::scoped_lock guard(shelf_->lock);
  shelf_->free.push_back(tile);
}

std::size_t TilePool::allocated() const {
  const std::scoped_lock guard(shelf_->lock);
  return shelf_->all.size();
}

DepthTile& TilePtr::own() {
  // Only the owner of this reference makes new ones, so a count of one cannot rise meanwhile. Acquire pairs with the
  // release by the last other holder, whose reads must be over before we write.
  if (tile_->references_.load(std::memory_order_acquire) != 1) {
    TilePtr clone = tile_->pool_->take();
    clone.tile_->pixels = tile_->pixels;
    clone.tile_->blocks = tile_->blocks;
    clone.tile_->changed = tile_->changed;
    *this = std::move(clone);
  }
  return *tile_;
}

// Windows ------------------------------------------------------------------------------------------------------------

DepthWindow::DepthWindow(int tiles)
    : tiles_(tiles), mask_(static_cast<std::uint32_t>(tiles) - 1), ring_(static_cast<std::size_t>(tiles) * tiles) {
  ISOBATH_ASSERT(std::has_single_bit(static_cast<unsigned>(tiles)));
}

void DepthWindow::move_to(Pixel first_tile) {
  const DepthWindow before = *this;
  first_tile_ = first_tile;
  for (TilePtr& tile : ring_) tile = TilePtr();
  for (int row = 0; row < tiles_; ++row) {
    for (int column = 0; column < tiles_; ++column) {
      const Pixel at{first_tile.column + column, first_tile.row + row};
      if (before.holds_tile(at)) tile(at) = before.tile(at);
    }
  }
}

void DepthWindow::set(Pixel p, const DepthPixel& pixel) { set(tile(tile_of(p)).own(), index_in_tile(p), pixel); }

void DepthWindow::set(DepthTile& tile, int index, const DepthPixel& pixel) {
  DepthPixel& stored = tile.pixels[static_cast<std::size_t>(index)];
  const DepthPixel before = std::exchange(stored, pixel);
  const int row = index / DepthTile::kSide, column = index % DepthTile::kSide;
  tile.changed[row] |= 1U << column;
  if (before.depth_word == pixel.depth_word) return;
  const int block = row / DepthBlock::kPixels * DepthTile::kBlocks + column / DepthBlock::kPixels;
  DepthBlock& summary = tile.blocks[block];
  const bool held_edge = before.known() && (before.depth_cm() == summary.min_cm || before.depth_cm() == summary.max_cm);
  if (!pixel.known() || (held_edge && pixel.depth_cm() != before.depth_cm())) return tile.survey(block);
  if (!before.known()) --summary.unknown;
  summary.min_cm = std::min(summary.min_cm, pixel.depth_cm());
  summary.max_cm = std::max(summary.max_cm, pixel.depth_cm());
}

}  // namespace isobath
