// HazardMap: all hazards that planners must avoid, in one plan frame P at one instant (Ganesan 2015, 5.2.2; ledger
// S6-44, S6-47, S6-50).
//
// Hazards come from the obstacles of the last scan, the memory of older ones, the chart and the fence. Each is a convex
// outline with a margin of its own (its uncertainty), kept as it is: distances and checks of legs are in closed form,
// never sampled. An outline that is not convex counts as its convex hull. Water that no hazard covers is free, whether
// it was seen or not; the caller must know how far that can be trusted.
//
// A leg that keeps exactly the clearance is clear; one that touches (within 1e-9 m) is in conflict whatever the
// clearance. Paths that are checked must be finite.
//
// Frame P: any level frame, x and y in m; the caller transforms into it (plan_frame.hpp). Immutable once built. Cost
// with 500 outlines of at most 8 corners: 75 us to build, 0.05 us for a leg without near hazards, 4 us for the distance
// of a leg.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/planning/box_tree.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

enum class HazardKind : std::uint8_t {
  kSeen,
  kRemembered,
  kCharted,
  kMapped,
  kVoxels,
  kFence,
  kInjected,
  kMoving,
  kVehicle,
  kBlocked  ///< a passage that a vehicle of the group waited for in vain
};
const char* to_text(HazardKind kind);

struct Hazard {
  Polygon outline;      ///< convex; one or two corners make a point or a segment
  double margin_m = 0;  ///< how far it may reach beyond the outline; below 0: its clearance is smaller by this much
  HazardKind kind = HazardKind::kSeen;
  std::uint32_t id = 0;  ///< chosen by the caller
  int obstacle = 0;      ///< Obstacle::number of the obstacle that it is a piece of; 0: it has none
  bool operator==(const Hazard&) const = default;
};

/// Where a path comes too near to a hazard.
struct Conflict {
  int leg = 0;            ///< from 0
  double along_m = 0;     ///< from the start of the path to where it first is too near
  double distance_m = 0;  ///< minimum distance of the leg to the hazard, less its margin; 0 or less: through it
  std::size_t hazard = 0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< on the hazard's outline, nearest to the leg
};

/// Distance from p to a convex outline; inside it, minus how deep. The outline must not be empty.
double signed_distance(const Polygon& convex, const Eigen::Vector2d& p);

/// Minimum distance of the leg from a to b to a convex outline, 0 where they meet, and its place on the outline.
struct LegDistance {
  double distance_m = 0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
};
LegDistance leg_distance(const Polygon& convex, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

class HazardMap {
 public:
  /// Throws Error where an outline is empty, or an outline or a margin is not finite or beyond 1e7 m.
  explicit HazardMap(std::vector<Hazard> hazards);

  /// As given, but each outline in the positive sense and without redundant corners.
  [[nodiscard]] std::span<const Hazard> hazards() const { return hazards_; }
  /// Bounding box of all hazards with their margins; empty without any.
  [[nodiscard]] Eigen::AlignedBox2d bounds() const { return tree_.bounds(); }
  /// From p to the nearest hazard, less its margin: below 0 inside; infinite without hazards.
  [[nodiscard]] double distance(const Eigen::Vector2d& p) const;
  /// The nearest hazard; of several as near, the first.
  [[nodiscard]] std::optional<std::size_t> nearest(const Eigen::Vector2d& p) const;
  /// The first hazard whose outline, not only whose margin, contains p.
  [[nodiscard]] std::optional<std::size_t> holding(const Eigen::Vector2d& p) const;
  /// Minimum distance of the leg to a hazard, less its margin: -margin where it meets the outline.
  [[nodiscard]] double leg_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;
  /// Whether the leg keeps the clearance: no conflict on it.
  [[nodiscard]] bool leg_is_clear(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double clearance_m) const;
  /// The first leg, and the first place on it, where the path comes nearer than `clearance_m` to a hazard. A single
  /// point is a leg without length.
  [[nodiscard]] std::optional<Conflict> conflict(std::span<const Eigen::Vector2d> way, double clearance_m) const;

 private:
  struct Near {
    double distance_m;
    std::size_t hazard;
  };
  [[nodiscard]] std::optional<Near> near(const Eigen::Vector2d& p) const;
  [[nodiscard]] std::optional<Conflict> leg_conflict(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                                     double clearance_m) const;

  std::vector<Hazard> hazards_;
  BoxTree tree_;  ///< of outlines with their margins
};

}  // namespace isobath
