// ObstacleDetector: extracts obstacles from the body-fixed grid at the end of each scan (Ganesan 2015, 3.5,
// equation 3.21; ledger S6-28 to S6-30, S6-E19).
//
// A cell is detected if the expected number of obstacles in its 3 x 3 neighbourhood, the sum of p over the existing
// cells, is at least BodyGridConfig::threshold. Detected cells join into regions over sides and corners. The sum
// reaches one cell beyond the observed obstacle, so an outline includes only cells with evidence of their own: p at
// least threshold / 9 and at least half the largest p beside it. Each region is cut across its long axis until every
// piece is convex and tight: no cell of its hull is more than `slack_cells` from evidence. So the outline of an L or a
// ring does not include the water inside.
//
// An outline covers whole cells. `existence` is 1 - prod(1 - p) over the strongest 3 x 3 block alone, since
// neighbouring cells share their echoes and are not independent. Order: by range, then bearing.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/occupancy/obstacle.hpp>
#include <vector>

namespace isobath {

struct ObstacleDetectorConfig {
  int slack_cells = 1;
  int max_multiple = 3;              ///< largest order of multiples that are marked
  double multiple_tolerance = 0.05;  ///< as a share of the range
};

std::vector<Field> fields(ObstacleDetectorConfig& config);

/// The binary map of one scan and its obstacles. Cell (x, y) is in the grid's axes G, in which the vehicle's level body
/// frame has the given position and heading.
struct Detection {
  Time time;
  Pose X_WB;
  CartesianGrid cells;
  Eigen::Vector2d position;
  Angle heading;
  std::vector<std::uint8_t> detected;  ///< 1 where N >= threshold
  std::vector<Obstacle> obstacles;
  std::vector<std::uint8_t> free;  ///< 1 where BodyGrid::is_free
};

class ObstacleDetector {
 public:
  explicit ObstacleDetector(const ObstacleDetectorConfig& config = {}) : config_(config) {}

  [[nodiscard]] Detection detect(const BodyGrid& grid, Time time, const Pose& X_WB);

 private:
  void sum_neighbourhoods(const BodyGrid& grid);
  void mark_evidence(const CartesianGrid& cells, double threshold);
  void take_region(const BodyGrid& grid, std::size_t seed, std::vector<Obstacle>& out);
  void split(const BodyGrid& grid, std::vector<Cell>& piece, std::vector<Obstacle>& out);
  [[nodiscard]] bool tight(const CartesianGrid& cells, const Polygon& hull) const;
  [[nodiscard]] Obstacle describe(const BodyGrid& grid, const std::vector<Cell>& piece, const Polygon& hull) const;
  void relate(std::vector<Obstacle>& obstacles, double cell_m) const;

  ObstacleDetectorConfig config_;
  std::vector<double> p_;
  std::vector<double> column_;
  std::vector<double> sum_;
  std::vector<std::uint8_t> detected_;
  std::vector<std::uint8_t> evidence_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::size_t> queue_;
};

}  // namespace isobath
