// ObstacleDetector: from occupancy to convex outlines, at the end of each scan (Ganesan 2015, 3.5; ledger S6-28 to S6-30).
//
// 1. Expected number of occupied cells in the 3 x 3 block about each cell, N = sum p; detected where N >= threshold (S6-28,
//    S6-E19). At the border of the grid the block has the cells that exist.
// 2. Regions of detected cells that touch, also at corners.
// 3. Outlines hug the evidence. The sum spreads a target by a cell on each side, so outlines are drawn about the cells with
//    p of at least threshold / 9, and at least half the region's highest p. (A block that reaches the threshold holds such a
//    cell; S6-24 keeps the prior below it, so unseen water never draws an outline.)
// 4. A region whose convex hull would swallow much that is not part of it (a wall with a corner, a ring) is halved across
//    its long axis until every piece is tight.
// 5. Existence: the probability that at least one cell of the piece's fullest block is occupied, cells independent.
// 6. Seen from the vehicle: what hides what, and what stands at a multiple of the range of what hides it.
//
// Outlines are in L. Deterministic: cells are visited in the order of their storage.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/map/body_grid.hpp>
#include <isobath/map/obstacle.hpp>
#include <vector>

namespace isobath {

struct ObstacleDetectorConfig {
  double threshold = 0.8;          ///< expected obstacles in the block
  double tightness = 0.3;          ///< share of a hull that may be foreign to its region
  double multiple_tolerance = 0.05;  ///< of the range, for second and third returns
};
std::vector<Field> fields(ObstacleDetectorConfig& config);

class ObstacleDetector {
 public:
  explicit ObstacleDetector(const ObstacleDetectorConfig& config) : config_(config) {}

  /// Nearest first. `first_ping` is the time that the grid's evidence counts from.
  const std::vector<Obstacle>& detect(const BodyGrid& grid, Time first_ping = {});

  /// N of each cell, and where it reached the threshold, as of the last `detect` (S6-28, S6-29).
  [[nodiscard]] const std::vector<double>& expected_count() const { return count_; }
  [[nodiscard]] const std::vector<std::uint8_t>& detected() const { return detected_; }

 private:
  using Cells = std::vector<std::size_t>;
  void sum_blocks();
  [[nodiscard]] Cells region_from(std::size_t seed);
  void outline_region(const Cells& region);
  void split(Cells evidence);
  [[nodiscard]] bool tight(const Polygon& hull) const;
  [[nodiscard]] Obstacle describe(const Polygon& hull, const Cells& evidence) const;

  ObstacleDetectorConfig config_;
  const BodyGrid* grid_ = nullptr;  ///< during `detect`
  CartesianGrid cells_;
  Time first_ping_;
  std::vector<double> probability_;
  std::vector<double> count_;
  std::vector<std::uint8_t> detected_;
  std::vector<std::uint8_t> visited_;
  std::vector<std::uint8_t> own_;  ///< cells of the region at hand
  std::vector<Obstacle> obstacles_;
};

/// Sets `behind` and `possible_multiple` of obstacles that are sorted by range (design, section 6).
void mark_hidden(std::vector<Obstacle>& obstacles, double multiple_tolerance);

}  // namespace isobath
