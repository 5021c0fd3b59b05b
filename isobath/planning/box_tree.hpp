// BoxTree: finds which of many boxes are near without a test of each: a static binary tree of bounding boxes, halved at
// the median centre along the longer side. Shapes of any extent mix well (a rock beside a fence of a kilometre), and
// one test skips all that is far.
//
// The tree holds boxes only; the caller keeps the exact shapes and chooses frame and units. Immutable once built; the
// order of visits depends on the boxes alone. Cost: N log N to build, about 4 log N boxes a query.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <Eigen/Geometry>
#include <vector>

namespace isobath {

class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(const std::vector<Eigen::AlignedBox2d>& boxes);

  /// Bounds of all boxes; empty without any.
  [[nodiscard]] Eigen::AlignedBox2d bounds() const { return nodes_.empty() ? Eigen::AlignedBox2d() : nodes_[0].box; }

  /// Descends where `enter(box)` is true and calls `use(i)` for the boxes that are reached; the answers of `enter` may
  /// change as `use` learns.
  template <class Enter, class Use>
  void visit(const Enter& enter, const Use& use) const {
    if (nodes_.empty()) return;
    std::array<std::int32_t, 64> waiting{};  // twice the depth for 2^31 boxes
    std::size_t count = 1;
    while (count > 0) {
      const Node& node = nodes_[static_cast<std::size_t>(waiting[--count])];
      if (!enter(node.box)) continue;
      if (node.second < 0) {
        for (std::int32_t i = node.from; i < node.to; ++i) use(order_[static_cast<std::size_t>(i)]);
        continue;
      }
      waiting[count++] = node.second;
      waiting[count++] = node.first;
    }
  }

 private:
  struct Node {
    Eigen::AlignedBox2d box;
    std::int32_t from = 0, to = 0;         ///< of `order_`
    std::int32_t first = -1, second = -1;  ///< children; below 0: a leaf
  };
  std::int32_t build(const std::vector<Eigen::AlignedBox2d>& boxes, std::int32_t from, std::int32_t to);

  std::vector<Node> nodes_;
  std::vector<std::size_t> order_;
};

}  // namespace isobath
