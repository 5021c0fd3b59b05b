// PmrQuadtree: a spatial index of line segments (pipelines, ravines, walls, wires) (PMR quadtree: Oskard 1990, III-B,
// after Nelson and Samet 1986; ledger S1-22, S1-23, S1-25).
//
// Every leaf lists the segments that cross it. A leaf that exceeds the threshold at an insertion splits once, and that
// insertion does not split its children again, however many segments they hold. The shape may depend on the order of
// insertions; the results of searches do not.
//
// Points are (north, east) of W in metres. The tree's map ends at its square: only the part of a segment inside the
// square is placed and measured (a segment that only touches the square's edge is inside).
//
// Searches test each segment once and are exact; of several nearest, the one of the lowest id is found. They may run in
// several threads at once, but not during an edit. Deterministic. Nearest of 100,000: 1.3 us
// (bench/quadtree_bench.cpp).
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <isobath/map/storage/square_blocks.hpp>
#include <optional>
#include <unordered_set>
#include <vector>

namespace isobath {

class PmrQuadtree {
 public:
  struct Segment {
    std::uint64_t id = 0;
    Eigen::Vector2d a{0, 0};  ///< north, east; m
    Eigen::Vector2d b{0, 0};
  };
  struct Found {
    std::uint64_t id = 0;
    Eigen::Vector2d foot{0, 0};  ///< the nearest point of the segment
    double distance = 0;         ///< m
  };

  /// A square of `side_m` north and east of its south-west corner; blocks of side_m / 2^levels do not split.
  explicit PmrQuadtree(const Eigen::Vector2d& south_west, double side_m, int threshold = 4, int levels = 24);

  TreeEdit insert(const Segment& segment);

  /// `point` must be finite and may lie outside the square.
  [[nodiscard]] std::optional<Found> nearest(const Eigen::Vector2d& point, SearchEffort* effort = nullptr) const;
  /// Ids of all segments that meet a rectangle of (north, east), edges included, ascending.
  [[nodiscard]] std::vector<std::uint64_t> in_window(const Eigen::AlignedBox2d& window) const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;  ///< an empty leaf; else a leaf is chunk << 1 | 1

  /// The part inside the square.
  struct Placed {
    std::uint64_t id = 0;
    Eigen::Vector2d a{0, 0};
    Eigen::Vector2d b{0, 0};
  };
  /// A piece of a leaf's list: 32 bytes; one is enough for most leaves.
  struct Chunk {
    static constexpr std::uint32_t kSlots = 6;
    std::uint32_t count = 0;
    std::uint32_t next = kNone;  ///< encoded as a leaf
    std::array<std::uint32_t, kSlots> slots{};
  };

  static bool meets(const Placed& segment, const SquareBlock& block);
  [[nodiscard]] std::optional<Placed> inside(const Segment& segment) const;
  [[nodiscard]] Found foot_on(std::uint32_t slot, const Eigen::Vector2d& point) const;  ///< distance squared

  [[nodiscard]] std::uint32_t insert_in(std::uint32_t node, const SquareBlock& block, int depth, std::uint32_t slot);
  [[nodiscard]] std::uint32_t with(std::uint32_t leaf, std::uint32_t slot);
  [[nodiscard]] std::uint32_t new_chunk(std::uint32_t slot, std::uint32_t next);
  void release_list(std::uint32_t leaf);
  void append_slots(std::uint32_t leaf, std::vector<std::uint32_t>& slots) const;
  [[nodiscard]] std::size_t count(std::uint32_t leaf) const;
  void collect(std::uint32_t node, const SquareBlock& block, const Eigen::AlignedBox2d& window,
               std::vector<std::uint32_t>& slots) const;

  SquareBlock square_;
  std::size_t threshold_;
  int levels_;
  double slack_m_;  ///< exceeds the shift of a foot point by rounding
  std::uint32_t root_ = kNone;
  SquareBlocks blocks_;
  std::vector<Chunk> chunks_;
  std::vector<std::uint32_t> free_chunks_;
  std::vector<Placed> placed_;
  std::unordered_set<std::uint64_t> ids_;
};

}  // namespace isobath
