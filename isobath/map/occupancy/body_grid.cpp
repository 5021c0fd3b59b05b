#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <numbers>
#include <string>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kTurnStep = std::numbers::pi / 180;  // S6-23

Matrix2d turn_matrix(Angle a) {
  Matrix2d r;
  r << cos(a), -sin(a), sin(a), cos(a);
  return r;
}

void check(const BodyGridConfig& c) {
  const auto wrong = [](const char* key, const std::string& problem, const char* allowed, const char* advice) {
    Place place;
    place.key = key;
    throw Error(problem, place, allowed, advice);
  };
  if (!(c.cell_m > 0) || !std::isfinite(c.cell_m)) wrong("cell_m", "no cell size", "above 0 m", "");
  if (c.cells_x < 1 || c.cells_y < 1 || c.cells_x > 16384 || c.cells_y > 16384) {
    wrong("cells_x, cells_y", "the grid has no usable size", "1 .. 16384 cells a side", "");
  }
  if (!(c.home_x >= 0 && c.home_x <= 1 && c.home_y >= 0 && c.home_y <= 1)) {
    wrong("home_x, home_y", "the vehicle lies outside its grid", "0 .. 1", "");
  }
  if (!(c.p_min > 0 && c.p_min < c.prior)) wrong("p_min", "no room below the prior", "above 0, below prior", "");
  if (!(9 * c.prior < c.threshold)) {
    wrong("prior", std::to_string(c.prior) + " makes unseen water an obstacle: nine unseen cells reach the threshold",
          "below threshold / 9", "lower the prior or raise the threshold");
  }
  if (!(c.diffuse_at > 0 && c.diffuse_at <= 0.5)) wrong("diffuse_at", "out of range", "above 0, up to 0.5 cells", "");
}

Cell home_of(const BodyGridConfig& c) {
  return {std::min(static_cast<int>(c.home_x * c.cells_x), c.cells_x - 1),
          std::min(static_cast<int>(c.home_y * c.cells_y), c.cells_y - 1)};
}

// Moves the contents by (dx, dy) cells; cells that enter the grid become `fill`.
template <class T>
void move_cells(std::vector<T>& field, const CartesianGrid& grid, int dx, int dy, const T& fill) {
  if (std::abs(dx) >= grid.cells_x || std::abs(dy) >= grid.cells_y) {
    std::fill(field.begin(), field.end(), fill);
    return;
  }
  const std::ptrdiff_t shift = static_cast<std::ptrdiff_t>(dx) * grid.cells_y + dy;
  if (shift > 0) {
    std::copy_backward(field.begin(), field.end() - shift, field.end());
  } else if (shift < 0) {
    std::copy(field.begin() - shift, field.end(), field.begin());
  }
  for (int x = 0; x < grid.cells_x; ++x) {
    const auto row = field.begin() + static_cast<std::ptrdiff_t>(grid.index({x, 0}));
    if (x - dx < 0 || x - dx >= grid.cells_x) {
      std::fill(row, row + grid.cells_y, fill);
    } else if (dy > 0) {
      std::fill(row, row + dy, fill);
    } else if (dy < 0) {
      std::fill(row + grid.cells_y + dy, row + grid.cells_y, fill);
    }
  }
}

struct SmallPolygon {
  std::array<Vector2d, 8> corners;  // a square cut by the four sides of another
  int count = 0;
};

SmallPolygon cut(const SmallPolygon& in, const Vector2d& normal, double least) {
  SmallPolygon out;
  for (int i = 0; i < in.count; ++i) {
    const Vector2d& a = in.corners[i];
    const Vector2d& b = in.corners[i + 1 < in.count ? i + 1 : 0];
    const double da = normal.dot(a) - least;
    const double db = normal.dot(b) - least;
    if (da >= 0) out.corners[out.count++] = a;
    if ((da >= 0) != (db >= 0)) out.corners[out.count++] = a + da / (da - db) * (b - a);
  }
  return out;
}

// Area of the part of a square within the unit square at `low`.
double unit_square_overlap(const SmallPolygon& square, const Vector2d& low) {
  SmallPolygon part = cut(square, {1, 0}, low.x());
  part = cut(part, {-1, 0}, -low.x() - 1);
  part = cut(part, {0, 1}, low.y());
  part = cut(part, {0, -1}, -low.y() - 1);
  double twice = 0;
  for (int i = 0; i < part.count; ++i) {
    twice += cross(part.corners[i], part.corners[i + 1 < part.count ? i + 1 : 0]);
  }
  return std::max(0.0, twice / 2);
}

}  // namespace

