#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/voxel/voxel_blocks.hpp>
#include <isobath/map/voxel/voxel_file.hpp>
#include <new>
#include <span>
#if __has_include(<sys/mman.h>)
#include <sys/mman.h>
#endif

namespace isobath {
namespace {

using Eigen::Vector3d;

/// Parts of a line's length as whole numbers: a comparison and an addition per step take one cycle, not four.
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
  Share next, each;  ///< of the next border, and between two borders
  int step;
};

}  // namespace

LogOdds16 to_evidence(double log_odds) {
  constexpr double kMax = std::numeric_limits<LogOdds16>::max();
  return static_cast<LogOdds16>(std::lround(std::clamp(log_odds / kEvidenceUnit, -kMax, kMax)));
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
  madvise(slab.get(), kBytes, MADV_HUGEPAGE);  // a hint: a random voxel then costs one miss, not two
#endif
  return slab;
}

LogOdds16* VoxelBlocks::touch(const VoxelIndex& v) {
  const std::uint64_t key = key_of(v);
  std::uint32_t slot = slot_of(key);
  if (slot == kNone) {
    ISOBATH_ASSERT(holds(v));
    const bool back = shelf_ && shelf_->holds(key);
    if (free_.empty()) {
      slabs_.push_back(new_slab());
      const auto first = static_cast<std::uint32_t>(blocks_.size());
      blocks_.resize(blocks_.size() + (std::size_t{1} << kSlabLog2));
      for (auto i = static_cast<std::uint32_t>(blocks_.size()); i > first; --i) free_.push_back(i - 1);
    }
    if (2 * (used_ + 1) > table_.size()) grow(2 * table_.size());
    slot = free_.back();
    if (back) {
      shelf_->read(key, {evidence_of(slot), kVolume});  // if it fails, nothing has changed
      --spilled_;
    } else {
      std::fill_n(evidence_of(slot), kVolume, kUnseen);
    }
    free_.pop_back();
    ++used_;
    place(key, slot);
    blocks_[slot] = {v.unaryExpr([](int c) { return c & ~(kSide - 1); }), revision_, evidence_of(slot)};
  }
  blocks_[slot].revision = revision_;
  return evidence_of(slot);
}

void VoxelBlocks::for_each(std::uint64_t after, const std::function<void(const Block&)>& visit) const {
  for (const Entry& p : table_) {
    if (p.key != kEmpty && blocks_[p.slot].revision > after) visit(blocks_[p.slot]);
  }
  if (spilled_ == 0) return;
  std::vector<LogOdds16> copy(kVolume);
  each_spilled(after, [&](std::uint64_t key, std::uint64_t revision) {
    shelf_->read(key, copy);
    visit({corner_of(key), revision, copy.data()});
  });
}

void VoxelBlocks::for_each_held(const std::function<void(const Block&)>& visit) const {
  for (const Entry& p : table_) {
    if (p.key != kEmpty) visit(blocks_[p.slot]);
  }
}

void VoxelBlocks::corners_after(std::uint64_t after, std::vector<VoxelIndex>& corners) const {
  for (const Entry& p : table_) {
    if (p.key != kEmpty && blocks_[p.slot].revision > after) corners.push_back(blocks_[p.slot].corner);
  }
  each_spilled(after, [&](std::uint64_t key, std::uint64_t) { corners.push_back(corner_of(key)); });
}

void VoxelBlocks::release(const std::function<bool(const Block&)>& leaves) {
  std::vector<Entry> kept;
  for (Entry& p : table_) {
    if (p.key == kEmpty) continue;
    if (leaves(blocks_[p.slot])) {
      free_.push_back(p.slot);
    } else {
      kept.push_back(p);
    }
    p = {};
  }
  for (const Entry& p : kept) place(p.key, p.slot);
  used_ = kept.size();
}

std::size_t VoxelBlocks::keep_within(const VoxelIndex& least, const VoxelIndex& most,
                                     const std::function<void(const Block&)>& leaving) {
  const auto leaves = [&](const Block& b) {
    return ((b.corner.array() + kSide - 1) < least.array()).any() || (b.corner.array() > most.array()).any();
  };
  const std::size_t before = blocks();
  if (leaving) {
    for_each(0, [&](const Block& b) {
      if (leaves(b)) leaving(b);
    });
  }
  if (shelf_) {
    std::vector<std::uint64_t> gone;
    for (const auto& stored : shelf_->revisions()) {
      if (leaves({corner_of(stored.first), 0, nullptr})) gone.push_back(stored.first);
    }
    erase_spilled(gone);
  }
  release(leaves);
  return before - blocks();
}

