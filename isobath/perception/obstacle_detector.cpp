#include <algorithm>
#include <cmath>
#include <Eigen/Eigenvalues>
#include <isobath/perception/obstacle_detector.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
constexpr int kBlock = 1;             // half width of the 3 x 3 block
constexpr double kRounding = 1e-9;    // log-odds to probabilities and back: 0.8 must reach 0.8
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

const std::vector<Obstacle>& ObstacleDetector::detect(const BodyGrid& grid, Time first_ping) {
  grid_ = &grid;
  cells_ = grid.cells();
  first_ping_ = first_ping;
  obstacles_.clear();
  sum_blocks();
  visited_.assign(cells_.size(), 0);
  own_.assign(cells_.size(), 0);
  for (std::size_t i = 0; i < detected_.size(); ++i) {
    if (detected_[i] && !visited_[i]) outline_region(region_from(i));
  }
  std::sort(obstacles_.begin(), obstacles_.end(), [](const Obstacle& a, const Obstacle& b) {
    return std::pair(a.range_m, a.bearing.radians()) < std::pair(b.range_m, b.bearing.radians());
  });
  mark_hidden(obstacles_, config_.multiple_tolerance);
  return obstacles_;
}

void ObstacleDetector::sum_blocks() {
  const auto log_odds = grid_->log_odds();
  probability_.resize(cells_.size());
  for (std::size_t i = 0; i < log_odds.size(); ++i) probability_[i] = probability_of(log_odds[i]);
  count_.assign(cells_.size(), 0);
  detected_.assign(cells_.size(), 0);
  const auto width = static_cast<std::size_t>(cells_.cells_y);
  std::vector<double> columns(width);  // sums over three neighbours in x
  for (int x = 0; x < cells_.cells_x; ++x) {
    std::fill(columns.begin(), columns.end(), 0.0);
    for (int row = std::max(0, x - 1); row <= std::min(cells_.cells_x - 1, x + 1); ++row) {
      const double* p = probability_.data() + cells_.index({row, 0});
      for (std::size_t y = 0; y < width; ++y) columns[y] += p[y];
    }
    for (std::size_t y = 0; y < width; ++y) {
      const double n = columns[y] + (y > 0 ? columns[y - 1] : 0) + (y + 1 < width ? columns[y + 1] : 0);
      const std::size_t i = cells_.index({x, static_cast<int>(y)});
      count_[i] = n;
      detected_[i] = n >= config_.threshold * (1 - kRounding);
    }
  }
}

ObstacleDetector::Cells ObstacleDetector::region_from(std::size_t seed) {
  Cells region{seed};
  visited_[seed] = 1;
  for (std::size_t at = 0; at < region.size(); ++at) {
    for_block(cells_, cells_.cell(region[at]), [&](std::size_t i) {
      if (!detected_[i] || visited_[i]) return;
      visited_[i] = 1;
      region.push_back(i);
    });
  }
  return region;
}

void ObstacleDetector::outline_region(const Cells& region) {
  double highest = 0;
  for (const std::size_t i : region) {
    own_[i] = 1;
    for_block(cells_, cells_.cell(i), [&](std::size_t j) { highest = std::max(highest, probability_[j]); });
  }
  const double enough = std::max(config_.threshold / 9 * (1 - kRounding), highest / 2);
  Cells evidence;
  for (const std::size_t i : region) {
    for_block(cells_, cells_.cell(i), [&](std::size_t j) {
      if (probability_[j] < enough || own_[j] == 2) return;
      own_[j] = 2;  // once
      evidence.push_back(j);
    });
  }
  std::sort(evidence.begin(), evidence.end());
  split(evidence);
  for (const Cells* cells : {&region, static_cast<const Cells*>(&evidence)}) {
    for (const std::size_t i : *cells) own_[i] = 0;
  }
}

void ObstacleDetector::split(Cells evidence) {
  const Polygon hull = hull_of(cells_, evidence);
  if (evidence.size() <= kSmallest || tight(hull)) {
    obstacles_.push_back(describe(hull, evidence));
    return;
  }
  const Vector2d mean = mean_of(cells_, evidence);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance_of(cells_, evidence, mean));
  const Vector2d along = axes.eigenvectors().col(1);
  const auto middle = evidence.begin() + static_cast<std::ptrdiff_t>(evidence.size() / 2);
  std::nth_element(evidence.begin(), middle, evidence.end(), [&](std::size_t a, std::size_t b) {
    const double u = along.dot(cells_.centre(cells_.cell(a))), v = along.dot(cells_.centre(cells_.cell(b)));
    return u != v ? u < v : a < b;
  });
  Cells far(middle, evidence.end());
  evidence.erase(middle, evidence.end());
  split(std::move(evidence));
  split(std::move(far));
}

bool ObstacleDetector::tight(const Polygon& hull) const {
  Vector2d low = hull.front(), high = hull.front();
  for (const Vector2d& p : hull) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const auto to_cell = [this](double v, int limit) {
    return std::clamp(static_cast<int>(std::floor(v / cells_.cell_m)), 0, limit - 1);
  };
  int inside = 0, foreign = 0;
  for (int x = to_cell(low.x(), cells_.cells_x); x <= to_cell(high.x(), cells_.cells_x); ++x) {
    for (int y = to_cell(low.y(), cells_.cells_y); y <= to_cell(high.y(), cells_.cells_y); ++y) {
      if (!contains(hull, cells_.centre({x, y}))) continue;
      ++inside;
      foreign += own_[cells_.index({x, y})] == 0;
    }
  }
  return foreign <= config_.tightness * inside;
}

Obstacle ObstacleDetector::describe(const Polygon& hull, const Cells& evidence) const {
  Obstacle o;
  for (const Vector2d& p : hull) o.outline.push_back(grid_->to_level_body(p));
  o.nearest = nearest_point(o.outline, Vector2d::Zero());
  o.range_m = o.nearest.norm();
  const Vector2d mean = mean_of(cells_, evidence);
  o.centre = grid_->to_level_body(mean);
  const Eigen::Rotation2Dd R_LG(-grid_->heading().radians());
  o.covariance = R_LG * covariance_of(cells_, evidence, mean) * R_LG.inverse();
  const Vector2d towards = o.range_m > 0 ? o.nearest : o.centre;
  o.bearing = Angle::radians(std::atan2(towards.y(), towards.x())).wrapped_positive();
  std::uint32_t last_hit_ms = 0;
  for (const std::size_t i : evidence) {
    double none = 1;
    for_block(cells_, cells_.cell(i), [&](std::size_t j) { none *= 1 - probability_[j]; });
    o.existence = std::max(o.existence, 1 - none);
    o.hits += grid_->evidence()[i].hits;
    last_hit_ms = std::max(last_hit_ms, grid_->evidence()[i].last_hit_ms);
  }
  o.last_hit = first_ping_ + std::chrono::milliseconds(last_hit_ms);
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
