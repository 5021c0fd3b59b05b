// VoxelBlocks: the evidence of one sensor about space, voxel by voxel, in blocks of 16 x 16 x 16 found by hashing.
//
// Evidence. A voxel holds the sum of its log-likelihood ratios ln P(reading | occupied) / P(reading | empty) (Horner et
// al. c. 2009, 4; ledger S5-15), in fixed point, 1/1024, kept within [least, most]. Zero means no evidence either way;
// a voxel that was never observed reads as kUnseen. The prior is not included (S5-29), so that sensors add up
// (VoxelMap). The sums are whole numbers: while no bound is met, a sum depends neither on the order of its parts nor on
// the thread that adds them.
//
// Layout. Within a block a column along z is contiguous (32 bytes, one vector); columns follow along y, then x. Blocks
// come from slabs of two megabytes and never move; a table of open addressing, at most half full, locates them. Each
// block carries the revision of its last change, so that a reader can ask for changes since its last read.
//
// Memory. A changed block stays in memory until the caller makes it forgotten (keep_within) or written to a file
// (spill). Then a shelf of the file holds it (voxel_file.hpp), and it returns, bit for bit, when it is touched. Reading
// does not bring it back into memory, so that a walk over a large map needs no more memory; the results are the same.
// While there is a shelf, all functions that read or touch throw Error where the file is damaged or the disk fails.
//
// Cost (one core, bench/voxel_bench.cpp): 0.9 million rays of 187 voxels, 24 million random queries a second. One
// thread writes; while no thread writes, any number may read.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <Eigen/Core>
#include <functional>
#include <isobath/map/voxel/voxel_evidence.hpp>
#include <memory>
#include <vector>

namespace isobath {

class VoxelShelf;

class VoxelBlocks {
 public:
  static constexpr int kSideLog2 = kBlockSideLog2, kSide = 1 << kSideLog2, kVolume = kBlockVolume;
  /// Indices beyond this have no block: 8.4 million voxels from the origin, 2097 km at 0.25 m.
  static constexpr int kFarthest = 1 << 23;

  /// A view of a block; valid while the map lives and keeps the block in memory.
  struct Block {
    VoxelIndex corner;  ///< the lowest voxel
    std::uint64_t revision = 0;
    LogOdds16* evidence = nullptr;  ///< kVolume of them
  };
  static int offset(const VoxelIndex& v) {
    constexpr int kMask = kSide - 1;
    return ((v.x() & kMask) << 2 * kSideLog2) | ((v.y() & kMask) << kSideLog2) | (v.z() & kMask);
  }

  /// Position of the voxel at an offset, relative to the block's corner.
  static VoxelIndex place_of(int offset) {
    constexpr int kMask = kSide - 1;
    return {offset >> 2 * kSideLog2, offset >> kSideLog2 & kMask, offset & kMask};
  }

  explicit VoxelBlocks(const EvidenceBounds& bounds = {});

  [[nodiscard]] static bool holds(const VoxelIndex& v) { return v.maxCoeff() < kFarthest && v.minCoeff() > -kFarthest; }
  /// kUnseen where there is no evidence. The voxel must be one that the map `holds`, here and in all functions below:
  /// the indices of others wrap around.
  [[nodiscard]] LogOdds16 at(const VoxelIndex& v) const {
    const std::uint64_t key = key_of(v);
    const std::uint32_t slot = slot_of(key);
    if (slot != kNone) return evidence_of(slot)[offset(v)];
    return shelf_ == nullptr ? kUnseen : spilled_at(key, offset(v));
  }
  /// The evidence of the voxel's block; null if the block is not in memory.
  [[nodiscard]] const LogOdds16* find(const VoxelIndex& v) const {
    const std::uint32_t slot = slot_of(key_of(v));
    return slot == kNone ? nullptr : evidence_of(slot);
  }
  /// The same for writing: makes the block if there is none, and marks it as changed in this revision.
  LogOdds16* touch(const VoxelIndex& v);
  /// Adds a piece of evidence.
  void add(const VoxelIndex& v, LogOdds16 more) {
    LogOdds16& e = touch(v)[offset(v)];
    e = sum(e, more);
  }
  /// The sum of both within the bounds.
  [[nodiscard]] LogOdds16 sum(LogOdds16 old, LogOdds16 more) const {
    const int total = (old == kUnseen ? 0 : old) + more;
    return static_cast<LogOdds16>(std::min<int>(std::max<int>(total, bounds_.least), bounds_.most));
  }

  /// Adds evidence along a straight line of sight from `from` to `to` (in fractional voxels): `miss` to each voxel that
  /// the line passes before the one that holds `to` (six-connected: every voxel that the line meets), then `end` to
  /// that one. An `end` of zero leaves it unchanged. Returns the number of voxels passed. Does nothing and returns 0 if
  /// an end point is not finite or too far away.
  std::int64_t insert_ray(const Eigen::Vector3d& from, const Eigen::Vector3d& to, LogOdds16 miss, LogOdds16 end);