void VoxelBlocks::erase_spilled(const std::vector<std::uint64_t>& keys) {
  const auto spilled =
      std::count_if(keys.begin(), keys.end(), [&](std::uint64_t key) { return slot_of(key) == kNone; });
  shelf_->erase(keys);
  spilled_ -= static_cast<std::size_t>(spilled);
}

void VoxelBlocks::move(const VoxelIndex& by, std::uint64_t after) {
  std::vector<VoxelIndex> corners;
  std::vector<LogOdds16> evidence;
  for_each(after, [&](const Block& b) {
    corners.push_back(b.corner);
    evidence.insert(evidence.end(), b.evidence, b.evidence + kVolume);
  });
  if (shelf_) {
    std::vector<std::uint64_t> stored;
    for (const VoxelIndex& corner : corners) {
      if (const std::uint64_t key = key_of(corner); shelf_->holds(key)) stored.push_back(key);
    }
    erase_spilled(stored);
  }
  release([&](const Block& b) { return b.revision > after; });
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const VoxelIndex to = corners[n] + by;
    if (!holds(to) || !holds(to + VoxelIndex::Constant(kSide))) continue;  // beyond the limits of every map
    const VoxelIndex first = place_of(offset(to));                         // the block now overlaps up to eight blocks
    std::array<LogOdds16*, 8> parts{};
    for (int i = 0; i < kVolume;) {
      const VoxelIndex at = first + place_of(i), part = at / kSide;
      const int end = i + std::min(kSide - (i & (kSide - 1)), kSide - (at.z() & (kSide - 1)));
      const std::span run(evidence.data() + n * kVolume + static_cast<std::size_t>(i),
                          evidence.data() + n * kVolume + static_cast<std::size_t>(end));
      if (std::any_of(run.begin(), run.end(), [](LogOdds16 e) { return e != kUnseen; })) {
        LogOdds16*& block = parts[static_cast<std::size_t>(part.dot(VoxelIndex(4, 2, 1)))];
        if (!block) block = touch(to + place_of(i));
        LogOdds16* there = block + offset(at);
        for (const LogOdds16 e : run) {
          if (e != kUnseen) *there = sum(*there, e);
          ++there;
        }
      }
      i = end;
    }
  }
}

// The file -----------------------------------------------------------------------------------------------------------

void VoxelBlocks::spill_to(VoxelShelf& shelf) {
  ISOBATH_ASSERT(used_ == 0 || shelf.revisions().empty());
  shelf_ = &shelf;
  spilled_ = shelf.revisions().size();
}

std::size_t VoxelBlocks::spill(const std::function<bool(const Block&)>& leaves) {
  ISOBATH_ASSERT(shelf_);
  std::vector<VoxelShelf::Block> leaving;
  for_each_held([&](const Block& b) {
    if (leaves(b)) leaving.push_back({key_of(b.corner), b.revision, b.evidence});
  });
  if (leaving.empty()) return 0;
  shelf_->write(leaving);
  release(leaves);
  spilled_ += leaving.size();
  return leaving.size();
}

void VoxelBlocks::save() const {
  ISOBATH_ASSERT(shelf_);
  std::vector<VoxelShelf::Block> all;
  for_each_held([&](const Block& b) { all.push_back({key_of(b.corner), b.revision, b.evidence}); });
  shelf_->write(all);
}

LogOdds16 VoxelBlocks::spilled_at(std::uint64_t key, int offset) const { return shelf_->at(key, offset); }

void VoxelBlocks::each_spilled(std::uint64_t after,
                               const std::function<void(std::uint64_t key, std::uint64_t revision)>& visit) const {
  if (spilled_ == 0) return;
  for (const auto& [key, revision] : shelf_->revisions()) {
    if (revision > after && slot_of(key) == kNone) visit(key, revision);
  }
}

std::size_t VoxelBlocks::bytes() const {
  return (slabs_.size() << (kSlabLog2 + 3 * kSideLog2)) * sizeof(LogOdds16) + blocks_.size() * sizeof(Block) +
         table_.size() * sizeof(Entry) + free_.capacity() * sizeof(std::uint32_t) + (shelf_ ? shelf_->bytes() : 0);
}

// Evidence -----------------------------------------------------------------------------------------------------------

std::int64_t VoxelBlocks::insert_ray(const Vector3d& from, const Vector3d& to, LogOdds16 miss, LogOdds16 end) {
  const auto near = [](const Vector3d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < kFarthest - 1; };
  if (!near(from) || !near(to)) return 0;
  VoxelIndex at = floor_of(from);
  const VoxelIndex last = floor_of(to);
  const std::int64_t passed = (last - at).cast<std::int64_t>().cwiseAbs().sum();
  Axis x(from.x(), to.x(), at.x()), y(from.y(), to.y(), at.y()), z(from.z(), to.z(), at.z());

  // Consecutive voxels lie in different cache lines: each line is prefetched kAhead steps before it is written.
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
