#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/features/pr_quadtree.hpp>
#include <limits>

namespace isobath {
namespace {

using Found = PrQuadtree::Found;

struct Candidate {
  double squared_distance = std::numeric_limits<double>::infinity();
  std::uint64_t id = 0;
  Eigen::Vector2d position{0, 0};

  [[nodiscard]] bool before(const Candidate& other) const {
    return squared_distance < other.squared_distance || (squared_distance == other.squared_distance && id < other.id);
  }
  [[nodiscard]] Found found() const { return {id, position, std::sqrt(squared_distance)}; }
};

bool nearer(const Candidate& a, const Candidate& b) { return a.before(b); }

std::vector<Found> in_order(std::vector<Candidate>& candidates) {
  std::sort(candidates.begin(), candidates.end(), nearer);
  std::vector<Found> found;
  found.reserve(candidates.size());
  for (const Candidate& c : candidates) found.push_back(c.found());
  return found;
}

}  // namespace

PrQuadtree::PrQuadtree(const Eigen::Vector2d& south_west, double side_m, int levels)
    : square_{south_west.x(), south_west.y(), south_west.x() + side_m, south_west.y() + side_m}, levels_(levels) {
  ISOBATH_ASSERT(south_west.allFinite() && std::isfinite(side_m) && side_m > 0 && levels >= 0 && levels <= 48);
}

TreeEdit PrQuadtree::insert(const Object& object) {
  if (!square_.contains(object.position)) return TreeEdit::kOutside;
  if (slots_.contains(object.id)) return TreeEdit::kKnownId;
  if (free_.empty()) {
    ISOBATH_ASSERT(objects_.size() < 0x7fffffff);
    free_.push_back(static_cast<std::uint32_t>(objects_.size()));
    objects_.emplace_back();
  }
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  objects_[slot] = {object.position, object.id, object.kinds, kEmpty};
  slots_.emplace(object.id, slot);
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

TreeEdit PrQuadtree::erase(std::uint64_t id) {
  const auto known = slots_.find(id);
  if (known == slots_.end()) return TreeEdit::kUnknownId;
  root_ = erase_in(root_, square_, known->second << 1 | 1U);
  free_.push_back(known->second);
  slots_.erase(known);
  return TreeEdit::kDone;
}

std::uint32_t PrQuadtree::erase_in(std::uint32_t node, const SquareBlock& block, std::uint32_t leaf) {
  if (node == leaf) return at(leaf).next;
  if (!SquareBlocks::is_link(node)) {
    std::uint32_t before = node;
    while (at(before).next != leaf) before = at(before).next;
    objects_[before >> 1].next = at(leaf).next;
    return node;
  }
  const int q = block.quadrant_of(at(leaf).position);
  SquareBlocks::Block& quadrants = blocks_[node];
  quadrants[q] = erase_in(quadrants[q], block.quadrant(q), leaf);
  std::uint32_t only = kEmpty;
  for (const std::uint32_t child : quadrants) {
    if (child == kEmpty) continue;
    if (only != kEmpty || SquareBlocks::is_link(child) || at(child).next != kEmpty) return node;
    only = child;
  }
  blocks_.release(node);
  return only;
}

TreeEdit PrQuadtree::move(std::uint64_t id, const Eigen::Vector2d& position) {
  const auto known = slots_.find(id);
  if (known == slots_.end()) return TreeEdit::kUnknownId;
  if (!square_.contains(position)) return TreeEdit::kOutside;
  const std::uint32_t leaf = known->second << 1 | 1U;
  root_ = erase_in(root_, square_, leaf);
  objects_[known->second].position = position;
  objects_[known->second].next = kEmpty;
  root_ = insert_in(root_, square_, 0, leaf);
  return TreeEdit::kDone;
}

std::optional<PrQuadtree::Object> PrQuadtree::object(std::uint64_t id) const {
  const auto known = slots_.find(id);
  if (known == slots_.end()) return {};
  const Stored& stored = objects_[known->second];
  return Object{stored.id, stored.position, stored.kinds};
}

std::size_t PrQuadtree::bytes() const {
  return blocks_.in_use() * sizeof(SquareBlocks::Block) + objects_.size() * sizeof(Stored);
}

std::optional<Found> PrQuadtree::nearest(const Eigen::Vector2d& point, std::uint32_t kinds,
                                         SearchEffort* effort) const {
  SearchEffort spent;
  Candidate best;
  bool any = false;
  const auto leaf = [&](std::uint32_t in_bucket) {
    for (; in_bucket != kEmpty; in_bucket = at(in_bucket).next) {
      const Stored& object = at(in_bucket);
      if (!meant(object, kinds)) continue;
      ++spent.objects;
      const Candidate c{(object.position - point).squaredNorm(), object.id, object.position};
      if (!any || c.before(best)) best = c;
      any = true;
    }
  };
  spent.nodes = BestFirstSearch(
                    blocks_, point, [&] { return best.squared_distance; }, leaf)
                    .run(root_, square_);
  if (effort != nullptr) *effort = spent;
  return any ? std::optional(best.found()) : std::nullopt;
}

std::vector<Found> PrQuadtree::nearest(const Eigen::Vector2d& point, std::size_t count, std::uint32_t kinds) const {
  if (count == 0) return {};
  std::vector<Candidate> best;  // a heap, the farthest in front
  const auto bound = [&] {
    return best.size() < count ? std::numeric_limits<double>::infinity() : best.front().squared_distance;
  };
  const auto leaf = [&](std::uint32_t in_bucket) {
    for (; in_bucket != kEmpty; in_bucket = at(in_bucket).next) {
      const Stored& object = at(in_bucket);
      if (!meant(object, kinds)) continue;
      const Candidate c{(object.position - point).squaredNorm(), object.id, object.position};
      if (best.size() == count) {
        if (!c.before(best.front())) continue;
        std::pop_heap(best.begin(), best.end(), nearer);
        best.pop_back();
      }
      best.push_back(c);
      std::push_heap(best.begin(), best.end(), nearer);
    }
  };
  BestFirstSearch(blocks_, point, bound, leaf).run(root_, square_);
  return in_order(best);
}

template <class Visit>
void PrQuadtree::visit_within(std::uint32_t node, const SquareBlock& block, const Eigen::Vector2d& point,
                              double squared_radius, Visit visit) const {
  if (node == kEmpty || block.squared_distance(point) > squared_radius) return;
  if (SquareBlocks::is_link(node)) {
    for (int q = 0; q < 4; ++q) visit_within(blocks_[node][q], block.quadrant(q), point, squared_radius, visit);
    return;
  }
  for (; node != kEmpty; node = at(node).next) visit(at(node));
}

std::vector<Found> PrQuadtree::within(const Eigen::Vector2d& point, double radius_m, std::uint32_t kinds) const {
  if (!(radius_m >= 0)) return {};
  std::vector<Candidate> found;
  const double squared_radius = radius_m * radius_m;
  visit_within(root_, square_, point, squared_radius, [&](const Stored& object) {
    const double squared = (object.position - point).squaredNorm();
    if (squared <= squared_radius && meant(object, kinds)) found.push_back({squared, object.id, object.position});
  });
  return in_order(found);
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
