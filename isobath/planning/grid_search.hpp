// GridSearch: A* over the cells of a rectangle with eight neighbours, in flat arrays (Ganesan 2015, algorithm 1,
// corrected; ledger S6-48; S1-42 uses it too).
//
// The algorithm as printed fails inside its loop and never opens the cells that it finds (S6-E09). Here, a neighbour
// that is new, or that is reached at lower cost, is opened with its cost and the step that led there. The search fails
// only when no cell is open, that is, when all reachable cells have been expanded. The path is rebuilt from the steps.
//
// The heuristic is the straight line over eight directions, cell_m (max + (sqrt 2 - 1) min). It is consistent as long
// as no step costs less than its length, which the ground guarantees. The path is then the cheapest, and costs are
// found in increasing order. Ties: smallest bound first, of equal ones the larger cost so far, then the smaller cell:
// the same path on every machine.
//
// A ground provides, for cells numbered row by row:
//   bool enterable(from, to, step)   whether the step may be possible; cheap, called first
//   bool passable(from, step)        whether it is possible; called only where it would be an improvement
//   double step_cost(from, to, step) at least the step's length, m
// Cost: about 0.1 us per expanded cell, with a ground of tables.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <queue>
#include <vector>

namespace isobath {

struct GridStep {
  std::int32_t column = 0;
  std::int32_t row = 0;
};
/// Straight steps first; the opposite of a step is two further, in its own half.
inline constexpr std::array<GridStep, 8> kGridSteps = {
    {{0, -1}, {1, 0}, {0, 1}, {-1, 0}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}};
inline constexpr std::size_t opposite(std::size_t step) { return step < 4 ? (step + 2) % 4 : 4 + (step + 2) % 4; }
/// In cells.
inline constexpr double step_length(std::size_t step) { return step < 4 ? 1 : std::numbers::sqrt2; }

enum class GridOutcome : std::uint8_t { kReached, kNoPath, kOutOfBudget };

template <class Ground>
class GridSearch {
 public:
  GridSearch(const Ground& ground, std::int32_t width, std::int32_t height, double cell_m)
      : ground_(ground), width_(width), height_(height), cell_m_(cell_m) {}

  GridOutcome run(std::size_t start, std::size_t goal, std::int64_t budget) {
    const auto size = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    cost_.assign(size, INFINITY);
    came_by_.assign(size, -1);
    closed_.assign(size, 0);
    start_ = start;
    goal_ = at(goal);
    open_ = {};
    cost_[start] = 0;
    open_.push({left(at(start)), 0, static_cast<std::uint32_t>(start)});
    while (!open_.empty()) {
      // 1. the most promising open cell
      const Open best = open_.top();
      open_.pop();
      if (closed_[best.cell] != 0) continue;  // by a cheaper path that was found since
      closed_[best.cell] = 1;
      if (best.cell == goal) return GridOutcome::kReached;
      if (expanded_ >= budget) return GridOutcome::kOutOfBudget;
      ++expanded_;
      // 2. its neighbours
      expand(best.cell);
    }
    return GridOutcome::kNoPath;  // 3. no cell is open: all reachable cells were expanded
  }

  [[nodiscard]] double cost(std::size_t cell) const { return cost_[cell]; }
  [[nodiscard]] std::int64_t expanded() const { return expanded_; }
  [[nodiscard]] std::int64_t queries() const { return queries_; }  ///< calls of `passable`
  [[nodiscard]] std::size_t step_to(std::size_t cell) const { return static_cast<std::uint8_t>(came_by_[cell]); }

  /// The cells from the start to a cell that was reached, both included.
  [[nodiscard]] std::vector<std::size_t> path_to(std::size_t cell) const {
    std::vector<std::size_t> cells = {cell};
    while (cell != start_) {
      const GridStep s = kGridSteps[step_to(cell)];
      cell = static_cast<std::size_t>(static_cast<std::int64_t>(cell) - std::int64_t{s.row} * width_ - s.column);
      cells.push_back(cell);
    }
    std::reverse(cells.begin(), cells.end());
    return cells;
  }

 private:
  static constexpr double kRounding = 1e-12;  ///< by which sums of the same steps in another order may differ
  struct Open {
    double bound;  ///< cost so far plus the minimum cost that is left
    float cost;    ///< so far; for ties only
    std::uint32_t cell;
  };
  struct Later {
    bool operator()(const Open& a, const Open& b) const {
      if (a.bound != b.bound) return a.bound > b.bound;
      if (a.cost != b.cost) return a.cost < b.cost;
      return a.cell > b.cell;
    }
  };

  [[nodiscard]] GridStep at(std::size_t cell) const {
    const auto width = static_cast<std::size_t>(width_);
    return {static_cast<std::int32_t>(cell % width), static_cast<std::int32_t>(cell / width)};
  }
  [[nodiscard]] double left(GridStep at) const {
    const double dx = std::abs(static_cast<double>(at.column) - goal_.column),
                 dy = std::abs(static_cast<double>(at.row) - goal_.row);
    return cell_m_ * (std::max(dx, dy) + (std::numbers::sqrt2 - 1) * std::min(dx, dy));
  }

  void expand(std::size_t from) {
    const GridStep here = at(from);
    const double so_far = cost_[from];
    for (std::size_t step = 0; step < kGridSteps.size(); ++step) {
      const GridStep next{here.column + kGridSteps[step].column, here.row + kGridSteps[step].row};
      if (next.column < 0 || next.column >= width_ || next.row < 0 || next.row >= height_) continue;
      const std::size_t cell =
          static_cast<std::size_t>(next.row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(next.column);
      if (closed_[cell] != 0 || !ground_.enterable(from, cell, step)) continue;
      const double total = so_far + ground_.step_cost(from, cell, step);
      if (total * (1 + kRounding) >= cost_[cell]) continue;
      ++queries_;
      if (!ground_.passable(from, step)) continue;
      cost_[cell] = total;
      came_by_[cell] = static_cast<std::int8_t>(step);
      open_.push({total + left(next), static_cast<float>(total), static_cast<std::uint32_t>(cell)});
    }
  }

  const Ground& ground_;
  std::int32_t width_, height_;
  double cell_m_;
  std::size_t start_ = 0;
  GridStep goal_;
  std::int64_t expanded_ = 0, queries_ = 0;
  std::vector<double> cost_;
  std::vector<std::int8_t> came_by_;
  std::vector<std::uint8_t> closed_;
  std::priority_queue<Open, std::vector<Open>, Later> open_;
};

}  // namespace isobath
