// HazardMap: all that is in the way, as planners see it, in one plan frame P at one instant (Ganesan 2015, 5.2.2;
// ledger S6-44, S6-47, S6-50).
//
// Hazards come from the obstacles of the last scan, the memory of older ones, the chart and the fence; each is a convex
// outline with a margin of its own (its uncertainty), kept as it is: checks against legs are exact, not sampled. For
// the search they are laid out over cells, each blocked where a vehicle at its centre would come nearer to a hazard
// than the clearance. What no hazard covers is free, whether it was seen or not; whoever asks for the way must know how
// far that can be trusted.
//
// Frame P: any level frame, x and y in m; the caller's transforms (S6-45, S6-46) lead to it. Immutable once built.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/geometry/polygon.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

enum class HazardKind : std::uint8_t { kSeen, kRemembered, kCharted, kFence, kInjected };
const char* to_text(HazardKind kind);

struct Hazard {
  Polygon outline;      ///< convex; one or two corners make a point or a segment
  double margin_m = 0;  ///< how far it may reach beyond the outline
  HazardKind kind = HazardKind::kSeen;
  std::uint32_t id = 0;  ///< the caller's
};

/// Where a way comes too near to a hazard.
struct Conflict {
  int leg = 0;            ///< from 0
  double along_m = 0;     ///< from the start of the way to where it first is too near
  double distance_m = 0;  ///< least distance of the leg to the hazard, its margin taken off; 0 or less: through it
  std::size_t hazard = 0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< of the hazard, nearest to the leg
};

class HazardMap {
 public:
  explicit HazardMap(std::vector<Hazard> hazards);

  [[nodiscard]] std::span<const Hazard> hazards() const { return hazards_; }
  /// From p to the nearest hazard, margins taken off: below 0 inside; infinite without hazards.
  [[nodiscard]] double distance(const Eigen::Vector2d& p) const;
  [[nodiscard]] std::optional<std::size_t> nearest(const Eigen::Vector2d& p) const;
  /// The first leg, and on it the first place, where the way comes nearer than `clearance_m` to a hazard.
  [[nodiscard]] std::optional<Conflict> conflict(std::span<const Eigen::Vector2d> way, double clearance_m) const;

 private:
  std::vector<Hazard> hazards_;
};

}  // namespace isobath
