#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/roadmap/grown_obstacles.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kGraze = 1e-9;  // m that a leg may go in
constexpr int kMaxCells = 256;   // a side of the index

double leg_to_leg(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const Vector2d way = b - a, side = d - c;
  const double turn = cross(way, side);
  if (turn != 0) {
    const double s = cross(c - a, side) / turn, t = cross(c - a, way) / turn;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) return 0;
  }
  return std::sqrt(
      std::min({(nearest_on_segment(c, d, a) - a).squaredNorm(), (nearest_on_segment(c, d, b) - b).squaredNorm(),
                (nearest_on_segment(a, b, c) - c).squaredNorm(), (nearest_on_segment(a, b, d) - d).squaredNorm()}));
}

}  // namespace

GrownObstacles::GrownObstacles(std::vector<GrownPart> parts) : parts_(std::move(parts)) {
  double sizes = 0;
  for (const GrownPart& part : parts_) {
    ISOBATH_ASSERT(part.grown.size() >= 3 && !part.outline.empty());
    AlignedBox2d box;
    first_side_.push_back(sides_.size());
    for (std::size_t i = 0; i < part.grown.size(); ++i) {
      const Vector2d& p = part.grown[i];
      const Vector2d way = (part.grown[(i + 1) % part.grown.size()] - p).normalized();
      const Vector2d normal(-way.y(), way.x());
      sides_.push_back({normal, normal.dot(p) + kGraze});
      box.extend(p);
    }
    boxes_.push_back(box);
    all_.extend(box);
    sizes += box.sizes().maxCoeff();
  }
  first_side_.push_back(sides_.size());
  if (parts_.empty()) return;
  cell_ = std::max({sizes / static_cast<double>(parts_.size()), all_.sizes().maxCoeff() / (kMaxCells - 1), 1e-6});
  columns_ = 1 + static_cast<int>(all_.sizes().x() / cell_);
  rows_ = 1 + static_cast<int>(all_.sizes().y() / cell_);
  const auto visit = [&](const auto& at) {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      for (int y = row(boxes_[i].min().y()); y <= row(boxes_[i].max().y()); ++y) {
        for (int x = column(boxes_[i].min().x()); x <= column(boxes_[i].max().x()); ++x) {
          at(y * columns_ + x, static_cast<int>(i));
        }
      }
    }
  };
  first_in_cell_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  visit([&](std::size_t cell, int) { ++first_in_cell_[cell + 1]; });
  for (std::size_t i = 1; i < first_in_cell_.size(); ++i) first_in_cell_[i] += first_in_cell_[i - 1];
  in_cell_.resize(first_in_cell_.back());
  std::vector<std::size_t> filled(first_in_cell_.begin(), first_in_cell_.end() - 1);
  visit([&](std::size_t cell, int part) { in_cell_[filled[cell]++] = part; });
}

int GrownObstacles::column(double x) const {
  return static_cast<int>(std::clamp(std::floor((x - all_.min().x()) / cell_), 0.0, columns_ - 1.0));
}
int GrownObstacles::row(double y) const {
  return static_cast<int>(std::clamp(std::floor((y - all_.min().y()) / cell_), 0.0, rows_ - 1.0));
}

/// Clips the leg by every side; what is left is inside.
bool GrownObstacles::meets(std::size_t part, const Vector2d& a, const Vector2d& b) const {
  double from = 0, to = 1;
  for (std::size_t i = first_side_[part]; i < first_side_[part + 1]; ++i) {
    const double at_a = sides_[i].normal.dot(a) - sides_[i].offset, at_b = sides_[i].normal.dot(b) - sides_[i].offset;
    if (at_a <= 0 && at_b <= 0) return false;
    if (at_a > 0 && at_b > 0) continue;
    const double cut = at_a / (at_a - at_b);
    (at_a > 0 ? to : from) = at_a > 0 ? std::min(to, cut) : std::max(from, cut);
    if (from >= to) return false;
  }
  return true;
}

int GrownObstacles::blocker(const Vector2d& a, const Vector2d& b) const {
  if (parts_.empty()) return kNone;
  const AlignedBox2d box = AlignedBox2d(a.cwiseMin(b), a.cwiseMax(b)).intersection(all_);
  if (box.isEmpty()) return kNone;
  const int first = column(box.min().x()), last = column(box.max().x());
  const bool forth = a.x() <= b.x();  // columns are visited from a to b, so that what stops the leg is found early
  for (int i = 0; i <= last - first; ++i) {
    const int x = forth ? first + i : last - i;
    double low = box.min().y(), high = box.max().y();
    if (a.x() != b.x()) {  // the part of the leg in this column
      const double slope = (b.y() - a.y()) / (b.x() - a.x());
      const double left = all_.min().x() + x * cell_;
      double y0 = a.y() + slope * (left - a.x()), y1 = y0 + slope * cell_;
      if (y0 > y1) std::swap(y0, y1);
      low = std::max(low, y0 - 1e-6 * cell_);
      high = std::min(high, y1 + 1e-6 * cell_);
    }
    for (int y = row(low); y <= row(high); ++y) {
      const std::size_t cell = y * columns_ + x;
      for (std::size_t k = first_in_cell_[cell]; k < first_in_cell_[cell + 1]; ++k) {
        const auto part = static_cast<std::size_t>(in_cell_[k]);
        if (boxes_[part].intersects(box) && meets(part, a, b)) return in_cell_[k];
      }
    }
  }
  return kNone;
}

std::vector<int> GrownObstacles::covering(const Vector2d& p) const {
  std::vector<int> found;
  if (parts_.empty() || !all_.contains(p)) return found;
  const std::size_t cell = row(p.y()) * columns_ + column(p.x());
  for (std::size_t k = first_in_cell_[cell]; k < first_in_cell_[cell + 1]; ++k) {
    if (meets(static_cast<std::size_t>(in_cell_[k]), p, p)) found.push_back(in_cell_[k]);
  }
  return found;
}

double GrownObstacles::distance(const Vector2d& a, const Vector2d& b, double most) const {
  const AlignedBox2d leg(a.cwiseMin(b), a.cwiseMax(b));
  double least = most;
  for (std::size_t i = 0; i < parts_.size() && least > 0; ++i) {
    if (boxes_[i].squaredExteriorDistance(leg) >= least * least) continue;  // the box of what is larger
    const Polygon& outline = parts_[i].outline;
    if (contains(outline, a)) return 0;
    for (std::size_t k = 0; k < outline.size(); ++k) {
      least = std::min(least, leg_to_leg(a, b, outline[k], outline[(k + 1) % outline.size()]));
    }
  }
  return least;
}

}  // namespace isobath
