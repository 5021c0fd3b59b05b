#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/features/pmr_quadtree.hpp>
#include <limits>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Found = PmrQuadtree::Found;

bool nearer(const Found& a, const Found& b) {
  return a.distance < b.distance || (a.distance == b.distance && a.id < b.id);
}

/// The slots that a search has visited: a hash table that starts on the stack, so that searches share no state.
class Seen {
 public:
  bool first_time(std::uint32_t slot) {
    if (2 * (count_ + 1) > size_) grow();
    const bool fresh = put(slot);
    count_ += fresh;
    return fresh;
  }

 private:
  bool put(std::uint32_t slot) {
    std::uint32_t* table = large_.empty() ? small_.data() : large_.data();
    for (std::size_t i = slot * 2654435761U;; ++i) {
      std::uint32_t& entry = table[i & (size_ - 1)];
      if (entry == slot + 1) return false;
      if (entry != 0) continue;
      entry = slot + 1;
      return true;
    }
  }
  void grow() {
    std::vector<std::uint32_t> old = large_.empty() ? std::vector(small_.begin(), small_.end()) : std::move(large_);
    size_ *= 4;
    large_.assign(size_, 0);
    for (const std::uint32_t entry : old) {
      if (entry != 0) put(entry - 1);
    }
  }

  std::size_t count_ = 0;
  std::size_t size_ = 64;
  std::array<std::uint32_t, 64> small_{};  ///< slot + 1
  std::vector<std::uint32_t> large_;
};

}  // namespace

PmrQuadtree::PmrQuadtree(const Vector2d& south_west, double side_m, int threshold, int levels)
    : square_{south_west.x(), south_west.y(), south_west.x() + side_m, south_west.y() + side_m},
      threshold_(static_cast<std::size_t>(threshold)),
      levels_(levels),
      slack_m_(64 * std::numeric_limits<double>::epsilon() * (south_west.lpNorm<Eigen::Infinity>() + side_m)) {
  ISOBATH_ASSERT(south_west.allFinite() && std::isfinite(side_m) && side_m > 0);
  ISOBATH_ASSERT(threshold >= 1 && levels >= 0 && levels <= 48);
}

// Separating axes: the block's own, and the normal of the segment. Rounding only ever adds a block.
bool PmrQuadtree::meets(const Placed& s, const SquareBlock& block) {
  if (std::max(s.a.x(), s.b.x()) < block.south || std::min(s.a.x(), s.b.x()) > block.north) return false;
  if (std::max(s.a.y(), s.b.y()) < block.west || std::min(s.a.y(), s.b.y()) > block.east) return false;
  const Vector2d d = s.b - s.a;
  const Vector2d centre(block.middle_north(), block.middle_east());
  const double off_line = std::abs(d.x() * (centre.y() - s.a.y()) - d.y() * (centre.x() - s.a.x()));
  const double reach =
      0.5 * ((block.north - block.south) * std::abs(d.y()) + (block.east - block.west) * std::abs(d.x()));
  const double largest = s.a.lpNorm<Eigen::Infinity>() + centre.lpNorm<Eigen::Infinity>();
  return off_line <= reach + 16 * std::numeric_limits<double>::epsilon() * largest * d.lpNorm<1>();
}

// Liang and Barsky 1984. An end inside the square stays as it is.
std::optional<PmrQuadtree::Placed> PmrQuadtree::inside(const Segment& s) const {
  if (!s.a.allFinite() || !s.b.allFinite()) return {};
  const Vector2d d = s.b - s.a;
  double first = 0;
  double last = 1;
  const auto cut = [&](double step, double room) {  // keeps the side where step * t <= room
    if (step == 0) return room >= 0;
    const double t = room / step;
    (step < 0 ? first : last) = step < 0 ? std::max(first, t) : std::min(last, t);
    return first <= last;
  };
  if (!cut(-d.x(), s.a.x() - square_.south) || !cut(d.x(), square_.north - s.a.x()) ||
      !cut(-d.y(), s.a.y() - square_.west) || !cut(d.y(), square_.east - s.a.y())) {
    return {};
  }
  const auto on_square = [&](const Vector2d& p) {
    return Vector2d(std::clamp(p.x(), square_.south, square_.north), std::clamp(p.y(), square_.west, square_.east));
  };
  return Placed{s.id, first == 0 ? s.a : on_square(s.a + first * d), last == 1 ? s.b : on_square(s.a + last * d)};
}

Found PmrQuadtree::foot_on(std::uint32_t slot, const Vector2d& point) const {
  const Placed& s = placed_[slot];
  const Vector2d d = s.b - s.a;
  const double squared_length = d.squaredNorm();
  const double t = squared_length > 0 ? (point - s.a).dot(d) / squared_length : 0;
  const Vector2d foot = t <= 0 ? s.a : t >= 1 ? s.b : Vector2d(s.a + t * d);
  return {s.id, foot, (foot - point).squaredNorm()};
}

TreeEdit PmrQuadtree::insert(const Segment& segment) {
  const std::optional<Placed> placed = inside(segment);
  if (!placed) return TreeEdit::kOutside;
  if (!ids_.insert(segment.id).second) return TreeEdit::kKnownId;
  ISOBATH_ASSERT(placed_.size() < 0x7fffffff);
  const auto slot = static_cast<std::uint32_t>(placed_.size());
  placed_.push_back(*placed);
  root_ = insert_in(root_, square_, 0, slot);
  return TreeEdit::kDone;
}