double log_odds_of(double p) { return std::log(p / (1 - p)); }
double probability_of(double log_odds) { return 1 / (1 + std::exp(-log_odds)); }

std::vector<Field> fields(BodyGridConfig& c) {
  using C = BodyGridConfig;
  return {
      Field::real("cell_m", &c.cell_m, {0.005, 100}, "m", "Edge of a cell."),
      Field::integer("cells_x", &c.cells_x, {1, 16384}, "cells", "Cells along the vehicle's first heading."),
      Field::integer("cells_y", &c.cells_y, {1, 16384}, "cells", "Cells across the vehicle's first heading."),
      Field::real("home_x", &c.home_x, {0, 1}, "1", "The vehicle's position in the grid, from the rear edge."),
      Field::real("home_y", &c.home_y, {0, 1}, "1", "The vehicle's position in the grid, from the port edge."),
      Field::real(
          "prior", &c.prior, {1e-6, 0.2}, "1",
          "Probability that an unseen cell is occupied; map.fit lowers it where the bins of a scanning sonar are "
          "shorter than a cell."),
      Field::real("p_min", &c.p_min, {1e-9, 0.1}, "1", "Probabilities stay within p_min and 1 - p_min."),
      Field::choice("shifting", &c.shifting,
                    {{"whole_cells", C::Shifting::kWholeCells},
                     {"interpolated", C::Shifting::kInterpolated},
                     {"printed", C::Shifting::kPrinted}},
                    "How displacements move the contents; all but whole_cells blur them and exist for comparison."),
      Field::choice("turning", &c.turning, {{"exact", C::Turning::kExact}, {"resampled", C::Turning::kResampled}},
                    "Whether the heading is carried beside the grid, or turns its contents in steps of 1 degree."),
      Field::choice("moved", &c.moved, {{"sum", C::Moved::kSum}, {"any_target", C::Moved::kAnyTarget}},
                    "Whether shares of moved cells add up as expectations or as chances of at least one target."),
      Field::real("diffuse_at", &c.diffuse_at, {0.01, 0.5}, "cells",
                  "The uncertainty of the motion accumulates; it is applied when its standard deviation reaches this."),
  };
}

BodyGrid::BodyGrid(const BodyGridConfig& config)
    : config_((check(config), config)),
      cells_{config.cells_x, config.cells_y, config.cell_m},
      home_(home_of(config)),
      log_odds_max_(-log_odds_of(config.p_min)),
      log_odds_prior_(log_odds_of(config.prior)),
      free_below_(log_odds_prior_ - std::numbers::ln2),
      log_odds_(cells_.size(), log_odds_prior_),
      evidence_(cells_.size()),
      old_(cells_.size()),
      new_(cells_.size()) {}

Vector2d BodyGrid::to_level_body(const Vector2d& p_G) const { return turn_matrix(-heading_) * (p_G - position()); }
Vector2d BodyGrid::from_level_body(const Vector2d& p_L) const { return turn_matrix(heading_) * p_L + position(); }

double BodyGrid::probability(Cell c) const { return probability_of(log_odds_[cells_.index(c)]); }

void BodyGrid::set_probability(Cell c, double p) {
  log_odds_[cells_.index(c)] = std::clamp(log_odds_of(p), -log_odds_max_, log_odds_max_);
}

void BodyGrid::note_hit(std::size_t index, Time time) {
  if (first_hit_ == Time::max()) first_hit_ = time;
  const auto since = std::chrono::duration_cast<std::chrono::milliseconds>(time - first_hit_).count();
  HitEvidence& e = evidence_[index];
  ++e.hits;
  e.last_ms = static_cast<std::uint32_t>(std::clamp<std::int64_t>(since, e.last_ms, UINT32_MAX));
}

void BodyGrid::clear() {
  std::fill(log_odds_.begin(), log_odds_.end(), log_odds_prior_);
  std::fill(evidence_.begin(), evidence_.end(), HitEvidence{});
  pending_.setZero();
  pending_turn_ = 0;
}

