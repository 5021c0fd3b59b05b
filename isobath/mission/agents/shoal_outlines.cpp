#include <algorithm>
#include <cmath>
#include <cstring>
#include <isobath/mission/agents/shoal_outlines.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr std::int32_t kRowsRead = 64;  // at a time: a quadtree reads whole squares
constexpr std::size_t kMaxRows = 64;    // of one outline: each added row checks all of them

/// Which cells of a rectangle are blocked. Columns count east, rows south.
struct Mask {
  int width = 0;
  int height = 0;
  int pixels = 1;  ///< on a side of a cell
  std::vector<std::uint8_t> blocked;

  [[nodiscard]] bool at(int column, int row) const {
    if (column >= width || row >= height) return false;
    return blocked[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(column)] != 0;
  }
};

struct Masks {
  Mask charted, sensed;
};

Masks masks_of(const DepthField& map, PixelWindow window, const ShoalRule& rule) {
  Masks masks;
  masks.charted = masks.sensed = {window.width, window.height, 1, {}};
  const std::size_t cells = static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height);
  for (Mask* mask : {&masks.charted, &masks.sensed}) mask->blocked.resize(cells);
  std::vector<DepthPixel> rows;
  std::size_t cell = 0;
  for (std::int32_t r = 0; r < window.height; r += kRowsRead) {
    const std::int32_t count = std::min(kRowsRead, window.height - r);
    rows.resize(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(count));
    map.read({window.column, window.row + r, window.width, count}, rows);
    for (const DepthPixel& p : rows) {
      const bool unknown = !p.known() || (p.clear_only() && p.depth_m() < rule.depth_m);
      const bool blocked = unknown ? rule.unknown_blocks : p.depth_m() < rule.depth_m;
      const bool sensed = p.has(kSensed) && !unknown;
      masks.charted.blocked[cell] = blocked && !sensed;
      masks.sensed.blocked[cell++] = blocked && sensed;
    }
  }
  return masks;
}

/// Cells of twice the side, blocked where one of the four is.
Mask coarser(const Mask& fine) {
  Mask mask{(fine.width + 1) / 2, (fine.height + 1) / 2, 2 * fine.pixels, {}};
  for (int r = 0; r < 2 * mask.height; r += 2) {
    for (int c = 0; c < 2 * mask.width; c += 2) {
      mask.blocked.push_back(fine.at(c, r) || fine.at(c + 1, r) || fine.at(c, r + 1) || fine.at(c + 1, r + 1));
    }
  }
  return mask;
}

/// Cells of one row, from `west` up to but not including `east`.
struct Run {
  int west = 0;
  int east = 0;
  [[nodiscard]] bool touches(const Run& other) const { return west < other.east && other.west < east; }
};

std::vector<Run> runs_of(const Mask& mask, int row) {
  std::vector<Run> runs;
  const std::uint8_t* const west = &mask.blocked[static_cast<std::size_t>(row) * static_cast<std::size_t>(mask.width)];
  const std::uint8_t* const east = west + mask.width;
  const auto next = [east](const std::uint8_t* from, int value) {
    const void* found = std::memchr(from, value, static_cast<std::size_t>(east - from));
    return found != nullptr ? static_cast<const std::uint8_t*>(found) : east;
  };
  for (const std::uint8_t* cell = next(west, 1); cell != east;) {
    const std::uint8_t* const end = next(cell, 0);
    runs.push_back({static_cast<int>(cell - west), static_cast<int>(end - west)});
    cell = next(end, 1);
  }
  return runs;
}

/// The west and the east end of a convex outline (x columns, y rows) at one y.
std::pair<double, double> breadth(const Polygon& hull, double y) {
  double west = INFINITY, east = -INFINITY;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2d& a = hull[i];
    const Vector2d& b = hull[(i + 1) % hull.size()];
    if (std::min(a.y(), b.y()) > y || std::max(a.y(), b.y()) < y) continue;
    const double share = a.y() == b.y() ? 0 : (y - a.y()) / (b.y() - a.y());
    for (const double x : {a.x() + share * (b.x() - a.x()), a.y() == b.y() ? b.x() : a.x() + share * (b.x() - a.x())}) {
      west = std::min(west, x);
      east = std::max(east, x);
    }
  }
  return {west, east};
}

