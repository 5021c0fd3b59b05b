#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/features/pr_quadtree.hpp>

namespace isobath {

PrQuadtree::PrQuadtree(const Eigen::Vector2d& south_west, double side_m, int levels)
    : square_{south_west.x(), south_west.y(), south_west.x() + side_m, south_west.y() + side_m}, levels_(levels) {
  ISOBATH_ASSERT(south_west.allFinite() && std::isfinite(side_m) && side_m > 0 && levels >= 0 && levels <= 48);
}

TreeEdit PrQuadtree::insert(const Object& object) {
  if (!square_.contains(object.position)) return TreeEdit::kOutside;
  if (!ids_.insert(object.id).second) return TreeEdit::kKnownId;
  ISOBATH_ASSERT(objects_.size() < 0x7fffffff);
  const auto slot = static_cast<std::uint32_t>(objects_.size());
  objects_.push_back({object.position, object.id, object.kinds, kEmpty});
  root_ = insert_in(root_, square_, 0, slot << 1 | 1U);
  return TreeEdit::kDone;
}

std::uint32_t PrQuadtree::insert_in(std::uint32_t node, const SquareBlock& block, int depth, std::uint32_t leaf) {
  if (node == kEmpty) return leaf;
  if (!SquareBlocks::is_link(node)) {
    if (depth == levels_) {  // a bucket
      objects_[leaf >> 1].next = node;
      return leaf;
    }
    SquareBlocks::Block quadrants{kEmpty, kEmpty, kEmpty, kEmpty};
    quadrants[block.quadrant_of(at(node).position)] = node;
    node = blocks_.allocate(quadrants);
  }
  const int q = block.quadrant_of(at(leaf).position);
  const std::uint32_t child = insert_in(blocks_[node][q], block.quadrant(q), depth + 1, leaf);
  blocks_[node][q] = child;
  return node;
}

template <class Visit>
void PrQuadtree::visit_window(std::uint32_t node, const SquareBlock& block, const Eigen::AlignedBox2d& window,
                              Visit visit) const {
  if (node == kEmpty || !block.meets(window)) return;
  if (SquareBlocks::is_link(node)) {
    for (int q = 0; q < 4; ++q) visit_window(blocks_[node][q], block.quadrant(q), window, visit);
    return;
  }
  for (; node != kEmpty; node = at(node).next) visit(at(node));
}

std::vector<std::uint64_t> PrQuadtree::in_window(const Eigen::AlignedBox2d& window, std::uint32_t kinds) const {
  std::vector<std::uint64_t> ids;
  visit_window(root_, square_, window, [&](const Stored& object) {
    if (window.contains(object.position) && meant(object, kinds)) ids.push_back(object.id);
  });
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace isobath
