#include <algorithm>
#include <cmath>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/route_grid.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr int kAround = 3;             // cells that a window adds around all that matters
constexpr double kTouch = 1e-9;        // m
constexpr double kEscapeFactor = 4;    // extra cost of a metre that is too near
constexpr double kShut = 1e6;          // factor of a cell that no path may cross
constexpr std::uint16_t kFar = 30000;  // thirds of a cell

/// The lines through cell centres along one step, in units of cells: line m holds the centres (column, row) =
/// first(m) + k step. A point lies `off` lines and `along` steps from centre k = 0 of line 0, apart from shift(m).
struct Lines {
  GridStep step;
  Vector2d u, n;
  double length;   ///< of a step
  double spacing;  ///< of lines

  explicit Lines(std::size_t number) : step(kGridSteps[number]), length(step_length(number)), spacing(1 / length) {
    u = Vector2d(step.column, step.row) / length;
    n = {-u.y(), u.x()};
  }
  [[nodiscard]] bool diagonal() const { return step.column != 0 && step.row != 0; }
  [[nodiscard]] GridStep first(std::int32_t m) const { return step.column == 0 ? GridStep{-m, 0} : GridStep{0, m}; }
  [[nodiscard]] double shift(std::int32_t m) const { return diagonal() ? step.row * m * spacing : 0; }
};

/// The part of a line inside a dilated convex outline: discs at its corners, and its sides moved outwards.
class DilatedOutline {
 public:
  DilatedOutline(const Polygon& outline, double reach, const Lines& lines) : reach_(reach) {
    const std::size_t count = outline.size();
    corners_.reserve(count);
    for (const Vector2d& p : outline) corners_.emplace_back(lines.u.dot(p), lines.n.dot(p));
    sides_.reserve(count);
    for (std::size_t i = 0; i < count && count > 1; ++i) {
      const Vector2d a = corners_[i], side = corners_[i + 1 < count ? i + 1 : 0] - a;
      const double long_ = side.norm();
      if (long_ == 0) continue;
      const Vector2d out = Vector2d(side.y(), -side.x()) * (reach / long_);
      sides_.push_back({a + out, side});
    }
    for (const Vector2d& c : corners_) {
      low = std::min(low, c.y() - reach);
      high = std::max(high, c.y() + reach);
    }
  }
  double low = INFINITY, high = -INFINITY;  ///< range of `off` that it covers

  /// The interval of `along` in which the line is inside; empty where the first is the greater.
  [[nodiscard]] std::pair<double, double> cut(double off) const {
    double from = INFINITY, to = -INFINITY;
    for (const Vector2d& c : corners_) {
      const double rest = reach_ * reach_ - (off - c.y()) * (off - c.y());
      if (rest < 0) continue;
      const double half = std::sqrt(rest);
      from = std::min(from, c.x() - half);
      to = std::max(to, c.x() + half);
    }
    for (const Side& s : sides_) {
      const double up = off - s.a.y();
      if (s.by.y() == 0 || (up > 0) != (s.by.y() > 0) || std::abs(up) > std::abs(s.by.y())) continue;
      const double along = s.a.x() + s.by.x() * (up / s.by.y());
      from = std::min(from, along);
      to = std::max(to, along);
    }
    return {from, to};
  }

 private:
  struct Side {
    Vector2d a, by;
  };
  double reach_;
  std::vector<Vector2d> corners_;  ///< along, off
  std::vector<Side> sides_;
};

AlignedBox2d grown(const AlignedBox2d& box, double by) {
  return {box.min() - Vector2d::Constant(by), box.max() + Vector2d::Constant(by)};
}

std::int32_t clamped(double number, std::int32_t low, std::int32_t high) {
  return static_cast<std::int32_t>(std::clamp(number, static_cast<double>(low), static_cast<double>(high)));
}

}  // namespace

std::optional<std::size_t> RouteWindow::at(const Vector2d& p) const {
  const Vector2d in_cells = (p - origin) / cell_m;
  const double column = std::floor(in_cells.x() + 0.5), row = std::floor(in_cells.y() + 0.5);
  if (!(column >= 0 && column < columns && row >= 0 && row < rows)) return std::nullopt;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
}

