// SquareBlocks: the geometry of blocks and the pool of nodes that the quadtrees of points and of segments share (ledger
// S1-20, S1-22, S1-23). Points are (north, east) in metres; quadrants are NW, NE, SW, SE.
//
// Placing and measuring use the same computed middle of a block, so that a distance to a block is never larger than the
// computed distance to something in it: searches are exact, not exact up to rounding.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <vector>

namespace isobath {

struct SquareBlock {
  double south = 0;
  double west = 0;
  double north = 0;
  double east = 0;

  [[nodiscard]] double middle_north() const { return 0.5 * (south + north); }
  [[nodiscard]] double middle_east() const { return 0.5 * (west + east); }
  [[nodiscard]] int quadrant_of(const Eigen::Vector2d& p) const {
    return (p.x() < middle_north() ? 2 : 0) + (p.y() < middle_east() ? 0 : 1);
  }
  [[nodiscard]] SquareBlock quadrant(int q) const {
    SquareBlock b = *this;
    ((q & 2) != 0 ? b.north : b.south) = middle_north();
    ((q & 1) != 0 ? b.west : b.east) = middle_east();
    return b;
  }
  /// Edges included.
  [[nodiscard]] bool contains(const Eigen::Vector2d& p) const {
    return p.x() >= south && p.x() <= north && p.y() >= west && p.y() <= east;
  }
  [[nodiscard]] double squared_distance(const Eigen::Vector2d& p) const {
    const double dn = std::max({south - p.x(), p.x() - north, 0.0});
    const double de = std::max({west - p.y(), p.y() - east, 0.0});
    return dn * dn + de * de;
  }
  [[nodiscard]] bool meets(const Eigen::AlignedBox2d& box) const {
    return box.min().x() <= north && box.max().x() >= south && box.min().y() <= east && box.max().y() >= west;
  }
};

/// The result of an edit: done, or the reason why not.
enum class TreeEdit : std::uint8_t {
  kDone,
  kOutside,  ///< outside the tree's square, or not finite
  kKnownId,  ///< the id is in the tree already
};

/// The work of one search.
struct SearchEffort {
  std::size_t nodes = 0;    ///< internal nodes and leaves
  std::size_t objects = 0;  ///< distances computed
};

/// Blocks of four descriptors: `index << 1` links to a block; each tree defines the 31 bits of its leaves.
class SquareBlocks {
 public:
  using Block = std::array<std::uint32_t, 4>;

  Block& operator[](std::uint32_t node) { return blocks_[node >> 1]; }
  const Block& operator[](std::uint32_t node) const { return blocks_[node >> 1]; }
  /// Stores a new block; returns a link to it.
  std::uint32_t allocate(const Block& block) {
    blocks_.push_back(block);
    return static_cast<std::uint32_t>(blocks_.size() - 1) << 1;
  }
  [[nodiscard]] std::size_t size() const { return blocks_.size(); }
  static constexpr bool is_link(std::uint32_t node) { return (node & 1U) == 0; }

 private:
  std::vector<Block> blocks_;
};

/// Best-first search: calls leaf(descriptor) for every leaf not farther than bound(), which may shrink meanwhile. The
/// search first descends to the leaf nearest to the point. A sibling on the way enters the queue only if that leaf has
/// not made it too far, so the queue stays nearly empty.
template <class Bound, class Leaf>
class BestFirstSearch {
 public:
  static constexpr std::uint32_t kEmpty = 0xffffffff;  ///< a leaf that holds nothing
  static constexpr int kMaxLevels = 48;

  BestFirstSearch(const SquareBlocks& blocks, const Eigen::Vector2d& point, Bound bound, Leaf leaf)
      : blocks_(blocks), point_(point), bound_(bound), leaf_(leaf) {}

  /// Returns the number of nodes visited.
  std::size_t run(std::uint32_t root, const SquareBlock& square) {
    if (root == kEmpty) return 0;
    descend({square.squared_distance(point_), root, square});
    while (!queue_.empty() && queue_.front().squared_distance <= bound_()) {
      std::pop_heap(queue_.begin(), queue_.end(), later);
      const Waiting next = queue_.back();
      queue_.pop_back();
      ++visited_;
      if (SquareBlocks::is_link(next.node)) {
        wait_for_quadrants(next, -1);
      } else {
        leaf_(next.node);
      }
    }
    return visited_;
  }

 private:
  struct Waiting {
    double squared_distance;
    std::uint32_t node;
    SquareBlock block;
  };
  static bool later(const Waiting& a, const Waiting& b) { return a.squared_distance > b.squared_distance; }

  void descend(Waiting at) {
    std::array<Waiting, kMaxLevels> passed;
    std::array<int, kMaxLevels> entered;
    int depth = 0;
    ++visited_;
    while (SquareBlocks::is_link(at.node)) {
      passed[depth] = at;
      const int q = nearest_quadrant(at);
      entered[depth++] = q;
      at.node = blocks_[at.node][q];
      at.block = at.block.quadrant(q);
      ++visited_;
    }
    leaf_(at.node);
    while (depth-- > 0) wait_for_quadrants(passed[depth], entered[depth]);
  }
  [[nodiscard]] int nearest_quadrant(const Waiting& parent) const {
    const SquareBlocks::Block& children = blocks_[parent.node];
    const int around = parent.block.quadrant_of(point_);
    if (children[around] != kEmpty) return around;
    int nearest = around;
    double squared = std::numeric_limits<double>::infinity();
    for (int q = 0; q < 4; ++q) {
      const double d = parent.block.quadrant(q).squared_distance(point_);
      if (children[q] == kEmpty || d >= squared) continue;
      nearest = q;
      squared = d;
    }
    return nearest;
  }
  void wait_for_quadrants(const Waiting& parent, int but) {
    const SquareBlocks::Block& children = blocks_[parent.node];
    for (int q = 0; q < 4; ++q) {
      if (q == but || children[q] == kEmpty) continue;
      const SquareBlock block = parent.block.quadrant(q);
      const double squared = block.squared_distance(point_);
      if (squared > bound_()) continue;
      queue_.push_back({squared, children[q], block});
      std::push_heap(queue_.begin(), queue_.end(), later);
    }
  }

  const SquareBlocks& blocks_;
  Eigen::Vector2d point_;
  Bound bound_;
  Leaf leaf_;
  std::vector<Waiting> queue_;
  std::size_t visited_ = 0;
};

}  // namespace isobath
