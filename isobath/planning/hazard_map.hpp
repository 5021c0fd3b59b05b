// HazardMap: all that is in the way, as planners see it, in one plan frame P at one instant (Ganesan 2015, 5.2.2;
// ledger S6-44, S6-47, S6-50).
//
// Hazards come from the obstacles of the last scan, the memory of older ones, the chart and the fence; each is a convex
// outline with a margin of its own (its uncertainty), kept as it is: distances and checks of legs are in closed form,
// never sampled. An outline that is not convex counts as its convex hull. What no hazard covers is free, whether it was
// seen or not; whoever asks for the way must know how far that can be trusted.
//
// A leg that keeps exactly the clearance keeps it; one that touches (within 1e-9 m) is in conflict whatever the
// clearance. Ways that are asked for are finite.
//
// Frame P: any level frame, x and y in m; the caller's transforms (plan_frame.hpp) lead to it. Immutable once built.
// Cost with 500 outlines of 8 corners at most: 75 us to build, 0.05 us a leg that nothing is near to, 4 us a distance
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

enum class HazardKind : std::uint8_t { kSeen, kRemembered, kCharted, kFence, kInjected };
const char* to_text(HazardKind kind);

struct Hazard {
  Polygon outline;      ///< convex; one or two corners make a point or a segment
  double margin_m = 0;  ///< how far it may reach beyond the outline; below 0: so much of the clearance is not for it
  HazardKind kind = HazardKind::kSeen;
  std::uint32_t id = 0;  ///< the caller's
};

/// Where a way comes too near to a hazard.
struct Conflict {
  int leg = 0;            ///< from 0
  double along_m = 0;     ///< from the start of the way to where it first is too near
  double distance_m = 0;  ///< least distance of the leg to the hazard, its margin taken off; 0 or less: through it
  std::size_t hazard = 0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< of the hazard's outline, nearest to the leg
};

/// From p to a convex outline; below 0 inside, by how deep. The outline is not empty.
double signed_distance(const Polygon& convex, const Eigen::Vector2d& p);

/// The least distance of the leg from a to b to a convex outline, 0 where they meet, and the outline's place of it.
struct LegDistance {
  double distance_m = 0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
};
LegDistance leg_distance(const Polygon& convex, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

class HazardMap {
 public:
  /// Throws Error where an outline is empty, or outline or margin are not finite or over 1e7 m.
  explicit HazardMap(std::vector<Hazard> hazards);

  /// As given, but each outline in the positive sense and without corners that say nothing.
  [[nodiscard]] std::span<const Hazard> hazards() const { return hazards_; }
  /// What holds all hazards with their margins; empty without any.
  [[nodiscard]] Eigen::AlignedBox2d bounds() const { return tree_.bounds(); }
  /// From p to the nearest hazard, margins taken off: below 0 inside; infinite without hazards.
  [[nodiscard]] double distance(const Eigen::Vector2d& p) const;
  /// Of several as near, the first.
  [[nodiscard]] std::optional<std::size_t> nearest(const Eigen::Vector2d& p) const;
  /// The first hazard on whose very outline, not only within its margin, p lies.
  [[nodiscard]] std::optional<std::size_t> holding(const Eigen::Vector2d& p) const;
  /// Least distance of the leg to a hazard, margins taken off: -margin where it meets the outline.
  [[nodiscard]] double leg_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;
  /// Whether the leg keeps the clearance: no conflict on it.
  [[nodiscard]] bool leg_is_clear(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double clearance_m) const;
  /// The first leg, and on it the first place, where the way comes nearer than `clearance_m` to a hazard. One point is
  /// a leg without length.
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
