// VoxelBlocks: what one sensor has said of space, voxel by voxel, in blocks of 16 x 16 x 16 found by hashing.
//
// Evidence. A voxel holds the sum of the log-likelihood ratios ln P(reading | occupied) / P(reading | empty) that it
// was given (Horner et al. c. 2009, 4; ledger S5-15), in fixed point, 1/1024, kept within [least, most]. Zero is no
// evidence either way, which is not the same as never looked at: that reads as kUnseen. The prior is not in it (S5-29),
// so that sensors add up (VoxelMap). Whole numbers: while no bound is met, a sum depends neither on the order of its
// parts nor on who adds them.
//
// Layout. Within a block a column along z is contiguous (32 bytes, one vector), columns follow along y, then x. Blocks
// are taken from slabs of two megabytes and never move; a table of open addressing with half its places empty says
// where. Each block carries the revision of its own last change, so that a reader asks for what is new since it looked.
//
// Memory. A block that is changed stays in memory until somebody has it forgotten (keep_within) or written away
// (spill): then a shelf of a file holds it (voxel_file.hpp), and it comes back, bit for bit, when it is touched.
// Reading does not bring it back, so that a walk over all of a large map takes no more memory; the answers are the
// same. While there is a shelf, whatever reads or touches throws Error where the file is damaged or the disk fails.
//
// Cost (one core, bench/voxel_bench.cpp): 0.9 million rays of 187 voxels, 24 million random questions a second. One
// thread writes; while nobody writes, any number read.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <Eigen/Core>
#include <functional>
#include <isobath/map/voxel_evidence.hpp>
#include <memory>
#include <vector>

namespace isobath {

class VoxelShelf;

class VoxelBlocks {
 public:
  static constexpr int kSideLog2 = kBlockSideLog2, kSide = 1 << kSideLog2, kVolume = kBlockVolume;
  /// Indices beyond have no block: 8.4 million voxels from the origin, 2097 km at 0.25 m.
  static constexpr int kFarthest = 1 << 23;

  /// What there is of a block; good while the map lives and keeps it in memory.
  struct Block {
    VoxelIndex corner;  ///< the least voxel
    std::uint64_t revision = 0;
    LogOdds16* evidence = nullptr;  ///< kVolume of them
  };
  static int offset(const VoxelIndex& v) {
    constexpr int kMask = kSide - 1;
    return ((v.x() & kMask) << 2 * kSideLog2) | ((v.y() & kMask) << kSideLog2) | (v.z() & kMask);
  }

  /// Of the voxel at an offset, from the block's corner.
  static VoxelIndex place_of(int offset) {
    constexpr int kMask = kSide - 1;
    return {offset >> 2 * kSideLog2, offset >> kSideLog2 & kMask, offset & kMask};
  }

  explicit VoxelBlocks(const EvidenceBounds& bounds = {});

  [[nodiscard]] static bool holds(const VoxelIndex& v) { return v.maxCoeff() < kFarthest && v.minCoeff() > -kFarthest; }
  /// kUnseen where nothing was ever said. Of a voxel that the map `holds`, as for all that follow: the indices of
  /// others come round again.
  [[nodiscard]] LogOdds16 at(const VoxelIndex& v) const {
    const std::uint64_t key = key_of(v);
    const std::uint32_t slot = slot_of(key);
    if (slot != kNone) return evidence_of(slot)[offset(v)];
    return shelf_ == nullptr ? kUnseen : spilled_at(key, offset(v));
  }
  /// The evidence of the block of a voxel; null where memory holds none.
  [[nodiscard]] const LogOdds16* find(const VoxelIndex& v) const {
    const std::uint32_t slot = slot_of(key_of(v));
    return slot == kNone ? nullptr : evidence_of(slot);
  }
  /// The same to write to, made where there is none, and marked as changed in this revision.
  LogOdds16* touch(const VoxelIndex& v);
  /// One more piece of evidence.
  void add(const VoxelIndex& v, LogOdds16 more) {
    LogOdds16& e = touch(v)[offset(v)];
    e = sum(e, more);
  }
  /// What both say together, within the bounds.
  [[nodiscard]] LogOdds16 sum(LogOdds16 old, LogOdds16 more) const {
    const int total = (old == kUnseen ? 0 : old) + more;
    return static_cast<LogOdds16>(std::min<int>(std::max<int>(total, bounds_.least), bounds_.most));
  }

