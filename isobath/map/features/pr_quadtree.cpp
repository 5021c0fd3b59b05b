#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/features/pr_quadtree.hpp>
#include <limits>

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

/// Visits the matching objects of all leaves within bound(), a squared distance that may shrink meanwhile.
template <class Bound, class Visit>
void PrQuadtree::visit_nearest(const Eigen::Vector2d& point, std::uint32_t kinds, Bound bound, Visit visit,
                               SearchEffort* effort) const {
  ISOBATH_ASSERT(point.allFinite());
  SearchEffort spent;
  const auto leaf = [&](std::uint32_t node) {
    for (; node != kEmpty; node = at(node).next) {
      if (!meant(at(node), kinds)) continue;
      ++spent.objects;
      visit(Found{at(node).id, (at(node).position - point).squaredNorm()});
    }
  };
  spent.nodes = BestFirstSearch(blocks_, point, bound, leaf).run(root_, square_);
  if (effort != nullptr) *effort = spent;
}

namespace {

bool nearer_object(const PrQuadtree::Found& a, const PrQuadtree::Found& b) {
  return a.distance < b.distance || (a.distance == b.distance && a.id < b.id);
}

}  // namespace

std::optional<PrQuadtree::Found> PrQuadtree::nearest(const Eigen::Vector2d& point, std::uint32_t kinds,
                                                     SearchEffort* effort) const {
  std::optional<Found> best;
  visit_nearest(
      point, kinds, [&] { return best ? best->distance : std::numeric_limits<double>::infinity(); },
      [&](const Found& found) {
        if (!best || nearer_object(found, *best)) best = found;
      },
      effort);
  if (best) best->distance = std::sqrt(best->distance);
  return best;
}

std::vector<PrQuadtree::Found> PrQuadtree::within(const Eigen::Vector2d& point, double radius_m, std::uint32_t kinds,
                                                  SearchEffort* effort) const {
  std::vector<Found> all;
  const double squared = radius_m * radius_m;
  visit_nearest(
      point, kinds, [&] { return squared; },
      [&](const Found& found) {
        if (found.distance <= squared) all.push_back(found);
      },
      effort);
  std::sort(all.begin(), all.end(), nearer_object);
  for (Found& found : all) found.distance = std::sqrt(found.distance);
  return all;
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