RouteWindow RouteWindow::around(const Vector2d& start, const Vector2d& goal, const HazardMap& map, const Extent& extent,
                                bool& whole) {
  AlignedBox2d ends(start);
  ends.extend(goal);
  for (double cell = extent.cell_m;; cell *= 2) {
    AlignedBox2d all = ends;
    if (!map.bounds().isEmpty()) all.extend(grown(map.bounds(), extent.reach_m));
    if (!extent.more.isEmpty()) all.extend(extent.more);
    all = grown(all, kAround * cell);
    const AlignedBox2d near = grown(ends, std::max(extent.margin_m, kAround * cell));
    const AlignedBox2d box = all.intersection(near);
    const Vector2d low = ((box.min() - start) / cell).array().floor();
    const Vector2d high = ((box.max() - start) / cell).array().ceil();
    const Vector2d size = high - low + Vector2d::Ones();
    if (size.prod() > kMaxRouteCells) continue;
    whole = near.contains(all);
    return {start + cell * low, cell, static_cast<std::int32_t>(size.x()), static_cast<std::int32_t>(size.y())};
  }
}

RouteGrid::RouteGrid(const RouteWindow& window)
    : window_(window), open_(window.size(), 0xff), blocked_(window.size(), 0), factor_(window.size(), 1) {}

RouteGrid RouteGrid::exact(const HazardMap& map, const RouteWindow& window, double reach_m) {
  RouteGrid grid(window);
  for (const Hazard& h : map.hazards()) grid.rasterise(h, reach_m);
  return grid;
}

void RouteGrid::rasterise(const Hazard& hazard, double reach_m) {
  Polygon in_cells;
  in_cells.reserve(hazard.outline.size());
  for (const Vector2d& p : hazard.outline) in_cells.emplace_back((p - window_.origin) / window_.cell_m);
  const double reach = (reach_m + hazard.margin_m + kTouch) / window_.cell_m;
  for (const std::size_t step : {1, 2, 4, 5}) close_lines(in_cells, reach, step);
}

void RouteGrid::close_lines(const Polygon& outline_in_cells, double reach_in_cells, std::size_t step) {
  const Lines lines(step);
  const DilatedOutline outline(outline_in_cells, reach_in_cells, lines);
  const std::int32_t w = window_.columns, h = window_.rows, all = w + h;
  const auto ahead = static_cast<std::uint8_t>(~(1u << step)),
             back = static_cast<std::uint8_t>(~(1u << opposite(step)));
  const GridStep by = lines.step;
  const std::int64_t stride = std::int64_t{by.row} * w + by.column;
  const std::int32_t last = clamped(std::floor(outline.high / lines.spacing), -all - 1, all);
  for (std::int32_t m = clamped(std::ceil(outline.low / lines.spacing), -all, all + 1); m <= last; ++m) {
    // 1. the indices k of the line's cells that lie in the window
    const GridStep zero = lines.first(m);
    std::int32_t k_first = 0, k_last = by.column != 0 ? w - 1 : h - 1;
    if (by.column == 0 && (zero.column < 0 || zero.column >= w)) continue;
    if (by.row == 0 && (zero.row < 0 || zero.row >= h)) continue;
    if (lines.diagonal()) {
      k_first = std::max(k_first, by.row > 0 ? -zero.row : zero.row - (h - 1));
      k_last = std::min(k_last, by.row > 0 ? h - 1 - zero.row : zero.row);
    }
    if (k_first > k_last) continue;
    // 2. the indices between which the outline lies
    auto [from, to] = outline.cut(m * lines.spacing);
    if (from > to) continue;
    from = (from - lines.shift(m)) / lines.length;
    to = (to - lines.shift(m)) / lines.length;
    if (to < k_first || from > k_last) continue;
    const std::int32_t k_end = clamped(std::floor(to), k_first, k_last);
    std::int32_t k = clamped(std::ceil(from) - 1, k_first, k_last);
    auto cell = static_cast<std::size_t>((std::int64_t{zero.row} + std::int64_t{k} * by.row) * w + zero.column +
                                         std::int64_t{k} * by.column);
    for (; k <= k_end; ++k, cell = static_cast<std::size_t>(static_cast<std::int64_t>(cell) + stride)) {
      if (step == 1 && k >= from && k <= to) blocked_[cell] = 1;
      if (k == k_last) break;
      open_[cell] &= ahead;
      open_[static_cast<std::size_t>(static_cast<std::int64_t>(cell) + stride)] &= back;
    }
  }
}

