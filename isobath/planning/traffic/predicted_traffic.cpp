#include <algorithm>
#include <cmath>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/traffic/predicted_traffic.hpp>

namespace isobath {
namespace {

constexpr double kCell_m = 4;
constexpr double kOutlinePiece_s = 0.125;

bool is_still_outline(const MovingBody& body) { return body.outline.size() > 1 && is_still(body, 0); }

/// Between two segments; 0 where they cross.
double segment_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                        const Eigen::Vector2d& d) {
  const auto apart = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& p) {
    return (nearest_on_segment(from, to, p) - p).norm();
  };
  const bool cross_cd = (cross(b - a, c - a) < 0) != (cross(b - a, d - a) < 0);
  if (cross_cd && (cross(d - c, a - c) < 0) != (cross(d - c, b - c) < 0)) return 0;
  return std::min({apart(a, b, c), apart(a, b, d), apart(c, d, a), apart(c, d, b)});
}

/// Lists of members by cell: `cells(visit)` calls visit(cell, member) for each pair, always in the same order.
template <class Cells>
void sort_into_cells(std::size_t count, const Cells& cells, std::vector<std::int32_t>& first,
                     std::vector<std::int32_t>& entries) {
  first.assign(count + 1, 0);
  cells([&](int cell, std::size_t) { ++first[cell + 1]; });
  for (std::size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
  entries.resize(first.back());
  // Each member goes to the place before the end of its cell; the ends become the starts.
  cells([&](int cell, std::size_t i) { entries[first[cell]++] = static_cast<std::int32_t>(i); });
  std::shift_right(first.begin(), first.end(), 1);
  first.front() = 0;
}

}  // namespace

int PredictedTraffic::cell_of(double from_middle) const {
  return static_cast<int>(std::clamp((from_middle + steps_.half_side_m) / kCell_m, 0.0, side_ - 1.0));
}

PredictedTraffic::CellRange PredictedTraffic::cells_of(std::size_t body, int step) const {
  const double from = step * steps_.step_s, to = from + steps_.step_s;
  const double reach = radius_[step * x_.size() + body] + 0.5 * steps_.piece_m;
  const double x0 = x_[body] + vx_[body] * from - steps_.middle_W.x(), x1 = x0 + vx_[body] * (to - from);
  const double y0 = y_[body] + vy_[body] * from - steps_.middle_W.y(), y1 = y0 + vy_[body] * (to - from);
  return {cell_of(std::min(x0, x1) - reach), cell_of(std::max(x0, x1) + reach), cell_of(std::min(y0, y1) - reach),
          cell_of(std::max(y0, y1) + reach)};
}

void PredictedTraffic::build(std::span<const MovingBody> bodies, const TrafficSteps& steps) {
  steps_ = steps;
  bodies_ = bodies;
  checks_ = 0;
  side_ = std::max(1, static_cast<int>(std::ceil(2 * steps.half_side_m / kCell_m)));
  const std::size_t n = bodies.size(), cells = static_cast<std::size_t>(side_) * side_ * steps.count;
  for (auto* column : {&x_, &y_, &vx_, &vy_, &age_s_}) column->resize(n);
  for (auto* column : {&radius_, &radius2_, &growth_}) column->resize(n * steps.count);
  for (std::size_t i = 0; i < n; ++i) {
    const MovingBody& body = bodies[i];
    age_s_[i] = to_seconds(steps.start - body.time);
    x_[i] = body.p_W.x() + age_s_[i] * body.velocity_W.x();
    y_[i] = body.p_W.y() + age_s_[i] * body.velocity_W.y();
    vx_[i] = body.velocity_W.x();
    vy_[i] = body.velocity_W.y();
    const double shape = circumscribed_radius(body);
    for (int k = 0; k < steps.count; ++k) {
      const std::size_t at = k * n + i;
      growth_[at] = predicted_growth(body, age_s_[i] + (k + 1) * steps.step_s, steps.sigmas);
      radius_[at] = shape + steps.distance_m + growth_[at];
      radius2_[at] = radius_[at] * radius_[at];
    }
  }
  const auto all_cells = [&](const auto& visit) {
    for (int k = 0; k < steps.count; ++k) {
      for (std::size_t i = 0; i < n; ++i) {
        if (is_still_outline(bodies[i])) continue;
        const CellRange range = cells_of(i, k);
        for (int y = range.y0; y <= range.y1; ++y) {
          for (int x = range.x0; x <= range.x1; ++x) visit((k * side_ + y) * side_ + x, i);
        }
      }
    }
  };
  sort_into_cells(cells, all_cells, first_, entries_);
  build_sides(bodies);
}

