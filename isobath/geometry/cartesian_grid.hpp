// CartesianGrid: the square cells of a plane grid. Cell (0, 0) has its low corner at the origin of the grid frame; cell
// (x, y) covers [x, x + 1) * cell_m by [y, y + 1) * cell_m. Cells are stored with y running fastest.
#pragma once

#include <cmath>
#include <cstddef>
#include <Eigen/Core>
#include <optional>

namespace isobath {

struct Cell {
  int x = 0;
  int y = 0;
  bool operator==(const Cell&) const = default;
};

struct CartesianGrid {
  int cells_x = 0;
  int cells_y = 0;
  double cell_m = 1;

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(cells_x) * cells_y; }
  [[nodiscard]] bool contains(Cell c) const { return c.x >= 0 && c.x < cells_x && c.y >= 0 && c.y < cells_y; }
  [[nodiscard]] std::size_t index(Cell c) const { return static_cast<std::size_t>(c.x) * cells_y + c.y; }
  [[nodiscard]] Cell cell(std::size_t index) const {
    return {static_cast<int>(index / static_cast<std::size_t>(cells_y)),
            static_cast<int>(index % static_cast<std::size_t>(cells_y))};
  }
  [[nodiscard]] Eigen::Vector2d centre(Cell c) const { return {(c.x + 0.5) * cell_m, (c.y + 0.5) * cell_m}; }
  [[nodiscard]] std::optional<Cell> cell_at(const Eigen::Vector2d& p) const {
    const double x = std::floor(p.x() / cell_m);
    const double y = std::floor(p.y() / cell_m);
    if (!(x >= 0 && x < cells_x && y >= 0 && y < cells_y)) return std::nullopt;
    return Cell{static_cast<int>(x), static_cast<int>(y)};
  }
};

}  // namespace isobath
