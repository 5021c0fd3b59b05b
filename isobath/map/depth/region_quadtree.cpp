#include <algorithm>
#include <array>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/region_quadtree.hpp>

namespace isobath {
namespace {

using Square = RegionQuadtree::Square;
using Rows = RegionQuadtree::Rows;
using Block = BlockPool::Block;

constexpr bool is_leaf(std::uint32_t node) { return RegionQuadtree::is_leaf(node); }
constexpr std::uint32_t leaf_of(std::uint32_t value) { return RegionQuadtree::leaf_of(value); }

bool all_one_leaf(const Block& b) { return is_leaf(b[0]) && b[0] == b[1] && b[0] == b[2] && b[0] == b[3]; }

/// The descriptor of a square whose quadrants were `before` and are `now`; `node` is the square's old descriptor.
std::uint32_t settle(BlockPool& pool, std::uint32_t node, const Block& before, const Block& now) {
  if (now == before) return node;
  if (all_one_leaf(now)) {
    if (!is_leaf(node)) pool.release(node >> 1);
    return now[0];
  }
  if (is_leaf(node)) return RegionQuadtree::link_to(pool.allocate(now));
  pool.write(node >> 1, now);
  return node;
}

Block quadrants_of(const BlockPool& pool, std::uint32_t node) {
  if (is_leaf(node)) return {node, node, node, node};
  return pool.block(node >> 1);
}

/// An array of pixels that covers `window` of the map.
class Raster {
 public:
  Raster(const PixelWindow& window, const Rows& rows) : window_(window), rows_(rows) {}

  enum class Covers : std::uint8_t { kNothing, kPart, kAll };
  [[nodiscard]] Covers covers(const Square& s) const {
    const std::int32_t column = s.column - window_.column;
    const std::int32_t row = s.row - window_.row;
    const std::int32_t side = s.side();
    if (column >= window_.width || row >= window_.height || column + side <= 0 || row + side <= 0) {
      return Covers::kNothing;
    }
    const bool all = column >= 0 && row >= 0 && column + side <= window_.width && row + side <= window_.height;
    return all ? Covers::kAll : Covers::kPart;
  }
  [[nodiscard]] const std::uint32_t* at(const Square& s) const {
    return rows_.values + (s.row - window_.row) * rows_.stride + (s.column - window_.column);
  }
  [[nodiscard]] std::ptrdiff_t stride() const { return rows_.stride; }
  [[nodiscard]] const std::uint8_t* changed(const Square& s) const {
    if (rows_.changed == nullptr) return nullptr;
    return rows_.changed + (s.row - window_.row) * rows_.changed_stride + (s.column - window_.column);
  }
  [[nodiscard]] std::ptrdiff_t changed_stride() const { return rows_.changed_stride; }

 private:
  PixelWindow window_;
  Rows rows_;
};

/// Writes a raster into a tree, quadrants before the square that they form, so that only nodes that stay are made.
class Builder {
 public:
  Builder(BlockPool& pool, const Raster& raster) : pool_(pool), raster_(raster) {}

  /// Writes the square of `node`; the raster covers all, some or none of its pixels.
  std::uint32_t square(std::uint32_t node, const Square& s) {
    const Raster::Covers covers = raster_.covers(s);
    if (covers == Raster::Covers::kNothing) return node;
    if (covers == Raster::Covers::kAll) return covered(node, raster_.at(s), raster_.changed(s), s.level);
    if (!is_leaf(node)) ++located_;
    const Block before = quadrants_of(pool_, node);
    Block now;
    for (int q = 0; q < 4; ++q) now[q] = square(before[q], s.quadrant(q));
    return settle(pool_, node, before, now);
  }

  [[nodiscard]] std::size_t located() const { return located_; }
  /// The bitwise or of all values.
  [[nodiscard]] std::uint32_t bits() const { return bits_; }

 private:
  /// A square that was one leaf and whose pixels all get new values.
  std::uint32_t fresh(const std::uint32_t* pixels, int level) {
    if (level == 1) return four_fresh_pixels(pixels);
    const std::ptrdiff_t half = std::ptrdiff_t{1} << (level - 1);
    const std::uint32_t* south = pixels + half * raster_.stride();
    Block b;
    b[0] = fresh(pixels, level - 1);
    b[1] = fresh(pixels + half, level - 1);
    b[2] = fresh(south, level - 1);
    b[3] = fresh(south + half, level - 1);
    return joined(b);
  }
  std::uint32_t four_fresh_pixels(const std::uint32_t* north) {
    const std::uint32_t* south = north + raster_.stride();
    bits_ |= north[0] | north[1] | south[0] | south[1];
    return joined({leaf_of(north[0]), leaf_of(north[1]), leaf_of(south[0]), leaf_of(south[1])});
  }
  std::uint32_t joined(const Block& b) { return all_one_leaf(b) ? b[0] : RegionQuadtree::link_to(pool_.allocate(b)); }