void BodyGrid::move(const Vector2d& displacement, Angle turn, const Matrix2d& covariance, double turn_variance) {
  const Matrix2d R_GL = turn_matrix(heading_);
  const Vector2d step = R_GL * displacement;
  const Matrix2d spread = R_GL * covariance * R_GL.transpose();
  if (config_.shifting == BodyGridConfig::Shifting::kWholeCells) {
    offset_ += step;
    scroll();
    diffuse(spread);
  } else if (!step.isZero(0) || !spread.isZero(0)) {
    interpolate(-step / cells_.cell_m, spread / (cells_.cell_m * cells_.cell_m));
  }
  heading_ = (heading_ + turn).wrapped();
  if (config_.turning == BodyGridConfig::Turning::kResampled) {
    const double steps = std::trunc(heading_.radians() / kTurnStep + std::copysign(1e-9, heading_.radians()));
    if (steps != 0) resample(Angle::radians(steps * kTurnStep));
  }
  if (turn_variance > 0) diffuse_turn(turn_variance);
}

// Rounding to the nearest cell keeps the vehicle within half a cell of its home (S6-25).
void BodyGrid::scroll() {
  const double x = std::floor(offset_.x() / cells_.cell_m + 0.5);
  const double y = std::floor(offset_.y() / cells_.cell_m + 0.5);
  if (x == 0 && y == 0) return;
  offset_ -= Vector2d(x, y) * cells_.cell_m;
  if (std::abs(x) >= cells_.cells_x || std::abs(y) >= cells_.cells_y) {
    clear();
  } else {
    scroll_cells(-static_cast<int>(x), -static_cast<int>(y));
  }
}

void BodyGrid::scroll_cells(int dx, int dy) {
  move_cells(log_odds_, cells_, dx, dy, log_odds_prior_);
  move_cells(evidence_, cells_, dx, dy, HitEvidence{});
}

void BodyGrid::diffuse(const Matrix2d& covariance) {
  pending_ += covariance / (cells_.cell_m * cells_.cell_m);
  const double worth = config_.diffuse_at * config_.diffuse_at;
  // One kernel takes a variance of at most 0.5; a step that would need many has forgotten everything anyway.
  for (int pass = 0; pass < 16 && std::max(pending_(0, 0), pending_(1, 1)) >= worth; ++pass) {
    const double share = std::min(1.0, 0.5 / std::max(pending_(0, 0), pending_(1, 1)));
    convolve(MotionKernel::diffusion(share * pending_));
    pending_ *= 1 - share;
  }
}

/// Waits until the farthest cell of the grid moves by a share of a cell (S6-68).
void BodyGrid::diffuse_turn(double variance) {
  pending_turn_ += variance;
  const Vector2d low = position();
  const Vector2d high = Vector2d(cells_.cells_x, cells_.cells_y) * cells_.cell_m - low;
  const double farthest = low.cwiseMax(high).squaredNorm() / (cells_.cell_m * cells_.cell_m);
  const double worth = config_.diffuse_at * config_.diffuse_at;
  // After 16 passes of at most 0.5 cells2 the outer cells have forgotten everything anyway.
  for (int pass = 0; pass < 16 && pending_turn_ * farthest >= worth; ++pass) {
    const double share = std::min(pending_turn_, 0.5 / farthest);
    spread_along_circles(share);
    pending_turn_ -= share;
  }
}

/// A cell becomes the mean of what may have been turned into it.
void BodyGrid::spread_along_circles(double variance) {
  read_probabilities();
  const Vector2d axis = position() / cells_.cell_m;
  for (int x = 0; x < cells_.cells_x; ++x) {
    for (int y = 0; y < cells_.cells_y; ++y) {
      const Vector2d from = Vector2d(x + 0.5, y + 0.5) - axis;
      const Vector2d along(-from.y(), from.x());
      const MotionKernel kernel = MotionKernel::diffusion(variance * along * along.transpose());
      double sum = 0, none = 1;
      for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
          const Cell source{x + i, y + j};
          const double w = kernel.weight(i, j);
          const double p = cells_.contains(source) ? old_[cells_.index(source)] : config_.prior;
          sum += w * p;
          none *= 1 - w * p;
        }
      }
      new_[cells_.index({x, y})] = combined(sum, none);
    }
  }
  write_probabilities();
}

void BodyGrid::interpolate(const Vector2d& content_shift, const Matrix2d& covariance) {
  if (content_shift.cwiseAbs().maxCoeff() >= std::max(cells_.cells_x, cells_.cells_y)) return clear();
  const bool printed = config_.shifting == BodyGridConfig::Shifting::kPrinted && !covariance.isZero(0);
  convolve(printed ? MotionKernel::printed(content_shift, covariance)
                   : MotionKernel::expected_overlap(content_shift, covariance));
  evidence_offset_ += content_shift;
  const Vector2d whole = (evidence_offset_.array() + 0.5).floor();
  evidence_offset_ -= whole;
  move_cells(evidence_, cells_, static_cast<int>(whole.x()), static_cast<int>(whole.y()), HitEvidence{});
}