RouteGrid RouteGrid::coarse(const HazardMap& map, const RouteWindow& window, double reach_m, bool cut_corners) {
  RouteGrid grid(window);
  for (const Hazard& h : map.hazards()) grid.block_touched(h, reach_m);
  grid.link_free_cells(cut_corners);
  return grid;
}

void RouteGrid::block_touched(const Hazard& hazard, double reach_m) {
  const double reach = reach_m + hazard.margin_m + kTouch, half = window_.cell_m / 2;
  AlignedBox2d box;
  for (const Vector2d& p : hazard.outline) box.extend(p);
  const Vector2d low = (box.min() - window_.origin) / window_.cell_m,
                 high = (box.max() - window_.origin) / window_.cell_m;
  const double wide = (reach + half) / window_.cell_m;
  const std::int32_t right = clamped(std::floor(high.x() + wide), -1, window_.columns - 1);
  const std::int32_t bottom = clamped(std::floor(high.y() + wide), -1, window_.rows - 1);
  for (std::int32_t row = clamped(std::ceil(low.y() - wide), 0, window_.rows); row <= bottom; ++row) {
    for (std::int32_t column = clamped(std::ceil(low.x() - wide), 0, window_.columns); column <= right; ++column) {
      const Vector2d c = window_.origin + window_.cell_m * Vector2d(column, row);
      const Polygon square = {c + Vector2d(-half, -half), c + Vector2d(half, -half), c + Vector2d(half, half),
                              c + Vector2d(-half, half)};
      double least = contains(square, hazard.outline.front()) ? 0 : INFINITY;
      for (std::size_t i = 0; i < 4; ++i) {
        least = std::min(least, isobath::leg_distance(hazard.outline, square[i], square[(i + 1) % 4]).distance_m);
      }
      if (least > reach) continue;
      blocked_[static_cast<std::size_t>(row) * static_cast<std::size_t>(window_.columns) +
               static_cast<std::size_t>(column)] = 1;
    }
  }
}

void RouteGrid::link_free_cells(bool cut_corners) {
  for (std::size_t cell = 0; cell < window_.size(); ++cell) {
    open_[cell] = 0;
    for (std::size_t step = 0; step < kGridSteps.size(); ++step) {
      const auto to = neighbour(cell, step);
      if (!to || blocked(*to) || blocked(cell)) continue;
      if (step >= 4 && !cut_corners) {
        const GridStep s = kGridSteps[step];
        const auto beside = neighbour(cell, s.column > 0 ? 1 : 3), below = neighbour(cell, s.row > 0 ? 2 : 0);
        if (!beside || !below || blocked(*beside) || blocked(*below)) continue;
      }
      open_[cell] |= static_cast<std::uint8_t>(1u << step);
    }
  }
}

void RouteGrid::free_cell(std::size_t cell) {
  blocked_[cell] = 0;
  for (std::size_t step = 0; step < 4; ++step) {
    const auto to = neighbour(cell, step);
    if (to && !blocked(*to)) open_[cell] |= static_cast<std::uint8_t>(1u << step);
  }
}