/// Runs of successive rows, with their convex hull.
struct Strip {
  int top = 0;
  std::vector<Run> runs;
  Polygon hull;

  Strip(int row, const Run& run) : top(row) { add(run); }

  [[nodiscard]] bool touches(const Run& run) const { return runs.back().touches(run); }
  /// Returns false and changes nothing where the hull would reach over a row by more than `overreach` cells.
  bool grow(const Run& run, double overreach) {
    if (runs.size() >= kMaxRows) return false;
    Strip grown = *this;
    grown.add(run);
    if (grown.reaches_over(overreach + 1e-9)) return false;
    *this = std::move(grown);
    return true;
  }

 private:
  void add(const Run& run) {
    const double y = top + static_cast<int>(runs.size());
    runs.push_back(run);
    Polygon points = hull;
    for (const double x : {run.west, run.east}) {
      points.emplace_back(x, y);
      points.emplace_back(x, y + 1);
    }
    hull = convex_hull(std::move(points));
  }
  /// The corners of a hull lie on the edges of rows, so that it is widest there.
  [[nodiscard]] bool reaches_over(double overreach) const {
    for (std::size_t i = 0; i <= runs.size(); ++i) {
      const auto [west, east] = breadth(hull, top + static_cast<double>(i));
      for (const std::size_t row : {i == 0 ? i : i - 1, std::min(i, runs.size() - 1)}) {
        if (runs[row].west - west > overreach || east - runs[row].east > overreach) return true;
      }
    }
    return false;
  }
};

/// Outlines in cells.
std::vector<Polygon> strips_of(const Mask& mask, double overreach) {
  std::vector<Polygon> done;
  std::vector<Strip> open;
  for (int row = 0; row < mask.height; ++row) {
    std::vector<Strip> next;
    std::vector<std::uint8_t> grown(open.size(), 0);
    for (const Run& run : runs_of(mask, row)) {
      // The first strip above that has not grown yet: at a fork the others begin anew.
      std::size_t above = 0;
      while (above < open.size() && (grown[above] != 0 || !open[above].touches(run))) ++above;
      if (above < open.size() && open[above].grow(run, overreach)) {
        grown[above] = 1;
        next.push_back(std::move(open[above]));
      } else {
        next.emplace_back(row, run);
      }
    }
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (grown[i] == 0) done.push_back(std::move(open[i].hull));
    }
    open = std::move(next);
  }
  for (Strip& strip : open) done.push_back(std::move(strip.hull));
  return done;
}

std::vector<Polygon> outlines_of(Mask mask, const PixelGrid& grid, const PixelWindow& window, const ShoalRule& rule) {
  std::vector<Polygon> outlines = strips_of(mask, rule.overreach_m / grid.pixel_m);
  while (outlines.size() > static_cast<std::size_t>(rule.max_outlines) && mask.width + mask.height > 2) {
    mask = coarser(mask);
    outlines = strips_of(mask, rule.overreach_m / (grid.pixel_m * mask.pixels));
  }
  for (Polygon& outline : outlines) {
    for (Vector2d& p : outline) {
      const Vector2d cells = p;
      p.x() = grid.corner_m.x() - (window.row + cells.y() * mask.pixels) * grid.pixel_m;
      p.y() = grid.corner_m.y() + (window.column + cells.x() * mask.pixels) * grid.pixel_m;
    }
    if (area(outline) < 0) std::reverse(outline.begin(), outline.end());
  }
  return outlines;
}

}  // namespace

ShoalOutlines shoal_outlines(const DepthField& map, PixelWindow window, const ShoalRule& rule) {
  Masks masks = masks_of(map, window, rule);
  const PixelGrid grid = map.grid();
  return {outlines_of(std::move(masks.charted), grid, window, rule),
          outlines_of(std::move(masks.sensed), grid, window, rule)};
}

}  // namespace isobath
