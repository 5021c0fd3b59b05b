// DepthTile: 32 x 32 pixels of a local map, shared by copy-on-write; DepthWindow: a square of them around the vehicle.
//
// A window is a ring of tiles addressed modulo its side: it moves by exchanging tiles, and tiles that stay are not
// copied (toroidal; Oskard 1990, III-C; ledger S1-27, S1-28). Copying a window copies pointers. The copy is a snapshot
// for readers in other threads, for a flush, or for the buffer of a shift; the writer then clones each tile at its
// first write to it (about 1 us). Each tile keeps the minimum and maximum known depth of its 4 x 4 blocks of 8 x 8
// pixels, which are the group and vehicle level (S1-38, S1-40). A pixel that becomes shallower lowers the minimum at
// once; when a pixel that held the minimum deepens, its block of 64 pixels is surveyed again.
//
// Threads: one writer a window; any thread may read, copy and drop snapshots. Tiles come from a pool that keeps freed
// tiles, so that steady work allocates nothing.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <isobath/map/depth/depth_pixel.hpp>
#include <isobath/map/depth/depth_rules.hpp>
#include <isobath/map/depth/pixel_grid.hpp>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace isobath {

/// Minimum and maximum known depth of a block of 8 x 8 pixels, and how many of its pixels are unknown.
struct DepthBlock {
  static constexpr int kPixels = 8;  ///< a side: 4 m of 0.5 m pixels
  std::int32_t min_cm = std::numeric_limits<std::int32_t>::max();
  std::int32_t max_cm = std::numeric_limits<std::int32_t>::min();
  std::int32_t unknown = kPixels * kPixels;
  bool operator==(const DepthBlock&) const = default;
};

struct DepthTile {
  static constexpr int kSide = 32;
  static constexpr int kPixels = kSide * kSide;
  static constexpr int kBlocks = kSide / DepthBlock::kPixels;

  std::array<DepthPixel, kPixels> pixels;
  std::array<DepthBlock, kBlocks * kBlocks> blocks;
  std::array<std::uint32_t, kSide> changed;  ///< one bit a pixel: not yet in the trees

  /// Recomputes the blocks from the pixels.
  void survey();
  void survey(int block);

 private:
  friend class TilePtr;
  friend class TilePool;
  std::atomic<int> references_{0};
  class TilePool* pool_ = nullptr;
};

/// Keeps unused tiles for later use. Must outlive all of its tiles.
class TilePool {
 public:
  TilePool();
  ~TilePool();
  TilePool(const TilePool&) = delete;
  TilePool& operator=(const TilePool&) = delete;
  /// Allocates memory for `count` free tiles.
  void reserve(std::size_t count);
  /// The tile's contents are left over from its last use.
  class TilePtr take();
  /// Number of tiles ever allocated.
  [[nodiscard]] std::size_t allocated() const;

 private:
  friend class TilePtr;
  void give_back(DepthTile* tile);
  struct Shelf;
  std::unique_ptr<Shelf> shelf_;
};

/// Counted reference to a tile.
class TilePtr {
 public:
  TilePtr() = default;
  TilePtr(const TilePtr& other) : tile_(other.tile_) {
    if (tile_) tile_->references_.fetch_add(1, std::memory_order_relaxed);
  }
  TilePtr(TilePtr&& other) noexcept : tile_(std::exchange(other.tile_, nullptr)) {}
  TilePtr& operator=(TilePtr other) noexcept {
    std::swap(tile_, other.tile_);
    return *this;
  }
  ~TilePtr() {
    if (tile_ && tile_->references_.fetch_sub(1, std::memory_order_acq_rel) == 1) tile_->pool_->give_back(tile_);
  }
  const DepthTile* operator->() const { return tile_; }
  const DepthTile& operator*() const { return *tile_; }
  explicit operator bool() const { return tile_ != nullptr; }
  bool operator==(const TilePtr&) const = default;
  /// The tile to write to: itself if this is the only reference, else a clone that takes its place.
  DepthTile& own();

 private:
  friend class TilePool;
  explicit TilePtr(DepthTile* tile) : tile_(tile) { tile_->references_.fetch_add(1, std::memory_order_relaxed); }
  DepthTile* tile_ = nullptr;
};

class DepthWindow {
 public:
  /// `tiles`: a side, a power of two. The window is empty until tiles are put in.
  explicit DepthWindow(int tiles = 16);

  [[nodiscard]] int tiles() const { return tiles_; }
  [[nodiscard]] int pixels() const { return tiles_ * DepthTile::kSide; }
  /// The north-west tile, in tiles from pixel (0, 0) of the map.
  [[nodiscard]] Pixel first_tile() const { return first_tile_; }
  [[nodiscard]] PixelWindow extent() const {
    return {first_tile_.column * DepthTile::kSide, first_tile_.row * DepthTile::kSide, pixels(), pixels()};
  }
  [[nodiscard]] bool contains(Pixel p) const { return extent().contains(p); }
  [[nodiscard]] bool holds_tile(Pixel tile) const {
    return tile.column >= first_tile_.column && tile.column - first_tile_.column < tiles_ &&
           tile.row >= first_tile_.row && tile.row - first_tile_.row < tiles_;
  }
  static Pixel tile_of(Pixel p) { return {p.column >> 5, p.row >> 5}; }
  static int index_in_tile(Pixel p) { return (p.row & 31) * DepthTile::kSide + (p.column & 31); }

  /// Both for pixels and tiles within the window.
  [[nodiscard]] const DepthPixel& at(Pixel p) const { return tile(tile_of(p))->pixels[index_in_tile(p)]; }
  [[nodiscard]] const TilePtr& tile(Pixel tile) const { return ring_[slot(tile)]; }
  TilePtr& tile(Pixel tile) { return ring_[slot(tile)]; }

  /// Sets another north-west tile; tiles that stay within the window keep their place, the others are released.
  void move_to(Pixel first_tile);

  /// Writes one pixel and updates its block and its mark of change.
  void set(Pixel p, const DepthPixel& pixel);
  static void set(DepthTile& tile, int index, const DepthPixel& pixel);

 private:
  [[nodiscard]] std::size_t slot(Pixel tile) const {
    const std::size_t row = static_cast<std::uint32_t>(tile.row) & mask_;
    const std::size_t column = static_cast<std::uint32_t>(tile.column) & mask_;
    return row * static_cast<std::size_t>(tiles_) + column;
  }
  int tiles_;
  std::uint32_t mask_;
  Pixel first_tile_;
  std::vector<TilePtr> ring_;
};

}  // namespace isobath