void BodyGrid::read_probabilities() {
  std::transform(log_odds_.begin(), log_odds_.end(), old_.begin(), probability_of);
}

void BodyGrid::write_probabilities() {
  const double high = 1 - config_.p_min;
  std::transform(new_.begin(), new_.end(), log_odds_.begin(),
                 [&](double p) { return log_odds_of(std::clamp(p, config_.p_min, high)); });
}

// Ganesan 2015, equation 3.18; cells outside the grid have the prior (S6-24, S6-E22).
void BodyGrid::convolve(const MotionKernel& kernel) {
  read_probabilities();
  const bool sum_up = config_.moved == BodyGridConfig::Moved::kSum;
  std::fill(new_.begin(), new_.end(), sum_up ? 0.0 : 1.0);
  double total = 0;
  for (int i = kernel.first_x(); i < kernel.first_x() + kernel.size_x(); ++i) {
    for (int j = kernel.first_y(); j < kernel.first_y() + kernel.size_y(); ++j) {
      const double w = kernel.weight(i, j);
      total += w;
      if (w == 0) continue;
      for (int x = 0; x < cells_.cells_x; ++x) {
        const bool inside = x - i >= 0 && x - i < cells_.cells_x;
        const double* from = old_.data() + (inside ? cells_.index({x - i, 0}) : 0);
        double* to = new_.data() + cells_.index({x, 0});
        const int first = inside ? std::clamp(j, 0, cells_.cells_y) : cells_.cells_y;
        const int last = inside ? std::clamp(cells_.cells_y + j, first, cells_.cells_y) : cells_.cells_y;
        const auto add = [&](int y, double p) { sum_up ? to[y] += w * p : to[y] *= 1 - w * p; };
        for (int y = 0; y < first; ++y) add(y, config_.prior);
        for (int y = first; y < last; ++y) add(y, from[y - j]);
        for (int y = last; y < cells_.cells_y; ++y) add(y, config_.prior);
      }
    }
  }
  const double uncovered = std::max(0.0, 1 - total) * config_.prior;
  for (double& p : new_) p = sum_up ? p + uncovered : 1 - p * (1 - uncovered);
  write_probabilities();
}

// Ganesan 2015, equation 3.20, with the necessary reach (S6-23, S6-E12). Contents turn by -turn about the vehicle.
void BodyGrid::resample(Angle turn) {
  heading_ = (heading_ - turn).wrapped();
  read_probabilities();
  const Matrix2d R = turn_matrix(turn);
  const Vector2d axis = position() / cells_.cell_m;
  std::vector<HitEvidence> evidence(evidence_.size());
  for (int x = 0; x < cells_.cells_x; ++x) {
    for (int y = 0; y < cells_.cells_y; ++y) {
      const Vector2d centre = axis + R * (Vector2d(x + 0.5, y + 0.5) - axis);
      SmallPolygon square;
      for (const Vector2d& corner : {Vector2d(-.5, -.5), Vector2d(.5, -.5), Vector2d(.5, .5), Vector2d(-.5, .5)}) {
        square.corners[square.count++] = centre + R * corner;
      }
      double sum = 0;
      double none = 1;
      double covered = 0;
      const int low_x = static_cast<int>(std::floor(centre.x() - 0.71));
      const int low_y = static_cast<int>(std::floor(centre.y() - 0.71));
      for (int i = low_x; i <= static_cast<int>(std::floor(centre.x() + 0.71)); ++i) {
        for (int j = low_y; j <= static_cast<int>(std::floor(centre.y() + 0.71)); ++j) {
          if (!cells_.contains({i, j})) continue;
          const double w = unit_square_overlap(square, Vector2d(i, j));
          const double p = old_[cells_.index({i, j})];
          sum += w * p;
          none *= 1 - w * p;
          covered += w;
        }
      }
      const double rest = std::max(0.0, 1 - covered) * config_.prior;
      new_[cells_.index({x, y})] = combined(sum + rest, none * (1 - rest));
      if (const auto from = cells_.cell_at(centre * cells_.cell_m)) {
        evidence[cells_.index({x, y})] = evidence_[cells_.index(*from)];
      }
    }
  }
  evidence_.swap(evidence);
  write_probabilities();
}

}  // namespace isobath