void RouteGrid::prefer_room(double band_m, double weight) {
  if (!(band_m > 0 && weight > 0)) return;
  const std::size_t w = static_cast<std::size_t>(window_.columns), count = window_.size();
  std::vector<std::uint16_t> thirds(count, kFar);
  for (std::size_t i = 0; i < count; ++i) {
    if (open_[i] != 0xff) thirds[i] = blocked_[i] != 0 ? 0 : 3;
  }
  const auto lower = [&](std::size_t at, std::size_t from, int by) {
    thirds[at] = std::min(thirds[at], static_cast<std::uint16_t>(thirds[from] + by));
  };
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t column = i % w;
    if (column > 0) lower(i, i - 1, 3);
    if (i < w) continue;
    lower(i, i - w, 3);
    if (column > 0) lower(i, i - w - 1, 4);
    if (column + 1 < w) lower(i, i - w + 1, 4);
  }
  for (std::size_t i = count; i-- > 0;) {
    const std::size_t column = i % w;
    if (column + 1 < w) lower(i, i + 1, 3);
    if (i + w < count) {
      lower(i, i + w, 3);
      if (column > 0) lower(i, i + w - 1, 4);
      if (column + 1 < w) lower(i, i + w + 1, 4);
    }
    const double beyond = thirds[i] * window_.cell_m / 3;
    factor_[i] = 1 + weight * std::max(0.0, 1 - beyond / band_m);
  }
}

void RouteGrid::add_cost(const Vector2d& centre, double radius_m, double extra) {
  for (std::size_t i = 0; i < factor_.size(); ++i) {
    factor_[i] += extra * std::max(0.0, 1 - (window_.centre(i) - centre).norm() / radius_m);
  }
}

void RouteGrid::close_beyond(const Vector2d& from, const Vector2d& to, double width_m) {
  const auto is_out = [&](std::size_t cell) {
    const Vector2d p = window_.centre(cell);
    return (nearest_on_segment(from, to, p) - p).norm() > width_m;
  };
  for (std::size_t i = 0; i < factor_.size(); ++i) {
    if (!is_out(i)) continue;
    open_[i] = 0;
    factor_[i] = kShut;
    for (std::size_t step = 0; step < kGridSteps.size(); ++step) {
      const auto beside = neighbour(i, step);
      if (beside) open_[*beside] &= static_cast<std::uint8_t>(~(1u << opposite(step)));
    }
  }
}

void RouteGrid::open_escape(const HazardMap& map, std::size_t start, double far_m) {
  const Vector2d from = window_.centre(start);
  const double least = map.distance(from) - kTouch;
  std::vector<std::size_t> waiting = {start};
  std::vector<bool> seen(window_.size(), false);
  seen[start] = true;
  while (!waiting.empty()) {
    const std::size_t cell = waiting.back();
    waiting.pop_back();
    factor_[cell] += kEscapeFactor;
    for (std::size_t step = 0; step < kGridSteps.size(); ++step) {
      const auto to = neighbour(cell, step);
      if (!to) continue;
      const Vector2d a = window_.centre(cell), b = window_.centre(*to);
      if ((b - from).norm() > far_m || map.leg_distance(a, b) < least) continue;
      open_[cell] |= static_cast<std::uint8_t>(1u << step);
      if (!blocked(*to) || seen[*to]) continue;
      seen[*to] = true;
      waiting.push_back(*to);
    }
  }
}

std::optional<std::size_t> RouteGrid::neighbour(std::size_t cell, std::size_t step) const {
  const auto width = static_cast<std::size_t>(window_.columns);
  const std::int64_t column = static_cast<std::int64_t>(cell % width) + kGridSteps[step].column;
  const std::int64_t row = static_cast<std::int64_t>(cell / width) + kGridSteps[step].row;
  if (column < 0 || column >= window_.columns || row < 0 || row >= window_.rows) return std::nullopt;
  return static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column);
}

double RouteGrid::leg_cost(const Vector2d& a, const Vector2d& b) const {
  const double length = (b - a).norm();
  const auto pieces = static_cast<int>(std::clamp(std::ceil(2 * length / window_.cell_m), 1.0, 1e6));
  double sum = 0;
  for (int i = 0; i < pieces; ++i) {
    const auto cell = window_.at(a + (i + 0.5) / pieces * (b - a));
    sum += cell ? factor_[*cell] : 1;
  }
  return length * sum / pieces;
}

}  // namespace isobath
