#include <algorithm>
#include <cmath>
#include <isobath/planning/traffic/predicted_traffic.hpp>

namespace isobath {
namespace {

constexpr double kCell_m = 4;
constexpr double kOutlinePiece_s = 0.125;

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
  first_.assign(cells + 1, 0);
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
  const auto for_each_cell = [&](const auto& visit) {
    for (int k = 0; k < steps.count; ++k) {
      for (std::size_t i = 0; i < n; ++i) {
        const CellRange range = cells_of(i, k);
        for (int y = range.y0; y <= range.y1; ++y) {
          for (int x = range.x0; x <= range.x1; ++x) visit((k * side_ + y) * side_ + x, i);
        }
      }
    }
  };
  for_each_cell([&](int cell, std::size_t) { ++first_[cell + 1]; });
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  entries_.resize(first_.back());
  // Each body goes to the place before the end of its cell; the ends become the starts.
  for_each_cell([&](int cell, std::size_t i) { entries_[first_[cell]++] = static_cast<std::int32_t>(i); });
  std::shift_right(first_.begin(), first_.end(), 1);
  first_.front() = 0;
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
  return true;
}

bool PredictedTraffic::outline_is_free(std::size_t body, int step, double start_s, double duration_s,
                                       const Eigen::Vector2d& a_W, const Eigen::Vector2d& b_W) const {
  const int pieces = std::max(1, static_cast<int>(std::ceil(duration_s / kOutlinePiece_s)));
  const double piece_s = duration_s / pieces;
  const MovingBody& of = bodies_[body];
  const double relative = ((b_W - a_W) / duration_s - of.velocity_W).norm();
  const double corner_speed = std::abs(of.turn_rate) * (circumscribed_radius(of) - of.radius_m);
  const double least = steps_.distance_m + growth_[step * x_.size() + body] + 0.5 * piece_s * (relative + corner_speed);
  for (int k = 0; k < pieces; ++k) {
    const double t = (k + 0.5) * piece_s;
    const Eigen::Vector2d p = a_W + t / duration_s * (b_W - a_W);
    if (distance_to(of, p, age_s_[body] + start_s + t) < least) return false;
  }
  return true;
}

}  // namespace isobath