  /// Blocks touched from now on carry this revision, which must not be 0.
  void begin(std::uint64_t revision) { revision_ = revision; }
  /// Visits the blocks touched after a revision (0: all), in no order. For a spilled block it passes a copy, valid
  /// during the visit.
  void for_each(std::uint64_t after, const std::function<void(const Block&)>& visit) const;
  /// Visits all blocks in memory, in no order.
  void for_each_held(const std::function<void(const Block&)>& visit) const;
  /// The corners of the blocks touched after a revision, without reading the file.
  void corners_after(std::uint64_t after, std::vector<VoxelIndex>& corners) const;

  /// Moves the evidence of the blocks touched after a revision by whole voxels. Where it lands on evidence that did not
  /// move, the two add up.
  void move(const VoxelIndex& by, std::uint64_t after);
  /// Forgets the blocks that have no voxel in the box [least, most] and passes each to `leaving` first. Returns their
  /// number.
  std::size_t keep_within(const VoxelIndex& least, const VoxelIndex& most,
                          const std::function<void(const Block&)>& leaving = {});

  /// Allows blocks to spill; the blocks that the shelf holds become part of the map. The shelf must outlive this
  /// object, and one of the two must be empty.
  void spill_to(VoxelShelf& shelf);
  /// Moves all blocks for which `leaves` is true out of memory at once or, with an Error, none. Returns their number.
  std::size_t spill(const std::function<bool(const Block&)>& leaves);
  /// Writes the blocks in memory to the file, and keeps them in memory.
  void save() const;

  [[nodiscard]] std::size_t blocks() const { return used_ + spilled_; }
  [[nodiscard]] std::size_t spilled() const { return spilled_; }  ///< blocks in the file only
  [[nodiscard]] std::size_t bytes() const;                        ///< of memory
  [[nodiscard]] const EvidenceBounds& bounds() const { return bounds_; }

  /// A number for a block, 20 bits an axis, from any of its voxels; and the inverse, to its corner.
  [[nodiscard]] static std::uint64_t key_of(const VoxelIndex& v) {
    constexpr std::uint64_t kMask = (1u << 20) - 1;
    const auto part = [](int i) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(i >> kSideLog2)) & kMask;
    };
    return part(v.x()) << 40 | part(v.y()) << 20 | part(v.z());
  }
  [[nodiscard]] static VoxelIndex corner_of(std::uint64_t key) { return corner_of_block(key); }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  static constexpr int kSlabLog2 = 8;  // blocks in a slab: two megabytes, one large page
  struct Release {
    void operator()(LogOdds16* slab) const { std::free(slab); }
  };
  using Slab = std::unique_ptr<LogOdds16[], Release>;
  static Slab new_slab();

  static constexpr std::uint64_t kEmpty = std::numeric_limits<std::uint64_t>::max();
  struct Entry {
    std::uint64_t key = kEmpty;
    std::uint32_t slot = kNone;
  };

  [[nodiscard]] static std::size_t mixed(std::uint64_t key) {
    key *= 0x9E3779B97F4A7C15u;  // Fibonacci hashing: the high bits depend on all of the key
    return static_cast<std::size_t>(key >> 32);
  }
  [[nodiscard]] std::uint32_t slot_of(std::uint64_t key) const {
    for (std::size_t i = mixed(key) & mask_;; i = (i + 1) & mask_) {
      if (table_[i].key == key) return table_[i].slot;
      if (table_[i].key == kEmpty) return kNone;
    }
  }
  [[nodiscard]] LogOdds16* evidence_of(std::uint32_t slot) const {
    return slabs_[slot >> kSlabLog2].get() + (std::size_t{slot & ((1u << kSlabLog2) - 1)} << 3 * kSideLog2);
  }
  void grow(std::size_t places);
  void place(std::uint64_t key, std::uint32_t slot);
  [[nodiscard, gnu::cold]] LogOdds16 spilled_at(std::uint64_t key, int offset) const;
  void each_spilled(std::uint64_t after,
                    const std::function<void(std::uint64_t key, std::uint64_t revision)>& visit) const;
  /// Erases these blocks from the shelf, if it holds them.
  void erase_spilled(const std::vector<std::uint64_t>& keys);
  /// Frees the slots of the blocks for which `leaves` is true.
  void release(const std::function<bool(const Block&)>& leaves);

  EvidenceBounds bounds_;
  std::vector<Entry> table_;
  std::size_t mask_ = 0;
  std::vector<Slab> slabs_;
  std::vector<Block> blocks_;        ///< by slot
  std::vector<std::uint32_t> free_;  ///< slots, the next one last
  std::size_t used_ = 0;
  std::uint64_t revision_ = 1;
  VoxelShelf* shelf_ = nullptr;
  std::size_t spilled_ = 0;
};

}  // namespace isobath
