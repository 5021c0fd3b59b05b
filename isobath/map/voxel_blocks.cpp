#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/voxel_blocks.hpp>
#include <new>
#include <span>
#if __has_include(<sys/mman.h>)
#include <sys/mman.h>
#endif

namespace isobath {
namespace {

using Eigen::Vector3d;

/// Parts of a line's length, as whole numbers: what is compared and added at each step takes one cycle, not four.
using Share = std::int64_t;
constexpr double kWhole = 0x1p52;
constexpr double kNever = 0x1p61;

Share to_share(double t) { return static_cast<Share>(std::min(t * kWhole, kNever)); }

/// One axis of a walk from voxel to voxel.
struct Axis {
  Axis(double from, double to, int voxel) {
    const double way = to - from;
    step = way < 0 ? -1 : 1;
    const double length = std::abs(way);
    each = to_share(length > 0 ? 1 / length : kNever);
    next = to_share(length > 0 ? (way < 0 ? from - voxel : voxel + 1 - from) / length : kNever);
  }
  Share next, each;  ///< at which the next border is met, and from one to another
  int step;
};

}  // namespace

LogOdds16 to_evidence(double log_odds) {
  constexpr double kMost = std::numeric_limits<LogOdds16>::max();
  return static_cast<LogOdds16>(std::lround(std::clamp(log_odds / kEvidenceUnit, -kMost, kMost)));
}

VoxelBlocks::VoxelBlocks(const EvidenceBounds& bounds) : bounds_(bounds) {
  ISOBATH_ASSERT(bounds.least > kUnseen && bounds.least <= 0 && bounds.most >= 0);
  grow(1024);
}

// Blocks -------------------------------------------------------------------------------------------------------------

void VoxelBlocks::place(std::uint64_t key, std::uint32_t slot) {
  std::size_t i = mixed(key) & mask_;
  while (table_[i].key != kEmpty) i = (i + 1) & mask_;
  table_[i] = {key, slot};
}

void VoxelBlocks::grow(std::size_t places) {
  std::vector<Entry> old(places);
  old.swap(table_);
  mask_ = places - 1;
  for (const Entry& p : old) {
    if (p.key != kEmpty) place(p.key, p.slot);
  }
}

VoxelBlocks::Slab VoxelBlocks::new_slab() {
  constexpr std::size_t kBytes = sizeof(LogOdds16) << (kSlabLog2 + 3 * kSideLog2);
  Slab slab(static_cast<LogOdds16*>(std::aligned_alloc(kBytes, kBytes)));
  if (!slab) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  madvise(slab.get(), kBytes, MADV_HUGEPAGE);  // only a wish: a random voxel is then one miss, not two
#endif
  return slab;
}

LogOdds16* VoxelBlocks::touch(const VoxelIndex& v) {
  const std::uint64_t key = key_of(v);
  std::uint32_t slot = slot_of(key);
  if (slot == kNone) {
    ISOBATH_ASSERT(holds(v));
    if (free_.empty()) {
      slabs_.push_back(new_slab());
      const auto first = static_cast<std::uint32_t>(blocks_.size());
      blocks_.resize(blocks_.size() + (std::size_t{1} << kSlabLog2));
      for (auto i = static_cast<std::uint32_t>(blocks_.size()); i > first; --i) free_.push_back(i - 1);
    }
    if (2 * (used_ + 1) > table_.size()) grow(2 * table_.size());
    slot = free_.back();
    free_.pop_back();
    ++used_;
    place(key, slot);
    std::fill_n(evidence_of(slot), kVolume, kUnseen);
    blocks_[slot] = {v.unaryExpr([](int c) { return c & ~(kSide - 1); }), revision_, evidence_of(slot)};
  }
  blocks_[slot].revision = revision_;
  return evidence_of(slot);
}

void VoxelBlocks::for_each(std::uint64_t after, const std::function<void(const Block&)>& visit) const {
  for (const Entry& p : table_) {
    if (p.key != kEmpty && blocks_[p.slot].revision > after) visit(blocks_[p.slot]);
  }
}

std::size_t VoxelBlocks::keep_within(const VoxelIndex& least, const VoxelIndex& most,
                                     const std::function<void(const Block&)>& leaving) {
  std::vector<Entry> kept;
  const std::size_t before = used_;
  for (Entry& p : table_) {
    if (p.key == kEmpty) continue;
    const Block& b = blocks_[p.slot];
    const bool inside =
        ((b.corner.array() + kSide - 1) >= least.array()).all() && (b.corner.array() <= most.array()).all();
    if (inside) {
      kept.push_back(p);
    } else {
      if (leaving) leaving(b);
      free_.push_back(p.slot);
    }
    p = {};
  }
  for (const Entry& p : kept) place(p.key, p.slot);
  used_ = kept.size();
  return before - used_;
}

void VoxelBlocks::clear() {
  slabs_.clear();
  blocks_.clear();
  free_.clear();
  std::fill(table_.begin(), table_.end(), Entry{});
  used_ = 0;
}

std::size_t VoxelBlocks::bytes() const {
  return (slabs_.size() << (kSlabLog2 + 3 * kSideLog2)) * sizeof(LogOdds16) + blocks_.size() * sizeof(Block) +
         table_.size() * sizeof(Entry) + free_.capacity() * sizeof(std::uint32_t);
}

// LogOdds16 -----------------------------------------------------------------------------------------------------------

void VoxelBlocks::fade(double kept) {
  ISOBATH_ASSERT(kept >= 0 && kept <= 1);
  const auto share = static_cast<int>(std::lround(kept * 32768));
  for (const Entry& p : table_) {
    if (p.key == kEmpty) continue;
    Block& b = blocks_[p.slot];
    for (LogOdds16& e : std::span(b.evidence, kVolume)) {
      const int faded = e * share / 32768;  // towards zero
      e = e == kUnseen ? kUnseen : static_cast<LogOdds16>(faded);
    }
    b.revision = revision_;
  }
}

std::int64_t VoxelBlocks::insert_ray(const Vector3d& from, const Vector3d& to, LogOdds16 miss, LogOdds16 end) {
  const auto near = [](const Vector3d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < kFarthest - 1; };
  if (!near(from) || !near(to)) return 0;
  VoxelIndex at = floor_of(from);
  const VoxelIndex last = floor_of(to);
  const std::int64_t passed = (last - at).cast<std::int64_t>().cwiseAbs().sum();
  Axis x(from.x(), to.x(), at.x()), y(from.y(), to.y(), at.y()), z(from.z(), to.z(), at.z());

  // What is written lies in other lines than what comes next: each is asked for kAhead steps before it is needed.
  constexpr int kAhead = 32, kInside = kSide - 1;
  std::array<LogOdds16*, 2 * kAhead> met;
  const auto pass = [&](std::int64_t step) {
    LogOdds16& e = *met[static_cast<std::size_t>(step) % met.size()];
    e = sum(e, miss);
  };
  std::int64_t step = 0;
  while (step < passed) {
    LogOdds16* block = touch(at);
    int i = at.x() & kInside, j = at.y() & kInside, k = at.z() & kInside;
    at -= VoxelIndex(i, j, k);
    do {
      LogOdds16* e = block + ((i << 2 * kSideLog2) | (j << kSideLog2) | k);
      __builtin_prefetch(e, 1);
      met[static_cast<std::size_t>(step) % met.size()] = e;
      if (step >= kAhead) pass(step - kAhead);
      const Share step_x = -static_cast<Share>((x.next <= y.next) & (x.next <= z.next));  // all bits, or none
      const Share step_y = ~step_x & -static_cast<Share>(y.next <= z.next);
      const Share step_z = ~step_x & ~step_y;
      x.next += x.each & step_x;
      y.next += y.each & step_y;
      z.next += z.each & step_z;
      i += x.step & static_cast<int>(step_x);
      j += y.step & static_cast<int>(step_y);
      k += z.step & static_cast<int>(step_z);
    } while (++step < passed && ((i | j | k) & ~kInside) == 0);
    at += VoxelIndex(i, j, k);
  }
  for (std::int64_t s = std::max<std::int64_t>(0, passed - kAhead); s < passed; ++s) pass(s);
  if (end != 0) add(last, end);
  return passed;
}

}  // namespace isobath
