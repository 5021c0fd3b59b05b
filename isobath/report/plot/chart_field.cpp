#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/depth_pixel.hpp>
#include <isobath/report/plot/chart_field.hpp>
#include <limits>

namespace isobath {
namespace {

using Eigen::Vector2d;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// The range of map pixels that a row or column of the picture overlaps.
struct Span {
  int from, to;
};
Span overlapped(int cell, double cells_per_pixel, int pixels) {
  const double low = cell / cells_per_pixel, high = (cell + 1) / cells_per_pixel;
  const int from = std::clamp(static_cast<int>(std::floor(low + 1e-9)), 0, pixels);
  return {from, std::clamp(static_cast<int>(std::ceil(high - 1e-9)), from, pixels)};
}

/// Calls visit(cell, map pixel) for every cell and every pixel under it.
template <class Visit>
void for_each_overlap(const DepthChart& chart, const ChartField& field, Visit visit) {
  const double scale = chart.grid.pixel_m / field.cell_m;
  for (int row = 0; row < field.rows; ++row) {
    const Span r = overlapped(row, scale, chart.window.height);
    for (int column = 0; column < field.columns; ++column) {
      const Span c = overlapped(column, scale, chart.window.width);
      const std::size_t cell = field.index(column, row);
      for (int y = r.from; y < r.to; ++y) {
        const std::size_t start = static_cast<std::size_t>(y) * static_cast<std::size_t>(chart.window.width);
        for (int x = c.from; x < c.to; ++x) visit(cell, start + static_cast<std::size_t>(x));
      }
    }
  }
}

struct Mean {
  std::vector<float> sum;
  std::vector<int> count;
  explicit Mean(std::size_t cells) : sum(cells, 0.f), count(cells, 0) {}
  void add(std::size_t cell, float value) {
    sum[cell] += value;
    ++count[cell];
  }
  std::vector<float> finish() {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = count[i] > 0 ? sum[i] / static_cast<float>(count[i]) : kNone;
    return std::move(sum);
  }
};

/// The lower envelope of the parabolas f(i) + (x - i)^2, in place.
void envelope(std::vector<double>& f, std::vector<int>& at, std::vector<double>& from, std::vector<double>& out) {
  const int n = static_cast<int>(f.size());
  int k = -1;
  for (int q = 0; q < n; ++q) {
    const auto height = [&](int i) { return f[static_cast<std::size_t>(i)] + static_cast<double>(i) * i; };
    if (!std::isfinite(height(q))) continue;
    double s = -std::numeric_limits<double>::infinity();
    while (k >= 0) {
      const int p = at[static_cast<std::size_t>(k)];
      s = (height(q) - height(p)) / (2.0 * (q - p));
      if (s > from[static_cast<std::size_t>(k)]) break;
      --k;
    }
    if (k < 0) s = -std::numeric_limits<double>::infinity();
    ++k;
    at[static_cast<std::size_t>(k)] = q;
    from[static_cast<std::size_t>(k)] = s;
  }
  for (int x = 0, j = 0; x < n; ++x) {
    while (j < k && from[static_cast<std::size_t>(j) + 1] < x) ++j;
    const double d = k < 0 ? 0 : x - at[static_cast<std::size_t>(j)];
    out[static_cast<std::size_t>(x)] = k < 0 ? std::numeric_limits<double>::infinity()
                                             : f[static_cast<std::size_t>(at[static_cast<std::size_t>(j)])] + d * d;
  }
  f.swap(out);
}

/// One pass of the 3 x 3 binomial filter over the known values.
std::vector<float> smoothed(const std::vector<float>& values, int columns, int rows) {
  std::vector<float> out(values.size(), kNone);
  const auto at = [&](int c, int r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c);
  };
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      if (std::isnan(values[at(c, r)])) continue;
      float sum = 0, weight = 0;
      for (int y = std::max(0, r - 1); y <= std::min(rows - 1, r + 1); ++y) {
        for (int x = std::max(0, c - 1); x <= std::min(columns - 1, c + 1); ++x) {
          const float v = values[at(x, y)];
          const float w = (x == c ? 2.f : 1.f) * (y == r ? 2.f : 1.f);
          if (std::isnan(v)) continue;
          sum += w * v;
          weight += w;
        }
      }
      out[at(c, r)] = sum / weight;
    }
  }
  return out;
}

}  // namespace

bool measured_at(const DepthChart& chart, std::size_t pixel) {
  if (std::isnan(chart.depth_m[pixel])) return false;
  if (chart.flags.empty() || (chart.flags[pixel] & kSensed) != 0) return true;
  const bool confident = !chart.confidence.empty() && chart.confidence[pixel] <= kFullConfidence &&
                         chart.confidence[pixel] > chart.charted_confidence;
  return (chart.flags[pixel] & kSeenByDepth) != 0 && confident;
}

