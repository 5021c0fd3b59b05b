// contour_lines: contour lines of a regular grid of heights or depths, by marching squares.
//
// The grid is row-major, NaN where the value is unknown. Between neighbouring nodes the value is linear. A cell whose
// corners alternate (a saddle) is cut according to the mean of its corners. A cell with a NaN corner has no lines:
// lines end at holes and at the border, and nowhere else. The pieces are linked to open lines and closed rings.
//
// Guarantees: every point lies on an edge of the grid where the linear value is the level, so that planes are exact and
// a smooth surface is met to O(step^2). Lines cross neither themselves nor lines of other levels. A line printed with
// columns to the right and rows downwards has the higher values on its left. A node that equals the level counts as
// higher. The open lines of a level come first, each kind in the order of its first edge in memory. Cost: O(cells +
// points log points) a level; no state, any thread.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace isobath {

/// Nodes of a grid in the plane: node (column, row) lies at first + column * per_column + row * per_row.
struct GridFrame {
  int columns = 0;
  int rows = 0;
  Eigen::Vector2d first{0, 0};
  Eigen::Vector2d per_column{1, 0};
  Eigen::Vector2d per_row{0, 1};
};

struct ContourLine {
  double level = 0;
  bool closed = false;                  ///< a ring: the first point follows the last and is not repeated
  std::vector<Eigen::Vector2d> points;  ///< in the plane of the frame; two or more, three or more in a ring
};

/// `values`: columns * rows. The lines come in the order of `levels`.
std::vector<ContourLine> contour_lines(const GridFrame& frame, std::span<const float> values,
                                       std::span<const double> levels);

/// The step of 1, 2 or 5 times a power of ten, at least 0.1, that divides the range into about `wanted` parts (0.63 to
/// 1.6 times as many, unless 0.1 is too coarse). 0.1 for an empty range.
double nice_step(double low, double high, double wanted = 10);

/// Multiples of nice_step strictly between low and high, the nearest double of each.
std::vector<double> contour_levels(double low, double high, double wanted = 10);

}  // namespace isobath
