#include <algorithm>
#include <cmath>
#include <isobath/perception/obstacle_detector.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// Calls visit(cell) for the existing cells of the (2 reach + 1)-block around c.
template <class Visit>
void for_block(const CartesianGrid& cells, Cell c, int reach, Visit visit) {
  for (int x = std::max(0, c.x - reach); x <= std::min(cells.cells_x - 1, c.x + reach); ++x) {
    for (int y = std::max(0, c.y - reach); y <= std::min(cells.cells_y - 1, c.y + reach); ++y) visit(Cell{x, y});
  }
}

// Convex hull in units of cells.
Polygon hull_of(const std::vector<Cell>& piece) {
  std::vector<Vector2d> corners;
  corners.reserve(4 * piece.size());
  for (const Cell& c : piece) {
    for (int i = 0; i < 4; ++i) corners.emplace_back(c.x + i / 2, c.y + i % 2);
  }
  return convex_hull(std::move(corners));
}

struct Moments {
  Vector2d mean = Vector2d::Zero();
  Matrix2d covariance = Matrix2d::Zero();
};

template <class Weight>
Moments moments(const std::vector<Cell>& piece, Weight weight) {
  Moments m;
  double total = 0;
  for (const Cell& c : piece) {
    total += weight(c);
    m.mean += weight(c) * Vector2d(c.x + 0.5, c.y + 0.5);
  }
  m.mean /= total;
  for (const Cell& c : piece) {
    const Vector2d d = Vector2d(c.x + 0.5, c.y + 0.5) - m.mean;
    m.covariance += weight(c) / total * d * d.transpose();
  }
  m.covariance += Matrix2d::Identity() / 12;  // variance of a cell about its centre
  return m;
}

Angle bearing_of(const Vector2d& p) { return Angle::radians(std::atan2(p.y(), p.x())); }
Vector2d direction_of(Angle bearing) { return {cos(bearing), sin(bearing)}; }

// Range of directions of an outline that does not contain the vehicle.
struct Interval {
  Angle low;
  Angle high;
};

Interval seen(const Obstacle& o) {
  const Angle middle = bearing_of(o.centre);
  Interval i{};
  for (const Vector2d& p : o.outline) {
    const Angle d = (bearing_of(p) - middle).wrapped();
    i.low = std::min(i.low, d);
    i.high = std::max(i.high, d);
  }
  return {middle + i.low, middle + i.high};
}

/// Obstacles come sorted by range, numbered below `count` in another order; they get numbers from 1.
void number_nearest_first(std::vector<Obstacle>& obstacles, int count) {
  std::vector<int> numbers(static_cast<std::size_t>(count), 0);
  int last = 0;
  for (Obstacle& o : obstacles) {
    int& number = numbers[static_cast<std::size_t>(o.number)];
    if (number == 0) number = ++last;
    o.number = number;
  }
}

bool overlaps(const Interval& a, const Interval& b) {
  const Angle apart = abs(((a.low + a.high) / 2 - (b.low + b.high) / 2).wrapped());
  return apart <= (a.high - a.low + b.high - b.low) / 2;
}

}  // namespace

std::vector<Field> fields(ObstacleDetectorConfig& c) {
  return {
      Field::integer("slack_cells", &c.slack_cells, {0, 50}, "cells",
                     "Largest distance of an outline's cells from evidence."),
      Field::integer(
          "max_multiple", &c.max_multiple, {1, 10}, "1",
          "Largest order of multiples: obstacles at up to this many times the range of a nearer one are marked."),
      Field::real("multiple_tolerance", &c.multiple_tolerance, {0, 0.3}, "1",
                  "Tolerance of the range of a multiple, as a share of the range."),
  };
}

Detection ObstacleDetector::detect(const BodyGrid& grid, Time time, const Pose& X_WB) {
  sum_neighbourhoods(grid);
  mark_evidence(grid.cells(), grid.config().threshold);
  Detection result{time, X_WB, grid.cells(), grid.position(), grid.heading(), detected_, {}, {}};
  result.free.resize(grid.cells().size());
  for (std::size_t i = 0; i < result.free.size(); ++i) result.free[i] = grid.is_free(i);
  taken_.assign(grid.cells().size(), 0);
  int regions = 0;
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    if (!detected_[i] || taken_[i]) continue;
    const std::size_t before = result.obstacles.size();
    take_region(grid, i, result.obstacles);
    for (std::size_t o = before; o < result.obstacles.size(); ++o) result.obstacles[o].number = regions;
    ++regions;
  }
  std::sort(result.obstacles.begin(), result.obstacles.end(), [](const Obstacle& a, const Obstacle& b) {
    return a.range_m < b.range_m || (a.range_m == b.range_m && a.bearing < b.bearing);
  });
  number_nearest_first(result.obstacles, regions);
  relate(result.obstacles, grid.cells().cell_m);
  return result;
}