std::uint32_t PmrQuadtree::insert_in(std::uint32_t node, const SquareBlock& block, int depth, std::uint32_t slot) {
  if (!meets(placed_[slot], block)) return node;
  if (SquareBlocks::is_link(node)) {
    for (int q = 0; q < 4; ++q) {
      const std::uint32_t child = insert_in(blocks_[node][q], block.quadrant(q), depth + 1, slot);
      blocks_[node][q] = child;
    }
    return node;
  }
  const std::uint32_t leaf = with(node, slot);
  if (depth == levels_ || count(leaf) <= threshold_) return leaf;
  std::vector<std::uint32_t> slots;
  append_slots(leaf, slots);
  release_list(leaf);
  SquareBlocks::Block quadrants{kNone, kNone, kNone, kNone};
  for (int q = 0; q < 4; ++q) {  // splits once: the children are not split again
    const SquareBlock quadrant = block.quadrant(q);
    for (const std::uint32_t s : slots) {
      if (meets(placed_[s], quadrant)) quadrants[q] = with(quadrants[q], s);
    }
  }
  return blocks_.allocate(quadrants);
}

std::uint32_t PmrQuadtree::new_chunk(std::uint32_t slot, std::uint32_t next) {
  if (free_chunks_.empty()) {
    free_chunks_.push_back(static_cast<std::uint32_t>(chunks_.size()));
    chunks_.emplace_back();
  }
  const std::uint32_t index = free_chunks_.back();
  free_chunks_.pop_back();
  chunks_[index] = {1, next, {slot}};
  return index << 1 | 1U;
}

// Only the first chunk of a list may have a free slot.
std::uint32_t PmrQuadtree::with(std::uint32_t leaf, std::uint32_t slot) {
  if (leaf == kNone || chunks_[leaf >> 1].count == Chunk::kSlots) return new_chunk(slot, leaf);
  Chunk& chunk = chunks_[leaf >> 1];
  chunk.slots[chunk.count++] = slot;
  return leaf;
}

void PmrQuadtree::release_list(std::uint32_t leaf) {
  for (; leaf != kNone; leaf = chunks_[leaf >> 1].next) free_chunks_.push_back(leaf >> 1);
}

void PmrQuadtree::append_slots(std::uint32_t leaf, std::vector<std::uint32_t>& slots) const {
  for (; leaf != kNone; leaf = chunks_[leaf >> 1].next) {
    const Chunk& chunk = chunks_[leaf >> 1];
    slots.insert(slots.end(), chunk.slots.begin(), chunk.slots.begin() + chunk.count);
  }
}

std::size_t PmrQuadtree::count(std::uint32_t leaf) const {
  std::size_t sum = 0;
  for (; leaf != kNone; leaf = chunks_[leaf >> 1].next) sum += chunks_[leaf >> 1].count;
  return sum;
}

std::optional<Found> PmrQuadtree::nearest(const Vector2d& point, SearchEffort* effort) const {
  SearchEffort spent;
  Seen seen;
  std::optional<Found> best;
  double bound = std::numeric_limits<double>::infinity();
  const double slack = slack_m_ + 64 * std::numeric_limits<double>::epsilon() * point.lpNorm<Eigen::Infinity>();
  const auto leaf = [&](std::uint32_t list) {
    for (; list != kNone; list = chunks_[list >> 1].next) {
      const Chunk& chunk = chunks_[list >> 1];
      for (std::uint32_t i = 0; i < chunk.count; ++i) {
        if (!seen.first_time(chunk.slots[i])) continue;
        ++spent.objects;
        const Found found = foot_on(chunk.slots[i], point);
        if (best && !nearer(found, *best)) continue;
        best = found;
        const double reach = std::sqrt(found.distance) + slack;
        bound = reach * reach;
      }
    }
  };
  spent.nodes = BestFirstSearch(
                    blocks_, point, [&] { return bound; }, leaf)
                    .run(root_, square_);
  if (effort != nullptr) *effort = spent;
  if (best) best->distance = std::sqrt(best->distance);
  return best;
}

void PmrQuadtree::collect(std::uint32_t node, const SquareBlock& block, const Eigen::AlignedBox2d& window,
                          std::vector<std::uint32_t>& slots) const {
  if (node == kNone || !block.meets(window)) return;
  if (SquareBlocks::is_link(node)) {
    for (int q = 0; q < 4; ++q) collect(blocks_[node][q], block.quadrant(q), window, slots);
    return;
  }
  append_slots(node, slots);
}

std::vector<std::uint64_t> PmrQuadtree::in_window(const Eigen::AlignedBox2d& window) const {
  std::vector<std::uint32_t> slots;
  collect(root_, square_, window, slots);
  std::sort(slots.begin(), slots.end());
  slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
  const SquareBlock block{window.min().x(), window.min().y(), window.max().x(), window.max().y()};
  std::vector<std::uint64_t> ids;
  for (const std::uint32_t slot : slots) {
    if (meets(placed_[slot], block)) ids.push_back(placed_[slot].id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace isobath
