// RegionQuadtree: a square map of 2^levels x 2^levels pixels that merges equal neighbours (Oskard 1990, III-A, III-C;
// ledger S1-11, S1-12, S1-15, S1-16, S1-34, S1-35).
//
// A square is a leaf of one value or is split into NW, NE, SW, SE. Four equal leaves always merge, so that equal
// contents give equal trees. Values have 31 bits. A descriptor is value << 1 | 1 for a leaf and block index << 1 for a
// link. Only internal nodes have storage (BlockPool), hence L leaves take 4 (L - 1) / 3 words and one for the root, or
// (4L - 1) / 3 (S1-E01). Columns grow east, rows grow south. Every pixel beyond the square reads as the value
// `outside`, which also fills a new map.
//
// A copy is a snapshot: it shares all pages of memory until one side writes. Threads: as for BlockPool; readers in
// other threads use copies, which the owner makes between its writes.
//
// Errors: assertions refuse a value of 32 bits, a window of negative size, and a pixel outside the square where one
// inside is required. Windows may extend beyond the square.
//
// Cost on one core of a 2.6 GHz machine under load (bench/quadtree_bench.cpp): a raster of 2048 x 2048 becomes a tree
// at 300 M pixels/s where every pixel is a leaf, and at 500 M/s and more where pixels merge. A window of 512 x 512 of
// such pixels is read in 0.35 ms (copied from a plain array in 0.03 ms) and written in 1.7 ms, or 0.14 ms where one
// pixel in a hundred has changed. A snapshot of 1400 pages takes 10 us. 5.3 bytes a leaf.
#pragma once

#include <cstddef>
#include <cstdint>
#include <isobath/map/depth/pixel_grid.hpp>
#include <isobath/map/storage/block_pool.hpp>
#include <span>

namespace isobath {

class RegionQuadtree {
 public:
  static constexpr int kMaxLevels = 24;
  static constexpr std::uint32_t kLargestValue = 0x7fffffff;

  struct Leaf {
    std::uint32_t value = 0;
    PixelWindow window;
  };
  struct Statistics {
    std::uint64_t leaves = 0;
    std::uint64_t internal_nodes = 0;
    std::uint64_t words = 0;  ///< (4 leaves - 1) / 3
    std::uint64_t pages = 0;
    std::uint64_t mapped_pages = 0;  ///< pages that are still in the file
    std::uint64_t bytes = 0;         ///< of all pages
  };
  /// Rows of pixels; `stride` is the step between rows. `changed` has a byte a pixel, nonzero where the pixel is
  /// written.
  struct Rows {
    const std::uint32_t* values = nullptr;
    std::ptrdiff_t stride = 0;
    const std::uint8_t* changed = nullptr;  ///< null: all pixels are written
    std::ptrdiff_t changed_stride = 0;
  };

  /// 0 <= levels <= 24.
  explicit RegionQuadtree(int levels, std::uint32_t outside = 0);
  /// From width * height values; pixels beyond them are `outside`. One pass in Morton order, which makes no node that
  /// does not stay (S1-15).
  static RegionQuadtree from_raster(int levels, std::span<const std::uint32_t> values, int width, int height,
                                    std::uint32_t outside);
  /// From a pool and a root that have been checked (tree_file).
  RegionQuadtree(int levels, std::uint32_t outside, std::uint32_t root, BlockPool pool);

  [[nodiscard]] int levels() const { return levels_; }
  [[nodiscard]] std::int32_t side() const { return std::int32_t{1} << levels_; }
  [[nodiscard]] PixelWindow square() const { return {0, 0, side(), side()}; }
  [[nodiscard]] std::uint32_t outside() const { return outside_; }

  [[nodiscard]] std::uint32_t at(Pixel pixel) const;
  [[nodiscard]] Leaf leaf_at(Pixel pixel) const;  ///< inside the square
  void fill(const PixelWindow& window, std::uint32_t value);

  /// Reads a window into an array; the traversal enters only squares that overlap it (S1-34). Returns the nodes
  /// visited.
  std::size_t read(const PixelWindow& window, std::uint32_t* out, std::ptrdiff_t stride) const;
  /// Writes an array into the map in Morton order: each node is located once (S1-35). Unchanged pages are not written.
  /// Returns the internal nodes located.
  std::size_t write(const PixelWindow& window, const Rows& rows);

  /// visit(value, part of the leaf's window inside `window`), NW to SE.
  template <class Visit>
  void for_each_leaf(const PixelWindow& window, Visit&& visit) const {
    visit_leaves(root_, {0, 0, levels_}, window, visit);
  }

  [[nodiscard]] Statistics statistics() const;
  [[nodiscard]] const BlockPool& pool() const { return pool_; }
  [[nodiscard]] std::uint32_t root() const { return root_; }
  /// Compares the contents; their storage may differ.
  friend bool operator==(const RegionQuadtree& a, const RegionQuadtree& b);

  static constexpr bool is_leaf(std::uint32_t descriptor) { return (descriptor & 1U) != 0; }
  static constexpr std::uint32_t leaf_of(std::uint32_t value) { return value << 1 | 1U; }
  static constexpr std::uint32_t link_to(std::uint32_t block) { return block << 1; }

  /// A square of 2^level pixels a side.
  struct Square {
    std::int32_t column = 0;
    std::int32_t row = 0;
    int level = 0;

    [[nodiscard]] std::int32_t side() const { return std::int32_t{1} << level; }
    [[nodiscard]] Square quadrant(int q) const {  // NW, NE, SW, SE
      return {column + ((q & 1) << (level - 1)), row + ((q >> 1) << (level - 1)), level - 1};
    }
    [[nodiscard]] PixelWindow window() const { return {column, row, side(), side()}; }
  };

 private:
  template <class Visit>
  void visit_leaves(std::uint32_t node, const Square& square, const PixelWindow& window, Visit&& visit) const;
  std::uint32_t fill_in(std::uint32_t node, const Square& square, const PixelWindow& window, std::uint32_t leaf);
  void release_below(std::uint32_t node);

  int levels_;
  std::uint32_t outside_;
  std::uint32_t root_;
  BlockPool pool_;
};

/// The common part of both; an empty one has width or height 0.
PixelWindow overlap(const PixelWindow& a, const PixelWindow& b);

template <class Visit>
void RegionQuadtree::visit_leaves(std::uint32_t node, const Square& square, const PixelWindow& window,
                                  Visit&& visit) const {
  const PixelWindow part = overlap(square.window(), window);
  if (part.width <= 0 || part.height <= 0) return;
  if (is_leaf(node)) {
    visit(node >> 1, part);
    return;
  }
  const BlockPool::Block children = pool_.block(node >> 1);
  for (int q = 0; q < 4; ++q) visit_leaves(children[q], square.quadrant(q), window, visit);
}

}  // namespace isobath
