#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/geometry/contours.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

/// An edge of the grid: twice the index of its north-west node, plus 1 where it runs along a column.
using Edge = std::int64_t;

/// A piece of a line through one cell, with the higher values on its left.
struct Piece {
  Edge from, to;
};

class LevelTracer {
 public:
  LevelTracer(const GridFrame& frame, std::span<const float> values, double level)
      : frame_(frame), values_(values), level_(level) {}

  void trace(std::vector<ContourLine>& lines) {
    for (int row = 0; row + 1 < frame_.rows; ++row) {
      for (int column = 0; column + 1 < frame_.columns; ++column) cut(column, row);
    }
    link(lines);
  }

 private:
  [[nodiscard]] std::int64_t node(int column, int row) const { return std::int64_t{row} * frame_.columns + column; }
  [[nodiscard]] double value(std::int64_t node) const { return values_[static_cast<std::size_t>(node)]; }

  void cut(int column, int row) {
    const std::int64_t nw = node(column, row), ne = nw + 1, sw = node(column, row + 1), se = sw + 1;
    const std::array<double, 4> corners = {value(nw), value(ne), value(se), value(sw)};  // clockwise, as printed
    const std::array<Edge, 4> edges = {2 * nw, 2 * ne + 1, 2 * sw, 2 * nw + 1};          // edge i follows corner i
    const double mean = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
    if (std::isnan(mean)) return;

    // Around the cell, the border alternates between low and high.
    std::array<Edge, 2> rise{}, fall{};
    std::array<std::size_t, 2> rise_at{}, fall_at{};
    std::size_t rises = 0, falls = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const bool high = corners[i] >= level_, next_high = corners[(i + 1) % 4] >= level_;
      if (!high && next_high) {
        rise_at[rises] = i;
        rise[rises++] = edges[i];
      } else if (high && !next_high) {
        fall_at[falls] = i;
        fall[falls++] = edges[i];
      }
    }
    if (rises == 1) pieces_.push_back({rise[0], fall[0]});
    if (rises < 2) return;
    // A saddle: a high centre joins the high corners, and each piece cuts off a low one.
    const bool falls_next = (fall_at[0] + 4 - rise_at[0]) % 4 == 1;  // fall[0] is the first after rise[0]
    const std::size_t after = falls_next ? 0 : 1;
    const std::size_t partner = mean >= level_ ? 1 - after : after;
    pieces_.push_back({rise[0], fall[partner]});
    pieces_.push_back({rise[1], fall[1 - partner]});
  }

  [[nodiscard]] Vector2d crossing(Edge edge) const {
    const std::int64_t a = edge / 2, b = edge % 2 == 0 ? a + 1 : a + frame_.columns;
    const double share = (level_ - value(a)) / (value(b) - value(a));
    const std::int64_t whole_row = a / frame_.columns;
    const double column = static_cast<double>(a % frame_.columns) + (edge % 2 == 0 ? share : 0);
    const double row = static_cast<double>(whole_row) + (edge % 2 == 0 ? 0 : share);
    return frame_.first + column * frame_.per_column + row * frame_.per_row;
  }

  /// Links pieces to lines. An edge has at most two cells, so at most one piece begins and one ends at it.
  void link(std::vector<ContourLine>& lines) {
    const auto by_from = [](const Piece& a, const Piece& b) { return a.from < b.from; };
    std::sort(pieces_.begin(), pieces_.end(), by_from);
    std::vector<Edge> ends(pieces_.size());
    std::transform(pieces_.begin(), pieces_.end(), ends.begin(), [](const Piece& p) { return p.to; });
    std::sort(ends.begin(), ends.end());
    std::vector<bool> used(pieces_.size(), false);
    const auto follow = [&](std::size_t at, bool closed) {
      ContourLine line{level_, closed, {}};
      if (!closed) append(line.points, crossing(pieces_[at].from));
      while (at < pieces_.size() && !used[at]) {
        used[at] = true;
        const Edge to = pieces_[at].to;
        append(line.points, crossing(to));
        const auto next = std::lower_bound(pieces_.begin(), pieces_.end(), Piece{to, 0}, by_from);
        at = next != pieces_.end() && next->from == to ? static_cast<std::size_t>(next - pieces_.begin())
                                                       : pieces_.size();
      }
      if (closed && line.points.size() > 1 && line.points.front() == line.points.back()) line.points.pop_back();
      if (line.points.size() >= (closed ? 3U : 2U)) lines.push_back(std::move(line));
    };
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!std::binary_search(ends.begin(), ends.end(), pieces_[i].from)) follow(i, false);
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!used[i]) follow(i, true);
    }
  }

  /// Appends a point once: a line through a node meets several edges in one point.
  static void append(std::vector<Vector2d>& points, const Vector2d& p) {
    if (points.empty() || points.back() != p) points.push_back(p);
  }

  const GridFrame& frame_;
  std::span<const float> values_;
  double level_;
  std::vector<Piece> pieces_;
};

/// The step in whole tenths, so that its multiples are the nearest doubles: 0.3, never 0.30000000000000004.
std::int64_t step_in_tenths(double low, double high, double wanted) {
  std::int64_t best = 1;
  double best_misfit = INFINITY;
  if (!(high > low) || !std::isfinite(high - low)) return best;
  for (std::int64_t decade = 1; decade <= 1'000'000'000'000; decade *= 10) {
    for (const std::int64_t digit : {1, 2, 5}) {
      const std::int64_t tenths = digit * decade;
      const double misfit = std::abs(std::log(10 * (high - low) / (static_cast<double>(tenths) * wanted)));
      if (misfit >= best_misfit) return best;
      best = tenths;
      best_misfit = misfit;
    }
  }
  return best;
}

}  // namespace

std::vector<ContourLine> contour_lines(const GridFrame& frame, std::span<const float> values,
                                       std::span<const double> levels) {
  ISOBATH_ASSERT(frame.columns >= 0 && frame.rows >= 0 &&
                 values.size() == static_cast<std::size_t>(frame.columns) * static_cast<std::size_t>(frame.rows));
  std::vector<ContourLine> lines;
  for (const double level : levels) LevelTracer(frame, values, level).trace(lines);
  return lines;
}

double nice_step(double low, double high, double wanted) {
  return static_cast<double>(step_in_tenths(low, high, wanted)) / 10;
}

std::vector<double> contour_levels(double low, double high, double wanted) {
  std::vector<double> levels;
  if (!(high > low) || !std::isfinite(high - low)) return levels;
  const auto step = static_cast<double>(step_in_tenths(low, high, wanted));
  for (double i = std::floor(10 * low / step); i * step < 10 * high + step; ++i) {
    const double level = i * step / 10;
    if (level > low && level < high) levels.push_back(level);
  }
  return levels;
}

}  // namespace isobath
