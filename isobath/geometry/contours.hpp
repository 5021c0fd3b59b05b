// Contour lines of a regular grid of heights or depths, by marching squares.
//
// The grid is row-major, NaN where nothing is known. Between neighbouring nodes the value is linear; a cell whose
// corners alternate (a saddle) is cut as the mean of its corners says. A cell with a NaN corner gives nothing: lines
// end at holes and at the border, and nowhere else. The pieces are linked to open lines and closed rings.
//
// What is promised: every point lies on an edge of the grid where the linear value is the level, so that planes are
// exact and a smooth surface is met to O(step^2); lines cross neither themselves nor those of other levels; a line
// printed with columns to the right and rows downwards has the higher values on its left. A node that equals the level
// counts as higher. The lines of a level come open ones first, each kind in the order of its first edge in memory.
// Cost: O(cells + points log points) a level; no state, any thread.
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
  bool closed = false;                  ///< a ring: the first point follows the last, and is not repeated
  std::vector<Eigen::Vector2d> points;  ///< in the plane of the frame; two or more, three or more in a ring
};

/// `values`: columns * rows. The lines come in the order of `levels`.
std::vector<ContourLine> contour_lines(const GridFrame& frame, std::span<const float> values,
                                       std::span<const double> levels);

/// The step of 1, 2 or 5 times a power of ten, at least 0.1, that divides the range into about `wanted` parts: between
/// 0.63 and 1.6 times as many, unless 0.1 is too coarse for that. 0.1 for a range that is empty.
double nice_step(double low, double high, double wanted = 10);

/// Multiples of nice_step strictly between low and high, the nearest double of each.
std::vector<double> contour_levels(double low, double high, double wanted = 10);

}  // namespace isobath
