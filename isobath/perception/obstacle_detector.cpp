#include <algorithm>
#include <array>
#include <cmath>
#include <Eigen/Eigenvalues>
#include <isobath/base/error.hpp>
#include <isobath/perception/obstacle_detector.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
constexpr int kBlock = 1;             // half width of the 3 x 3 block
constexpr std::size_t kSmallest = 4;  // cells: a piece this small is not halved further

template <class Visit>
void for_block(const CartesianGrid& grid, Cell at, Visit visit) {
  for (int x = std::max(0, at.x - kBlock); x <= std::min(grid.cells_x - 1, at.x + kBlock); ++x) {
    for (int y = std::max(0, at.y - kBlock); y <= std::min(grid.cells_y - 1, at.y + kBlock); ++y) {
      visit(grid.index({x, y}));
    }
  }
}

/// Convex hull of the corners of cells, in G.
Polygon hull_of(const CartesianGrid& grid, const std::vector<std::size_t>& cells) {
  std::vector<Vector2d> corners;
  corners.reserve(cells.size() * 4);
  for (const std::size_t i : cells) {
    const Cell c = grid.cell(i);
    for (const int dx : {0, 1}) {
      for (const int dy : {0, 1}) corners.emplace_back((c.x + dx) * grid.cell_m, (c.y + dy) * grid.cell_m);
    }
  }
  return convex_hull(std::move(corners));
}

Vector2d mean_of(const CartesianGrid& grid, const std::vector<std::size_t>& cells) {
  Vector2d sum = Vector2d::Zero();
  for (const std::size_t i : cells) sum += grid.centre(grid.cell(i));
  return sum / static_cast<double>(cells.size());
}

Eigen::Matrix2d covariance_of(const CartesianGrid& grid, const std::vector<std::size_t>& cells, const Vector2d& mean) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (const std::size_t i : cells) {
    const Vector2d d = grid.centre(grid.cell(i)) - mean;
    sum += d * d.transpose();
  }
  const double within_cell = grid.cell_m * grid.cell_m / 12;
  return sum / static_cast<double>(cells.size()) + within_cell * Eigen::Matrix2d::Identity();
}

}  // namespace

std::vector<Field> fields(ObstacleDetectorConfig& c) {
  return {Field::real("threshold", &c.threshold, {0.01, 9}, "1",
                      "Expected number of occupied cells in a 3 x 3 block from which an obstacle is reported."),
          Field::real("tightness", &c.tightness, {0.01, 1}, "1",
                      "Share of an outline that may lie outside its region before it is split in two."),
          Field::real("multiple_tolerance", &c.multiple_tolerance, {0, 0.5}, "1",
                      "Deviation from two or three times a nearer range, as a share, that still counts as a multiple echo.")};
}

const std::vector<Obstacle>& ObstacleDetector::detect(const OccupancyView& view) {
  ISOBATH_ASSERT(view.probability.size() == view.grid.size());
  obstacles_.clear();
  sum_blocks(view);
  visited_.assign(view.grid.size(), 0);
  own_.assign(view.grid.size(), 0);
  for (std::size_t i = 0; i < detected_.size(); ++i) {
    if (detected_[i] && !visited_[i]) outline_region(view, region_from(i, view.grid));
  }
  std::sort(obstacles_.begin(), obstacles_.end(), [](const Obstacle& a, const Obstacle& b) {
    return std::pair(a.range_m, a.bearing.radians()) < std::pair(b.range_m, b.bearing.radians());
  });
  mark_hidden(obstacles_, config_.multiple_tolerance);
  return obstacles_;
}

void ObstacleDetector::sum_blocks(const OccupancyView& view) {
  const CartesianGrid& grid = view.grid;
  count_.assign(grid.size(), 0);
  detected_.assign(grid.size(), 0);
  std::vector<double> columns(static_cast<std::size_t>(grid.cells_y));  // sums over x of three rows
  for (int x = 0; x < grid.cells_x; ++x) {
    std::fill(columns.begin(), columns.end(), 0.0);
    for (int row = std::max(0, x - 1); row <= std::min(grid.cells_x - 1, x + 1); ++row) {
      const double* p = view.probability.data() + grid.index({row, 0});
      for (int y = 0; y < grid.cells_y; ++y) columns[static_cast<std::size_t>(y)] += p[y];
    }
    for (int y = 0; y < grid.cells_y; ++y) {
      double n = 0;
      for (int j = std::max(0, y - 1); j <= std::min(grid.cells_y - 1, y + 1); ++j) n += columns[static_cast<std::size_t>(j)];
      const std::size_t i = grid.index({x, y});
      count_[i] = n;
      detected_[i] = n >= config_.threshold * (1 - 1e-12);  // sums of decimals: 0.8 must reach 0.8
    }
  }
}

ObstacleDetector::Cells ObstacleDetector::region_from(std::size_t seed, const CartesianGrid& grid) {
  Cells region{seed};
  visited_[seed] = 1;
  for (std::size_t at = 0; at < region.size(); ++at) {
    for_block(grid, grid.cell(region[at]), [&](std::size_t i) {
      if (!detected_[i] || visited_[i]) return;
      visited_[i] = 1;
      region.push_back(i);
    });
  }
  return region;
}

void ObstacleDetector::outline_region(const OccupancyView& view, const Cells& region) {
  double highest = 0;
  for (const std::size_t i : region) {
    for_block(view.grid, view.grid.cell(i), [&](std::size_t j) { highest = std::max(highest, view.probability[j]); });
  }
  const double enough = std::max(config_.threshold / 9 * (1 - 1e-12), highest / 2);
  Cells evidence;
  for (const std::size_t i : region) {
    own_[i] = 1;
    for_block(view.grid, view.grid.cell(i), [&](std::size_t j) {
      if (view.probability[j] >= enough && own_[j] != 2) {
        own_[j] = 2;  // once
        evidence.push_back(j);
      }
    });
  }
  std::sort(evidence.begin(), evidence.end());
  if (!evidence.empty()) split(view, evidence, own_);
  for (const std::size_t i : region) own_[i] = 0;
  for (const std::size_t i : evidence) own_[i] = 0;
}