  /// Along a straight line of sight from `from` to `to` (voxels and fractions of them): `miss` for each voxel that it
  /// passes through before the one that holds `to` (six-connected: every voxel that the line meets), then `end` for
  /// that one. An `end` of zero leaves it as it is. Returns the voxels passed; nothing happens, and 0 is returned,
  /// where an end is not finite or too far off.
  std::int64_t insert_ray(const Eigen::Vector3d& from, const Eigen::Vector3d& to, LogOdds16 miss, LogOdds16 end);

  /// Blocks touched from now on carry this revision; none is 0.
  void begin(std::uint64_t revision) { revision_ = revision; }
  /// Those touched after a revision, and all with 0; in no order. Of a spilled one a copy, good while visited.
  void for_each(std::uint64_t after, const std::function<void(const Block&)>& visit) const;
  /// All that memory holds, in no order.
  void for_each_held(const std::function<void(const Block&)>& visit) const;
  /// The corners of those touched after a revision, without a look into the file.
  void corners_after(std::uint64_t after, std::vector<VoxelIndex>& corners) const;

  /// Brings all evidence nearer to none: times `kept`, in [0, 1], towards zero. What was seen stays seen.
  void fade(double kept);
  /// Moves by whole voxels what was said in the blocks touched after a revision. Where it comes to lie on what was not
  /// moved, both are true of that place, and add up.
  void move(const VoxelIndex& by, std::uint64_t after);
  /// Forgets the blocks that have no voxel in the box [least, most]; each is shown first. Returns how many.
  std::size_t keep_within(const VoxelIndex& least, const VoxelIndex& most,
                          const std::function<void(const Block&)>& leaving = {});
  void clear();

  /// From now on blocks can spill; those that the shelf holds are of the map. It must outlive this, and one of both
  /// must be empty.
  void spill_to(VoxelShelf& shelf);
  /// Takes blocks out of memory, all that `leaves` says at once or, with an Error, none. Returns how many.
  std::size_t spill(const std::function<bool(const Block&)>& leaves);
  /// Writes to the file what memory holds, and keeps it.
  void save() const;

  [[nodiscard]] std::size_t blocks() const { return used_ + spilled_; }
  [[nodiscard]] std::size_t spilled() const { return spilled_; }  ///< of these, in the file only
  [[nodiscard]] std::size_t bytes() const;                        ///< of memory
  [[nodiscard]] const EvidenceBounds& bounds() const { return bounds_; }

  /// A number for a block, 20 bits an axis, from any of its voxels; and its corner.
  [[nodiscard]] static std::uint64_t key_of(const VoxelIndex& v) {
    constexpr std::uint64_t kMask = (1u << 20) - 1;
    const auto part = [](int i) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(i >> kSideLog2)) & kMask;
    };
    return part(v.x()) << 40 | part(v.y()) << 20 | part(v.z());
  }
  [[nodiscard]] static VoxelIndex corner_of(std::uint64_t key) {
    const auto part = [&](int shift) {  // the sign stands in the highest of 20 bits
      return static_cast<int>(static_cast<std::uint32_t>(key >> shift) << 12) >> 12 << kSideLog2;
    };
    return {part(40), part(20), part(0)};
  }

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
  /// Takes blocks out of the shelf, where it holds them.
  void erase_spilled(const std::vector<std::uint64_t>& keys);
  /// Frees the places of those that `leaves` says.
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