std::vector<float> distance_to_set(std::span<const std::uint8_t> set, int columns, int rows) {
  const auto w = static_cast<std::size_t>(columns), h = static_cast<std::size_t>(rows);
  ISOBATH_ASSERT(set.size() == w * h);
  std::vector<double> squares(set.size());
  std::vector<int> at(std::max(w, h));
  std::vector<double> from(std::max(w, h)), line, out;
  const auto pass = [&](std::size_t lines, std::size_t length, std::size_t to_next_line, std::size_t to_next) {
    line.resize(length);
    out.resize(length);
    for (std::size_t l = 0; l < lines; ++l) {
      for (std::size_t i = 0; i < length; ++i) line[i] = squares[l * to_next_line + i * to_next];
      envelope(line, at, from, out);
      for (std::size_t i = 0; i < length; ++i) squares[l * to_next_line + i * to_next] = line[i];
    }
  };
  std::transform(set.begin(), set.end(), squares.begin(),
                 [](std::uint8_t s) { return s != 0 ? 0.0 : std::numeric_limits<double>::infinity(); });
  pass(w, h, 1, w);
  pass(h, w, w, 1);
  std::vector<float> distance(squares.size());
  std::transform(squares.begin(), squares.end(), distance.begin(),
                 [](double s) { return static_cast<float>(std::sqrt(s)); });
  return distance;
}

std::vector<std::uint8_t> inside_rings(const std::vector<std::vector<Vector2d>>& rings, const ChartField& field) {
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows), 0);
  std::vector<double> crossings;
  for (int row = 0; row < field.rows; ++row) {
    const double north = field.centre(0, row).x();
    crossings.clear();
    for (const auto& ring : rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
        if ((a.x() > north) == (b.x() > north)) continue;
        crossings.push_back(a.y() + (north - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
      }
    }
    std::sort(crossings.begin(), crossings.end());
    std::size_t passed = 0;
    for (int column = 0; column < field.columns; ++column) {
      const double east = field.centre(column, row).y();
      while (passed < crossings.size() && crossings[passed] <= east) ++passed;
      inside[field.index(column, row)] = passed % 2;
    }
  }
  return inside;
}

ChartField chart_field(const DepthChart& chart, int columns, int rows, double cell_m) {
  const std::size_t pixels =
      static_cast<std::size_t>(chart.window.width) * static_cast<std::size_t>(chart.window.height);
  ISOBATH_ASSERT(chart.depth_m.size() == pixels && (chart.flags.empty() || chart.flags.size() == pixels));
  const PixelGrid& grid = chart.grid;
  ChartField field;
  field.columns = columns;
  field.rows = rows;
  field.cell_m = cell_m;
  field.north_west = {grid.corner_m.x() - chart.window.row * grid.pixel_m,
                      grid.corner_m.y() + chart.window.column * grid.pixel_m};
  const std::size_t cells = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  Mean measured(cells), charted(cells);
  for_each_overlap(chart, field, [&](std::size_t cell, std::size_t pixel) {
    if (std::isnan(chart.depth_m[pixel])) return;
    (measured_at(chart, pixel) ? measured : charted).add(cell, chart.depth_m[pixel]);
  });
  field.measured = measured.finish();
  field.charted = charted.finish();

  double depth_sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!measured_at(chart, i)) continue;
    depth_sum += chart.depth_m[i];
    ++count;
  }
  field.reach_m =
      chart.reach_m > 0 ? chart.reach_m : std::max(25.0, count > 0 ? 3 * depth_sum / static_cast<double>(count) : 0.0);

  std::vector<std::uint8_t> set(cells);
  for (std::size_t i = 0; i < cells; ++i) set[i] = std::isnan(field.measured[i]) ? 0 : 1;
  field.distance_m = distance_to_set(set, columns, rows);
  for (float& d : field.distance_m) d *= static_cast<float>(cell_m);

  field.land = inside_rings(chart.shore, field);
  // Measured pixels are water; charted ones may be the land around it.
  const std::vector<float>& water = count > 0 ? field.measured : field.charted;
  std::size_t known = 0, known_inside = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    if (std::isnan(water[i])) continue;
    ++known;
    known_inside += field.land[i];
  }
  if (2 * known_inside > known) {
    for (std::uint8_t& l : field.land) l = 1 - l;
  }
  return field;
}

std::vector<int> confidence_cells(const DepthChart& chart, const ChartField& field) {
  ISOBATH_ASSERT(chart.confidence.size() == chart.depth_m.size());
  std::vector<int> sum(field.measured.size(), 0), count(field.measured.size(), 0);
  for_each_overlap(chart, field, [&](std::size_t cell, std::size_t pixel) {
    if (chart.confidence[pixel] > kFullConfidence) return;
    sum[cell] += chart.confidence[pixel];
    ++count[cell];
  });
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = count[i] > 0 ? sum[i] / count[i] : -1;
  return sum;
}