  /// A square that the raster covers; `changed` is null if all of its pixels have changed.
  std::uint32_t covered(std::uint32_t node, const std::uint32_t* pixels, const std::uint8_t* changed, int level);
  std::uint32_t pixel(std::uint32_t node, const std::uint32_t* value, const std::uint8_t* changed) {
    if (changed != nullptr && *changed == 0) return node;
    bits_ |= *value;
    return leaf_of(*value);
  }
  [[nodiscard]] bool any(const std::uint8_t* changed, int side) const {
    std::uint8_t bits = 0;
    for (int r = 0; r < side; ++r, changed += raster_.changed_stride()) {
      for (int c = 0; c < side; ++c) bits |= changed[c];
    }
    return bits != 0;
  }

  static constexpr int kLookAhead = 4;  ///< unchanged squares up to this level are skipped without a visit

  BlockPool& pool_;
  const Raster& raster_;
  std::size_t located_ = 0;
  std::uint32_t bits_ = 0;
};

std::uint32_t Builder::covered(std::uint32_t node, const std::uint32_t* pixels, const std::uint8_t* changed,
                               int level) {
  if (level == 0) return pixel(node, pixels, changed);
  if (changed == nullptr && is_leaf(node)) return fresh(pixels, level);
  if (changed != nullptr && level <= kLookAhead && !any(changed, 1 << level)) return node;
  if (!is_leaf(node)) ++located_;
  const Block before = quadrants_of(pool_, node);
  Block now;
  const std::ptrdiff_t half = std::ptrdiff_t{1} << (level - 1);
  const std::ptrdiff_t south = half * raster_.stride();
  if (changed == nullptr) {
    for (int q = 0; q < 4; ++q) {
      const std::uint32_t* quadrant = pixels + (q & 1) * half + (q >> 1) * south;
      now[q] = level == 1 ? pixel(before[q], quadrant, nullptr) : covered(before[q], quadrant, nullptr, level - 1);
    }
  } else {
    const std::ptrdiff_t changed_south = half * raster_.changed_stride();
    for (int q = 0; q < 4; ++q) {
      now[q] = covered(before[q], pixels + (q & 1) * half + (q >> 1) * south,
                       changed + (q & 1) * half + (q >> 1) * changed_south, level - 1);
    }
  }
  return settle(pool_, node, before, now);
}

/// Copies leaves into an array that covers `window` of the map.
class Reader {
 public:
  Reader(const BlockPool& pool, const PixelWindow& window, std::uint32_t* out, std::ptrdiff_t stride)
      : pool_(pool), window_(window), out_(out), stride_(stride) {}

  void square(std::uint32_t node, const Square& s) {
    const PixelWindow part = overlap(s.window(), window_);
    if (part.width <= 0 || part.height <= 0) return;
    std::uint32_t* corner = out_ + (part.row - window_.row) * stride_ + (part.column - window_.column);
    if (part.width == s.side() && part.height == s.side()) return covered(node, corner, s.level);
    ++visited_;
    if (is_leaf(node)) return fill(node >> 1, corner, part.width, part.height);
    const Block children = pool_.block(node >> 1);
    for (int q = 0; q < 4; ++q) square(children[q], s.quadrant(q));
  }
  void fill(std::uint32_t value, std::uint32_t* corner, std::int32_t width, std::int32_t height) const {
    for (std::int32_t r = 0; r < height; ++r, corner += stride_) std::fill_n(corner, width, value);
  }
  [[nodiscard]] std::size_t visited() const { return visited_; }

 private:
  void covered(std::uint32_t node, std::uint32_t* corner, int level) {
    ++visited_;
    if (is_leaf(node)) {
      if (level > 0) return fill(node >> 1, corner, 1 << level, 1 << level);
      *corner = node >> 1;
      return;
    }
    const std::uint32_t* children = pool_.at(node >> 1);
    if (level == 1) {
      visited_ += 4;
      corner[0] = children[0] >> 1;
      corner[1] = children[1] >> 1;
      corner[stride_] = children[2] >> 1;
      corner[stride_ + 1] = children[3] >> 1;
      return;
    }
    const std::ptrdiff_t half = std::ptrdiff_t{1} << (level - 1);
    covered(children[0], corner, level - 1);
    covered(children[1], corner + half, level - 1);
    covered(children[2], corner + half * stride_, level - 1);
    covered(children[3], corner + half * stride_ + half, level - 1);
  }