void ObstacleDetector::split(const OccupancyView& view, Cells evidence, const std::vector<std::uint8_t>& own) {
  const Polygon hull = hull_of(view.grid, evidence);
  if (evidence.size() <= kSmallest || tight(view.grid, hull, own)) {
    obstacles_.push_back(describe(view, hull, evidence));
    return;
  }
  const Vector2d mean = mean_of(view.grid, evidence);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance_of(view.grid, evidence, mean));
  const Vector2d along = axes.eigenvectors().col(1);
  const auto middle = evidence.begin() + static_cast<std::ptrdiff_t>(evidence.size() / 2);
  std::nth_element(evidence.begin(), middle, evidence.end(), [&](std::size_t a, std::size_t b) {
    const double u = along.dot(view.grid.centre(view.grid.cell(a))), v = along.dot(view.grid.centre(view.grid.cell(b)));
    return u != v ? u < v : a < b;
  });
  Cells far(middle, evidence.end());
  evidence.erase(middle, evidence.end());
  split(view, std::move(evidence), own);
  split(view, std::move(far), own);
}

bool ObstacleDetector::tight(const CartesianGrid& grid, const Polygon& hull, const std::vector<std::uint8_t>& own) const {
  Vector2d low = hull.front(), high = hull.front();
  for (const Vector2d& p : hull) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const auto to_cell = [&](double v, int limit) { return std::clamp(static_cast<int>(std::floor(v / grid.cell_m)), 0, limit - 1); };
  int inside = 0, foreign = 0;
  for (int x = to_cell(low.x(), grid.cells_x); x <= to_cell(high.x(), grid.cells_x); ++x) {
    for (int y = to_cell(low.y(), grid.cells_y); y <= to_cell(high.y(), grid.cells_y); ++y) {
      if (!contains(hull, grid.centre({x, y}))) continue;
      ++inside;
      foreign += own[grid.index({x, y})] == 0;
    }
  }
  return foreign <= config_.tightness * inside;
}

Obstacle ObstacleDetector::describe(const OccupancyView& view, const Polygon& hull, const Cells& evidence) const {
  const double c = cos(view.heading_GL), s = sin(view.heading_GL);
  Eigen::Matrix2d R_LG;
  R_LG << c, s, -s, c;
  Obstacle o;
  for (const Vector2d& p : hull) o.outline.push_back(R_LG * (p - view.p_GL));
  o.nearest = nearest_point(o.outline, Vector2d::Zero());
  o.range_m = o.nearest.norm();
  const Vector2d mean = mean_of(view.grid, evidence);
  o.centre = R_LG * (mean - view.p_GL);
  o.covariance = R_LG * covariance_of(view.grid, evidence, mean) * R_LG.transpose();
  const Vector2d towards = o.range_m > 0 ? o.nearest : o.centre;
  o.bearing = Angle::radians(std::atan2(towards.y(), towards.x()));
  o.cells = static_cast<int>(evidence.size());
  for (const std::size_t i : evidence) {
    o.expected_cells += view.probability[i];
    double none = 1;
    for_block(view.grid, view.grid.cell(i), [&](std::size_t j) { none *= 1 - view.probability[j]; });
    o.existence = std::max(o.existence, 1 - none);
  }
  return o;
}

// What hides what ----------------------------------------------------------------------------------------------------

namespace {

/// Bearings, relative to that of the centre, that an outline spans seen from the vehicle.
std::pair<double, double> span_of(const Obstacle& o, double centre) {
  double low = 0, high = 0;
  for (const Vector2d& p : o.outline) {
    const double d = Angle::radians(std::atan2(p.y(), p.x()) - centre).wrapped().radians();
    low = std::min(low, d);
    high = std::max(high, d);
  }
  return {low, high};
}

bool is_multiple(double range, double of, double tolerance) {
  const double times = range / of;
  return times > 1.5 && times < 3.5 && std::abs(times - std::round(times)) <= tolerance * times;
}

}  // namespace

void mark_hidden(std::vector<Obstacle>& obstacles, double multiple_tolerance) {
  constexpr int kRays = 9;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    Obstacle& o = obstacles[i];
    if (o.range_m <= 0) continue;
    const double centre = std::atan2(o.centre.y(), o.centre.x());
    const auto [low, high] = span_of(o, centre);
    int seen = 0, hidden = 0, multiples = 0;
    for (int k = 0; k < kRays; ++k) {
      const double bearing = centre + low + (high - low) * (k + 0.5) / kRays;
      const Vector2d ray(std::cos(bearing), std::sin(bearing));
      const auto own = ray_hit(o.outline, Vector2d::Zero(), ray);
      if (!own) continue;
      ++seen;
      double nearest = *own;
      for (const Obstacle& other : obstacles) {
        if (&other == &o || other.range_m >= *own) continue;
        const auto hit = ray_hit(other.outline, Vector2d::Zero(), ray);
        if (hit) nearest = std::min(nearest, *hit);
      }
      if (nearest < *own) {
        ++hidden;
        multiples += is_multiple(*own, nearest, multiple_tolerance);
      }
    }
    o.behind = seen > 0 && 2 * hidden >= seen;
    o.possible_multiple = o.behind && 2 * multiples >= hidden;
  }
}

}  // namespace isobath
