// RouteGrid: hazards laid out over cells for the search: which steps between neighbouring cell centres keep the
// clearance, and what they cost (Ganesan 2015, 5.2.2; ledger S6-44, S6-49, S6-50).
//
// exact(): a step is open where the whole segment between both centres keeps at least `reach_m` from every hazard, its
// margin taken off. A dilated convex outline meets the lines through the cell centres (rows, columns, both diagonals)
// in one interval each, known in closed form: every step is decided exactly, however small a hazard, and no corner is
// cut. coarse(): the paper's map: a cell is blocked where its square comes within `reach_m` of a hazard (0: touches
// it), which makes obstacles larger by 0 to a cell, as it happens to lie (S6-E17); a way through free centres is then
// half a cell or more from every hazard, provided that diagonal steps past a blocked cell are refused (S6-E18).
//
// A step costs its length times the mean of both cells' factors, at least 1 (GridSearch's ground). prefer_room makes
//   factor = 1 + weight max(0, 1 - d / band),  d: beyond the clearance, by a chamfer distance over cells
// so that a way stands off as far as `band` where that costs less than `weight` of detour a metre. d is good to 8 % and
// a cell: it is a preference, no promise.
//
// Cells are numbered row by row; columns count along x, rows along y.
#pragma once

#include <isobath/planning/grid_search.hpp>
#include <isobath/planning/hazard_map.hpp>

namespace isobath {

inline constexpr double kMostRouteCells = 0x1p20;

struct RouteWindow {
  struct Extent {
    double cell_m = 1;
    double margin_m = 30;  ///< around start and goal
    double reach_m = 0;    ///< of hazards beyond their margins
  };
  /// The box of both ends with a margin, no larger than all that can matter, which is the box of ends and hazards;
  /// `whole` says whether it is all of that. The start is the centre of a cell. Above kMostRouteCells cells are larger.
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
  /// The cell that holds p, if one does.
  [[nodiscard]] std::optional<std::size_t> at(const Eigen::Vector2d& p) const;
};

class RouteGrid {
 public:
  static RouteGrid exact(const HazardMap& map, const RouteWindow& window, double reach_m);
  static RouteGrid coarse(const HazardMap& map, const RouteWindow& window, double reach_m, bool cut_corners);

  void prefer_room(double band_m, double weight);
  /// Lets a vehicle that stands too near leave: opens steps from `start`, and on from blocked cells, that come nowhere
  /// nearer to a hazard than the start is. Blocked cells cost dear, so that it leaves soon. Looks as far as `far_m`.
  void open_escape(const HazardMap& map, std::size_t start, double far_m);
  /// The same for coarse cells: the start's is freed (S6-50).
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
  std::vector<std::uint8_t> open_;  ///< a bit a step
  std::vector<std::uint8_t> blocked_;
  std::vector<double> factor_;
};

}  // namespace isobath
