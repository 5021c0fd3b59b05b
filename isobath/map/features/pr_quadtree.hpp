// PrQuadtree: a spatial index of point objects (PR quadtree: Oskard 1990, III-B, after Samet 1984; ledger S1-20, S1-21,
// S1-25).
//
// A block splits while it holds more than one point, so that any two points end in different leaves. Points that are
// closer than the smallest block share one (S1-20). Points are (north, east) of W in metres, inside the tree's square.
// An object has an id chosen by the caller and 32 bits of kinds by which searches filter. A search touches nothing but
// the tree (S1-25).
//
// Searches are exact; of several nearest, the one of the lowest id is found. They may run in several threads at once,
// but not during an edit. Deterministic.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <isobath/map/storage/square_blocks.hpp>
#include <optional>
#include <unordered_set>
#include <vector>

namespace isobath {

inline constexpr std::uint32_t kEveryKind = 0xffffffff;

class PrQuadtree {
 public:
  struct Object {
    std::uint64_t id = 0;
    Eigen::Vector2d position{0, 0};  ///< north, east; m
    std::uint32_t kinds = kEveryKind;
  };

  struct Found {
    std::uint64_t id = 0;
    double distance = 0;  ///< m
  };

  /// A square of `side_m` north and east of its south-west corner, whose smallest block is side_m / 2^levels.
  explicit PrQuadtree(const Eigen::Vector2d& south_west, double side_m, int levels = 32);

  TreeEdit insert(const Object& object);
  /// Number of internal nodes.
  [[nodiscard]] std::size_t internal_nodes() const { return blocks_.size(); }

  /// `point` must be finite and may lie outside the square. `kinds` as in `in_window`.
  [[nodiscard]] std::optional<Found> nearest(const Eigen::Vector2d& point, std::uint32_t kinds = kEveryKind,
                                             SearchEffort* effort = nullptr) const;
  /// All objects not farther than `radius_m`, nearest first, of equal distance by id.
  [[nodiscard]] std::vector<Found> within(const Eigen::Vector2d& point, double radius_m,
                                          std::uint32_t kinds = kEveryKind, SearchEffort* effort = nullptr) const;
  /// Ids of all objects in a rectangle of (north, east), edges included, ascending. An object matches if it has one of
  /// `kinds`; kEveryKind matches objects without any kind, too.
  [[nodiscard]] std::vector<std::uint64_t> in_window(const Eigen::AlignedBox2d& window,
                                                     std::uint32_t kinds = kEveryKind) const;

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffff;  ///< a leaf without object; else a leaf is slot << 1 | 1

  struct Stored {
    Eigen::Vector2d position{0, 0};
    std::uint64_t id = 0;
    std::uint32_t kinds = 0;
    std::uint32_t next = kEmpty;  ///< the leaf of the next object in the same bucket
  };
  static bool meant(const Stored& object, std::uint32_t kinds) {
    return kinds == kEveryKind || (object.kinds & kinds) != 0;
  }
  [[nodiscard]] const Stored& at(std::uint32_t leaf) const { return objects_[leaf >> 1]; }

  [[nodiscard]] std::uint32_t insert_in(std::uint32_t node, const SquareBlock& block, int depth, std::uint32_t leaf);
  template <class Bound, class Visit>
  void visit_nearest(const Eigen::Vector2d& point, std::uint32_t kinds, Bound bound, Visit visit,
                     SearchEffort* effort) const;
  template <class Visit>
  void visit_window(std::uint32_t node, const SquareBlock& block, const Eigen::AlignedBox2d& window, Visit visit) const;

  SquareBlock square_;
  int levels_;
  std::uint32_t root_ = kEmpty;
  SquareBlocks blocks_;
  std::vector<Stored> objects_;
  std::unordered_set<std::uint64_t> ids_;
};

}  // namespace isobath
