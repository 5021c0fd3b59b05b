// RouteGrid: hazards laid out over cells for the search: which steps between neighbouring cell centres keep the
// clearance, and what they cost (Ganesan 2015, 5.2.2; ledger S6-44, S6-49, S6-50).
//
// exact(): a step is open where the whole segment between both centres keeps at least `reach_m` from every hazard,
// beyond the hazard's margin. A dilated convex outline meets each line through cell centres (rows, columns, both
// diagonals) in one interval, known in closed form: every step is decided exactly, however small a hazard, and no
// corner is cut. coarse(): the paper's map: a cell is blocked where its square comes within `reach_m` of a hazard (0:
// touches it). This enlarges an obstacle by up to a cell, depending on where it lies (S6-E17). A path through free
// centres is then half a cell or more from every hazard, provided that diagonal steps past a blocked cell are refused
// (S6-E18).
//
// A step costs its length times the mean of both cells' factors, at least 1 (GridSearch's ground). prefer_room sets
//   factor = 1 + weight max(0, 1 - d / band),  d: beyond the clearance, by a chamfer distance over cells
// so that a path keeps off by up to `band` where that costs less than `weight` of detour per metre. d is accurate to
// 8 % and a cell: a preference, not a promise.
//
// Cells are numbered row by row; columns count along x, rows along y.
#pragma once

#include <isobath/planning/grid_search.hpp>
#include <isobath/planning/hazard_map.hpp>

namespace isobath {

inline constexpr double kMaxRouteCells = 0x1p20;

struct RouteWindow {
  struct Extent {
    double cell_m = 1;
    double margin_m = 30;           ///< around start and goal
    double reach_m = 0;             ///< around hazards, beyond their margins
    Eigen::AlignedBox2d more = {};  ///< what matters beside hazards
  };
  /// The box of both ends with a margin, but no larger than the box of ends and hazards, which is all that can matter;
  /// `whole` says whether it is all of that. The start is the centre of a cell. Cells are larger where there would be
  /// more than kMaxRouteCells.
  static RouteWindow around(const Eigen::Vector2d& start, const Eigen::Vector2d& goal, const HazardMap& map,
                            const Extent& extent, bool& whole);

  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< centre of cell 0
  double cell_m = 1;
  std::int32_t columns = 1;
  std::int32_t rows = 1;

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  [[nodiscard]] Eigen::Vector2d centre(std::size_t cell) const {
    const auto width = static_cast<std::size_t>(columns);
    const std::size_t row = cell / width;
    return origin + cell_m * Eigen::Vector2d(static_cast<double>(cell % width), static_cast<double>(row));
  }
  /// The cell that contains p, if there is one.
  [[nodiscard]] std::optional<std::size_t> at(const Eigen::Vector2d& p) const;
};

class RouteGrid {
 public:
  static RouteGrid exact(const HazardMap& map, const RouteWindow& window, double reach_m);
  static RouteGrid coarse(const HazardMap& map, const RouteWindow& window, double reach_m, bool cut_corners);

  void prefer_room(double band_m, double weight);
  /// Adds `extra` to the factor at the centre of a circle, less towards its rim.
  void add_cost(const Eigen::Vector2d& centre, double radius_m, double extra);
  /// Closes all cells farther than `width_m` from a segment.
  void close_beyond(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width_m);
  /// Lets a vehicle that is too near to a hazard leave: opens steps from `start`, and on from blocked cells, that come
  /// nowhere nearer to a hazard than the start is. Blocked cells are expensive, so that the vehicle leaves soon.
  /// Reaches as far as `far_m`.
  void open_escape(const HazardMap& map, std::size_t start, double far_m);
  /// The same for coarse cells: frees the cell of the start (S6-50).
  void free_cell(std::size_t cell);

  [[nodiscard]] const RouteWindow& window() const { return window_; }
  /// Whether its centre is too near to a hazard.
  [[nodiscard]] bool blocked(std::size_t cell) const { return blocked_[cell] != 0; }
  [[nodiscard]] bool open(std::size_t cell, std::size_t step) const { return ((open_[cell] >> step) & 1) != 0; }
  /// The integral of the factor along a leg, by the cells under it.
  [[nodiscard]] double leg_cost(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;

  [[nodiscard]] bool enterable(std::size_t from, std::size_t /*to*/, std::size_t step) const {
    return open(from, step);
  }
  [[nodiscard]] static bool passable(std::size_t /*from*/, std::size_t /*step*/) { return true; }
  [[nodiscard]] double step_cost(std::size_t from, std::size_t to, std::size_t step) const {
    return window_.cell_m * step_length(step) * (factor_[from] + factor_[to]) / 2;
  }

 private:
  explicit RouteGrid(const RouteWindow& window);
  void rasterise(const Hazard& hazard, double reach_m);
  void close_lines(const Polygon& outline_in_cells, double reach_in_cells, std::size_t step);
  void block_touched(const Hazard& hazard, double reach_m);
  void link_free_cells(bool cut_corners);
  [[nodiscard]] std::optional<std::size_t> neighbour(std::size_t cell, std::size_t step) const;

  RouteWindow window_;
  std::vector<std::uint8_t> open_;  ///< one bit per step
  std::vector<std::uint8_t> blocked_;
  std::vector<double> factor_;
};

}  // namespace isobath