  const BlockPool& pool_;
  PixelWindow window_;
  std::uint32_t* out_;
  std::ptrdiff_t stride_;
  std::size_t visited_ = 0;
};

bool equal_below(const BlockPool& a, std::uint32_t node_a, const BlockPool& b, std::uint32_t node_b) {
  if (is_leaf(node_a) || is_leaf(node_b)) return node_a == node_b;
  const std::uint32_t* in_a = a.at(node_a >> 1);
  const std::uint32_t* in_b = b.at(node_b >> 1);
  for (int q = 0; q < 4; ++q) {
    if (!equal_below(a, in_a[q], b, in_b[q])) return false;
  }
  return true;
}

}  // namespace

PixelWindow overlap(const PixelWindow& a, const PixelWindow& b) {
  const std::int32_t column = std::max(a.column, b.column);
  const std::int32_t row = std::max(a.row, b.row);
  const std::int64_t east = std::min(std::int64_t{a.column} + a.width, std::int64_t{b.column} + b.width);
  const std::int64_t south = std::min(std::int64_t{a.row} + a.height, std::int64_t{b.row} + b.height);
  return {column, row, static_cast<std::int32_t>(std::max<std::int64_t>(east - column, 0)),
          static_cast<std::int32_t>(std::max<std::int64_t>(south - row, 0))};
}

RegionQuadtree::RegionQuadtree(int levels, std::uint32_t outside)
    : levels_(levels), outside_(outside), root_(leaf_of(outside)) {
  ISOBATH_ASSERT(levels >= 0 && levels <= kMaxLevels && outside <= kLargestValue);
}

RegionQuadtree::RegionQuadtree(int levels, std::uint32_t outside, std::uint32_t root, BlockPool pool)
    : levels_(levels), outside_(outside), root_(root), pool_(std::move(pool)) {
  ISOBATH_ASSERT(levels >= 0 && levels <= kMaxLevels && outside <= kLargestValue);
}

RegionQuadtree RegionQuadtree::from_raster(int levels, std::span<const std::uint32_t> values, int width, int height,
                                           std::uint32_t outside) {
  ISOBATH_ASSERT(width >= 0 && height >= 0 && values.size() == std::size_t(width) * std::size_t(height));
  RegionQuadtree tree(levels, outside);
  tree.write({0, 0, width, height}, {values.data(), width});
  return tree;
}

std::uint32_t RegionQuadtree::at(Pixel pixel) const {
  return square().contains(pixel) ? leaf_at(pixel).value : outside_;
}

RegionQuadtree::Leaf RegionQuadtree::leaf_at(Pixel pixel) const {
  ISOBATH_ASSERT(square().contains(pixel));
  std::uint32_t node = root_;
  int level = levels_;
  while (!is_leaf(node)) {
    --level;
    const std::int32_t quadrant = ((pixel.row >> level) & 1) << 1 | ((pixel.column >> level) & 1);
    node = pool_.at(node >> 1)[quadrant];
  }
  const std::int32_t side = std::int32_t{1} << level;
  return {node >> 1, {pixel.column & -side, pixel.row & -side, side, side}};
}

void RegionQuadtree::fill(const PixelWindow& window, std::uint32_t value) {
  ISOBATH_ASSERT(window.width >= 0 && window.height >= 0 && value <= kLargestValue);
  root_ = fill_in(root_, {0, 0, levels_}, overlap(window, square()), leaf_of(value));
}

std::uint32_t RegionQuadtree::fill_in(std::uint32_t node, const Square& s, const PixelWindow& window,
                                      std::uint32_t leaf) {
  const PixelWindow part = overlap(s.window(), window);
  if (node == leaf || part.width == 0 || part.height == 0) return node;
  if (part.width == s.side() && part.height == s.side()) {
    release_below(node);
    return leaf;
  }
  const Block before = quadrants_of(pool_, node);
  Block now;
  for (int q = 0; q < 4; ++q) now[q] = fill_in(before[q], s.quadrant(q), window, leaf);
  return settle(pool_, node, before, now);
}

void RegionQuadtree::release_below(std::uint32_t node) {
  if (is_leaf(node)) return;
  for (std::uint32_t child : pool_.block(node >> 1)) release_below(child);
  pool_.release(node >> 1);
}

std::size_t RegionQuadtree::read(const PixelWindow& window, std::uint32_t* out, std::ptrdiff_t stride) const {
  ISOBATH_ASSERT(window.width >= 0 && window.height >= 0);
  Reader reader(pool_, window, out, stride);
  const PixelWindow inside = overlap(window, square());
  if (inside != window) reader.fill(outside_, out, window.width, window.height);
  reader.square(root_, {0, 0, levels_});
  return reader.visited();
}

std::size_t RegionQuadtree::write(const PixelWindow& window, const Rows& rows) {
  ISOBATH_ASSERT(window.width >= 0 && window.height >= 0);
  const Raster raster(window, rows);
  Builder builder(pool_, raster);
  root_ = builder.square(root_, {0, 0, levels_});
  ISOBATH_ASSERT(builder.bits() <= kLargestValue);
  return builder.located();
}

RegionQuadtree::Statistics RegionQuadtree::statistics() const {
  Statistics s;
  s.internal_nodes = pool_.in_use();
  s.leaves = 3 * s.internal_nodes + 1;
  s.words = 4 * s.internal_nodes + 1;
  s.pages = pool_.pages();
  s.mapped_pages = pool_.mapped_pages();
  s.bytes = s.pages * BlockPool::kPageBytes;
  return s;
}

bool operator==(const RegionQuadtree& a, const RegionQuadtree& b) {
  return a.levels_ == b.levels_ && a.outside_ == b.outside_ && equal_below(a.pool_, a.root_, b.pool_, b.root_);
}

}  // namespace isobath