PredictedTraffic::CellRange PredictedTraffic::cells_of(const StillSide& side) const {
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(side.kept_m + 0.5 * steps_.piece_m);
  const Eigen::Vector2d low = side.a_W.cwiseMin(side.b_W) - reach - steps_.middle_W;
  const Eigen::Vector2d high = side.a_W.cwiseMax(side.b_W) + reach - steps_.middle_W;
  return {cell_of(low.x()), cell_of(high.x()), cell_of(low.y()), cell_of(high.y())};
}

void PredictedTraffic::build_sides(std::span<const MovingBody> bodies) {
  sides_.clear();
  for (const MovingBody& body : bodies) {
    if (!is_still_outline(body)) continue;
    const double kept_m = body.radius_m + predicted_growth(body, 0, steps_.sigmas) + steps_.distance_m;
    for (std::size_t i = 0; i < body.outline.size(); ++i) {
      const Eigen::Vector2d& next = body.outline[(i + 1) % body.outline.size()];
      sides_.push_back({body.p_W + body.outline[i], body.p_W + next, kept_m});
    }
  }
  const auto all_cells = [&](const auto& visit) {
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const CellRange range = cells_of(sides_[i]);
      for (int y = range.y0; y <= range.y1; ++y) {
        for (int x = range.x0; x <= range.x1; ++x) visit(y * side_ + x, i);
      }
    }
  };
  if (!sides_.empty()) sort_into_cells(static_cast<std::size_t>(side_) * side_, all_cells, first_side_, side_entries_);
}

bool PredictedTraffic::sides_are_clear(const Eigen::Vector2d& a_W, const Eigen::Vector2d& b_W) const {
  const Eigen::Vector2d middle = 0.5 * (a_W + b_W) - steps_.middle_W;
  const std::size_t cell = static_cast<std::size_t>(cell_of(middle.y())) * side_ + cell_of(middle.x());
  checks_ += first_side_[cell + 1] - first_side_[cell];
  for (int e = first_side_[cell]; e < first_side_[cell + 1]; ++e) {
    const StillSide& side = sides_[side_entries_[e]];
    if (segment_distance(a_W, b_W, side.a_W, side.b_W) < side.kept_m) return false;
  }
  return true;
}

bool PredictedTraffic::is_free(int step, double start_s, double duration_s, const Eigen::Vector2d& a_W,
                               const Eigen::Vector2d& b_W) const {
  const Eigen::Vector2d middle = 0.5 * (a_W + b_W) - steps_.middle_W;
  const std::size_t cell = (static_cast<std::size_t>(step) * side_ + cell_of(middle.y())) * side_ + cell_of(middle.x());
  const double ux = (b_W.x() - a_W.x()) / duration_s, uy = (b_W.y() - a_W.y()) / duration_s;
  const double* radius2 = radius2_.data() + step * x_.size();
  const int last = first_[cell + 1];
  checks_ += last - first_[cell];
  for (int e = first_[cell]; e < last; ++e) {
    const int i = entries_[e];
    const double rx = a_W.x() - x_[i] - vx_[i] * start_s, ry = a_W.y() - y_[i] - vy_[i] * start_s;
    const double wx = ux - vx_[i], wy = uy - vy_[i], w2 = wx * wx + wy * wy;
    const double nearest = w2 > 0 ? std::clamp(-(rx * wx + ry * wy) / w2, 0.0, duration_s) : 0;
    const double dx = rx + wx * nearest, dy = ry + wy * nearest;
    if (dx * dx + dy * dy >= radius2[i]) continue;
    if (bodies_[i].outline.empty() || !outline_is_free(i, step, start_s, duration_s, a_W, b_W)) return false;
  }
  return sides_.empty() || sides_are_clear(a_W, b_W);
}

bool PredictedTraffic::outline_is_free(std::size_t body, int step, double start_s, double duration_s,
                                       const Eigen::Vector2d& a_W, const Eigen::Vector2d& b_W) const {
  const MovingBody& of = bodies_[body];
  const Eigen::Vector2d velocity = (b_W - a_W) / duration_s;
  const double corner_speed = std::abs(of.turn_rate) * (circumscribed_radius(of) - of.radius_m);
  const double closing = (velocity - of.velocity_W).norm() + corner_speed;
  const double kept_m = steps_.distance_m + growth_[step * x_.size() + body];
  const auto is_clear = [&](const auto& self, double from_s, double to_s) -> bool {
    const double half_s = 0.5 * (to_s - from_s), t = from_s + half_s;
    const double gap = distance_to(of, a_W + t * velocity, age_s_[body] + start_s + t);
    if (gap >= kept_m + half_s * closing) return true;
    if (gap < kept_m || 2 * half_s <= kOutlinePiece_s) return false;
    return self(self, from_s, t) && self(self, t, to_s);
  };
  return is_clear(is_clear, 0, duration_s);
}

}  // namespace isobath