ChartNodes chart_nodes(const DepthChart& chart, const ChartField& field, int step) {
  ChartNodes nodes;
  nodes.step = step;
  GridFrame& frame = nodes.frame;
  frame.columns = (field.columns + step - 1) / step;
  frame.rows = (field.rows + step - 1) / step;
  // A node stands in the middle of its block of cells.
  const double node_m = step * field.cell_m;
  frame.first = field.north_west + Vector2d(-node_m / 2, node_m / 2);
  frame.per_column = {0, node_m};
  frame.per_row = {-node_m, 0};
  const std::size_t count = static_cast<std::size_t>(frame.columns) * static_cast<std::size_t>(frame.rows);
  nodes.depth_m.assign(count, kNone);
  nodes.surface_m.assign(count, kNone);
  nodes.approximate.assign(count, 0);
  const auto near_water = [&](int column, int row) {
    for (int y = std::max(0, row - step); y <= std::min(field.rows - 1, row + step); y += step) {
      for (int x = std::max(0, column - step); x <= std::min(field.columns - 1, column + step); x += step) {
        if (field.land[field.index(x, y)] == 0) return true;
      }
    }
    return false;
  };
  std::size_t node = 0;
  for (int row = 0; row < frame.rows; ++row) {
    for (int column = 0; column < frame.columns; ++column, ++node) {
      const Vector2d p = frame.first + column * frame.per_column + row * frame.per_row;
      Mean measured(1), charted(1);
      for (int y = row * step; y < std::min(field.rows, (row + 1) * step); ++y) {
        for (int x = column * step; x < std::min(field.columns, (column + 1) * step); ++x) {
          const std::size_t cell = field.index(x, y);
          if (!std::isnan(field.measured[cell])) measured.add(0, field.measured[cell]);
          if (!std::isnan(field.charted[cell])) charted.add(0, field.charted[cell]);
        }
      }
      const int middle_column = std::min(field.columns - 1, column * step + step / 2);
      const int middle_row = std::min(field.rows - 1, row * step + step / 2);
      const std::size_t middle = field.index(middle_column, middle_row);
      const double distance = field.distance_m[middle];
      // Evaluate the surface a little beyond the reach and the shore, so that the colours end there and not at a node.
      if (chart.surface && distance <= field.reach_m + 2 * node_m && near_water(middle_column, middle_row)) {
        if (const auto depth = chart.surface(p.x(), p.y())) nodes.surface_m[node] = static_cast<float>(*depth);
      }
      const float m = measured.finish()[0], c = field.land[middle] != 0 ? kNone : charted.finish()[0];
      if (!std::isnan(c)) {
        nodes.depth_m[node] = std::isnan(m) ? c : m;
      } else {
        const bool said = !std::isnan(nodes.surface_m[node]) && field.land[middle] == 0 && distance <= field.reach_m;
        nodes.depth_m[node] = said ? nodes.surface_m[node] : m;
        nodes.approximate[node] = distance > field.reach_m / 2 ? 1 : 0;
      }
    }
  }
  nodes.depth_m = smoothed(smoothed(nodes.depth_m, frame.columns, frame.rows), frame.columns, frame.rows);
  return nodes;
}

float ChartNodes::surface_at(int column, int row) const {
  const float x = (static_cast<float>(column) + 0.5f) / static_cast<float>(step) - 0.5f;
  const float y = (static_cast<float>(row) + 0.5f) / static_cast<float>(step) - 0.5f;
  const int c = std::clamp(static_cast<int>(std::floor(x)), 0, std::max(0, frame.columns - 2));
  const int r = std::clamp(static_cast<int>(std::floor(y)), 0, std::max(0, frame.rows - 2));
  const int c1 = std::min(c + 1, frame.columns - 1), r1 = std::min(r + 1, frame.rows - 1);
  const auto at = [&](int i, int j) {
    return surface_m[static_cast<std::size_t>(j) * static_cast<std::size_t>(frame.columns) +
                     static_cast<std::size_t>(i)];
  };
  const float u = x - static_cast<float>(c), v = y - static_cast<float>(r);
  return (1 - v) * ((1 - u) * at(c, r) + u * at(c1, r)) + v * ((1 - u) * at(c, r1) + u * at(c1, r1));
}

bool ChartNodes::approximate_at(const Vector2d& north_east) const {
  const Vector2d d = north_east - frame.first;
  const int c = std::clamp(static_cast<int>(std::lround(d.y() / frame.per_column.y())), 0, frame.columns - 1);
  const int r = std::clamp(static_cast<int>(std::lround(d.x() / frame.per_row.x())), 0, frame.rows - 1);
  return approximate[static_cast<std::size_t>(r) * static_cast<std::size_t>(frame.columns) +
                     static_cast<std::size_t>(c)] != 0;
}

}  // namespace isobath