// Equation 3.21, along y and then along x.
void ObstacleDetector::sum_neighbourhoods(const BodyGrid& grid) {
  const CartesianGrid& cells = grid.cells();
  const std::span<const double> log_odds = grid.log_odds();
  p_.resize(cells.size());
  column_.resize(cells.size());
  sum_.resize(cells.size());
  std::transform(log_odds.begin(), log_odds.end(), p_.begin(), probability_of);
  const auto add_neighbours = [](const std::vector<double>& from, std::vector<double>& to, std::size_t i, bool before,
                                 bool after, std::size_t stride) {
    to[i] = (before ? from[i - stride] : 0) + from[i] + (after ? from[i + stride] : 0);
  };
  const auto ny = static_cast<std::size_t>(cells.cells_y);
  for (int x = 0; x < cells.cells_x; ++x) {
    for (int y = 0; y < cells.cells_y; ++y) {
      add_neighbours(p_, column_, cells.index({x, y}), y > 0, y + 1 < cells.cells_y, 1);
    }
  }
  for (int x = 0; x < cells.cells_x; ++x) {
    for (int y = 0; y < cells.cells_y; ++y) {
      add_neighbours(column_, sum_, cells.index({x, y}), x > 0, x + 1 < cells.cells_x, ny);
    }
  }
}

void ObstacleDetector::mark_evidence(const CartesianGrid& cells, double threshold) {
  detected_.resize(cells.size());
  // A sum of exactly the threshold must be detected despite rounding (S6-E19).
  std::transform(sum_.begin(), sum_.end(), detected_.begin(),
                 [&](double n) -> std::uint8_t { return n >= threshold - 1e-9; });
  evidence_.assign(cells.size(), 0);
  const double least = threshold / 9 - 1e-9;
  const auto in_detected = [&](std::size_t i, auto visit) {
    if (detected_[i]) for_block(cells, cells.cell(i), 1, [&](Cell c) { visit(c, cells.index(c)); });
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    in_detected(i, [&](Cell c, std::size_t at) {
      if (p_[at] < least || evidence_[at]) return;
      double largest = 0;
      for_block(cells, c, 1, [&](Cell n) { largest = std::max(largest, p_[cells.index(n)]); });
      evidence_[at] = p_[at] >= largest / 2;
    });
  }
  // Each detection needs an outline: if stronger neighbours leave a detected cell without evidence, its whole block
  // counts.
  for (std::size_t i = 0; i < cells.size(); ++i) {
    bool bare = true;
    in_detected(i, [&](Cell, std::size_t at) { bare = bare && !evidence_[at]; });
    if (bare) in_detected(i, [&](Cell, std::size_t at) { evidence_[at] = p_[at] >= least; });
  }
}

void ObstacleDetector::take_region(const BodyGrid& grid, std::size_t seed, std::vector<Obstacle>& out) {
  const CartesianGrid& cells = grid.cells();
  std::vector<Cell> piece;
  queue_.assign(1, seed);
  taken_[seed] = 1;
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const Cell c = cells.cell(queue_[next]);
    if (evidence_[queue_[next]]) piece.push_back(c);
    for_block(cells, c, 1, [&](Cell n) {
      const std::size_t at = cells.index(n);
      if (taken_[at] || !(detected_[at] || evidence_[at])) return;
      taken_[at] = 1;
      queue_.push_back(at);
    });
  }
  split(grid, piece, out);
}

void ObstacleDetector::split(const BodyGrid& grid, std::vector<Cell>& piece, std::vector<Obstacle>& out) {
  if (piece.empty()) return;
  const Polygon hull = hull_of(piece);
  if (tight(grid.cells(), hull)) {
    out.push_back(describe(grid, piece, hull));
    return;
  }
  const Moments m = moments(piece, [](Cell) { return 1.0; });
  const double axis = std::atan2(2 * m.covariance(0, 1), m.covariance(0, 0) - m.covariance(1, 1)) / 2;
  const Vector2d along(std::cos(axis), std::sin(axis));
  const auto middle = std::stable_partition(piece.begin(), piece.end(), [&](const Cell& c) {
    return along.dot(Vector2d(c.x + 0.5, c.y + 0.5) - m.mean) < 0;
  });
  std::vector<Cell> far(middle, piece.end());
  piece.erase(middle, piece.end());
  split(grid, piece, out);
  split(grid, far, out);
}

bool ObstacleDetector::tight(const CartesianGrid& cells, const Polygon& hull) const {
  Vector2d low = hull.front();
  Vector2d high = hull.front();
  for (const Vector2d& p : hull) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (int x = static_cast<int>(low.x()); x < static_cast<int>(high.x()); ++x) {
    for (int y = static_cast<int>(low.y()); y < static_cast<int>(high.y()); ++y) {
      if (evidence_[cells.index({x, y})] || !contains(hull, Vector2d(x + 0.5, y + 0.5))) continue;
      bool near = false;
      for_block(cells, {x, y}, config_.slack_cells, [&](Cell c) { near = near || evidence_[cells.index(c)]; });
      if (!near) return false;
    }
  }
  return true;
}

Obstacle ObstacleDetector::describe(const BodyGrid& grid, const std::vector<Cell>& piece, const Polygon& hull) const {
  const CartesianGrid& cells = grid.cells();
  Obstacle o;
  for (const Vector2d& p : hull) o.outline.push_back(grid.to_level_body(p * cells.cell_m));
  o.nearest = nearest_point(o.outline, Vector2d::Zero());
  o.range_m = o.nearest.norm();
  o.bearing = bearing_of(o.nearest).wrapped_positive();
  const Moments m = moments(piece, [&](Cell c) { return p_[cells.index(c)]; });
  o.centre = grid.to_level_body(m.mean * cells.cell_m);
  Matrix2d R_GL;
  R_GL << cos(grid.heading()), -sin(grid.heading()), sin(grid.heading()), cos(grid.heading());
  o.covariance = R_GL.transpose() * m.covariance * R_GL * (cells.cell_m * cells.cell_m);

  Cell strongest = piece.front();
  for (const Cell& c : piece) {
    if (sum_[cells.index(c)] > sum_[cells.index(strongest)]) strongest = c;
    if (grid.hits(cells.index(c)) == 0) continue;
    o.last_hit = o.hits == 0 ? grid.last_hit(cells.index(c)) : std::max(o.last_hit, grid.last_hit(cells.index(c)));
    o.hits += grid.hits(cells.index(c));
  }
  double none = 1;
  for_block(cells, strongest, 1, [&](Cell c) { none *= 1 - p_[cells.index(c)]; });
  o.existence = 1 - none;
  return o;
}

// Obstacles are sorted by range, so one that hides another, or whose multiple another is, comes before it.
void ObstacleDetector::relate(std::vector<Obstacle>& obstacles, double cell_m) const {
  constexpr int kRays = 17;
  const Vector2d vehicle = Vector2d::Zero();
  std::vector<Interval> intervals;
  for (const Obstacle& o : obstacles) intervals.push_back(seen(o));
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    Obstacle& o = obstacles[i];
    if (o.range_m == 0) continue;
    const auto nearer_hit = [&](std::size_t j, const Vector2d& direction) {
      if (obstacles[j].range_m == 0 || !overlaps(intervals[i], intervals[j])) return std::optional<double>{};
      return ray_hit(obstacles[j].outline, vehicle, direction);
    };
    int hidden = 0;
    for (int ray = 0; ray < kRays; ++ray) {
      const Interval& v = intervals[i];
      const Vector2d direction = direction_of(v.low + (v.high - v.low) * ((ray + 0.5) / kRays));
      const auto own = ray_hit(o.outline, vehicle, direction);
      bool covered = false;
      for (std::size_t j = 0; own && j < i && !covered; ++j) {
        const auto hit = nearer_hit(j, direction);
        covered = hit && *hit < *own;
      }
      hidden += covered;
    }
    o.behind = 2 * hidden > kRays;
    for (std::size_t j = 0; j < i; ++j) {
      const auto hit = nearer_hit(j, direction_of(o.bearing));
      for (int n = 2; hit && n <= config_.max_multiple; ++n) {
        const double allowed = config_.multiple_tolerance * o.range_m + cell_m;
        o.possible_multiple = o.possible_multiple || std::abs(o.range_m - n * *hit) <= allowed;
      }
    }
  }
}

}  // namespace isobath
