#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/perception/bearing_posterior.hpp>
#include <limits>
#include <numbers>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kImpossible = -std::numeric_limits<double>::infinity();
constexpr double kLeastRange_m = 0.5;  // a sound is not inside the array
constexpr double kLikely = 12;         // points whose log likelihood is this far below the largest do not matter
constexpr double kWide = 5;            // standard deviations of a direction that are looked at
constexpr int kRefinements = 5;
constexpr double kWorthRefining = 0.5;  // of the box, in area

double direction(const Vector2d& from, const Vector2d& to) {
  const Vector2d d = to - from;
  return std::atan2(d.y(), d.x());
}

}  // namespace

BearingPosterior::BearingPosterior(std::span<const BearingFrom> bearings, double bias_sigma, double max_range_m)
    : bearings_(bearings), bias_variance_(bias_sigma * bias_sigma), max_range_m_(max_range_m) {
  ISOBATH_ASSERT(!bearings.empty());
  best_ = &*std::min_element(bearings.begin(), bearings.end(),
                             [](const BearingFrom& a, const BearingFrom& b) { return a.sigma < b.sigma; });
  const double near = best_->position_sigma_m / 10;
  const double sigma = std::sqrt(best_->sigma * best_->sigma + bias_variance_ + near * near);
  half_width_ = std::min(std::numbers::pi, kWide * sigma);
}

double BearingPosterior::log_likelihood(const Vector2d& s) const {
  double s0 = 0, s1 = 0, s2 = 0, product = 1, logs = 0;
  int factors = 0;
  for (const BearingFrom& b : bearings_) {
    const Vector2d d = s - b.p_W;
    const double range2 = std::max(d.squaredNorm(), kLeastRange_m * kLeastRange_m);
    const double variance = b.sigma * b.sigma + b.position_sigma_m * b.position_sigma_m / range2;
    const double residual = std::remainder(b.bearing - std::atan2(d.y(), d.x()), kTwoPi);
    s0 += 1 / variance;
    s1 += residual / variance;
    s2 += residual * residual / variance;
    product *= kTwoPi * variance;
    if (++factors % 16 == 0) logs += std::log(std::exchange(product, 1.0));  // it must not underflow
  }
  logs += std::log(product);
  const double common = 1 + bias_variance_ * s0;
  return -0.5 * (s2 - bias_variance_ * s1 * s1 / common + logs + std::log(common));
}

template <class Weight, class Point>
double BearingPosterior::fill(const Box& box, const Weight& weight, const Point& point) {
  double largest = kImpossible;
  std::size_t k = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j, ++k) {
      const double x = box.low_x + (i + 0.5) * box.step_x, y = box.low_y + (j + 0.5) * box.step_y;
      const Vector2d s = point(x, y);
      const double w = weight(x, y, s);
      values_[k] = w > 0 ? std::log(w) + log_likelihood(s) : kImpossible;
      largest = std::max(largest, values_[k]);
    }
  }
  return largest;
}

/// The part of the box that holds the likely points, with a cell more at each side.
BearingPosterior::Box BearingPosterior::around_the_likely(const Box& box, double largest) const {
  int low_i = kSide, high_i = -1, low_j = kSide, high_j = -1;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      if (values_[i * kSide + j] < largest - kLikely) continue;
      low_i = std::min(low_i, i);
      high_i = std::max(high_i, i);
      low_j = std::min(low_j, j);
      high_j = std::max(high_j, j);
    }
  }
  low_i = std::max(low_i - 1, 0);
  low_j = std::max(low_j - 1, 0);
  high_i = std::min(high_i + 1, kSide - 1);
  high_j = std::min(high_j + 1, kSide - 1);
  return {box.low_x + low_i * box.step_x, box.low_y + low_j * box.step_y, box.step_x * (high_i - low_i + 1) / kSide,
          box.step_y * (high_j - low_j + 1) / kSide};
}

bool BearingPosterior::is_in_no_likely_direction(const Eigen::AlignedBox2d& box) const {
  const double range = (box.center() - best_->p_W).norm(), radius = 0.5 * box.diagonal().norm();
  if (range <= radius) return false;
  const double off = std::abs(std::remainder(direction(best_->p_W, box.center()) - best_->bearing, kTwoPi));
  return off > half_width_ + std::asin(radius / range);
}

double BearingPosterior::log_evidence(const SoundRegion& region) {
  Eigen::AlignedBox2d around;
  for (const Polygon* piece : region.pieces) {
    for (const Vector2d& corner : *piece) around.extend(corner);
  }
  if (around.isEmpty()) return kImpossible;
  const double margin = region.reach_m + 1e-3;
  around.min().array() -= margin;
  around.max().array() += margin;
  if (is_in_no_likely_direction(around)) return kImpossible;
  const auto point = [](double x, double y) { return Vector2d(x, y); };
  const auto weight = [&](double /*x*/, double /*y*/, const Vector2d& s) {
    return std::any_of(region.pieces.begin(), region.pieces.end(),
                       [&](const Polygon* piece) { return distance_from(*piece, s) <= region.reach_m; })
               ? 1.0
               : 0.0;
  };
  Box box{around.min().x(), around.min().y(), around.sizes().x() / kSide, around.sizes().y() / kSide};
  double largest = fill(box, weight, point);
  const auto inside = std::count_if(values_.begin(), values_.end(), [](double v) { return v > kImpossible; });
  if (inside == 0 || largest == kImpossible) return kImpossible;
  const double area = static_cast<double>(inside) * box.step_x * box.step_y;
  for (int n = 0; n < kRefinements; ++n) {
    const Box finer = around_the_likely(box, largest);
    if (finer.step_x * finer.step_y > kWorthRefining * box.step_x * box.step_y) break;
    box = finer;
    largest = fill(box, weight, point);
    if (largest == kImpossible) return kImpossible;
  }
  double sum = 0;
  for (const double value : values_) sum += std::exp(value - largest);
  return largest + std::log(sum * box.step_x * box.step_y / area);
}

double BearingPosterior::log_evidence_of_none(SoundPlace& place) {
  const auto point = [this](double angle, double log_range) {
    return Vector2d(best_->p_W + std::exp(log_range) * Vector2d(std::cos(angle), std::sin(angle)));
  };
  const auto weight = [](double /*angle*/, double log_range, const Vector2d&) { return std::exp(2 * log_range); };
  const double near = std::log(kLeastRange_m), far = std::log(max_range_m_);
  Box box{best_->bearing - half_width_, near, 2 * half_width_ / kSide, (far - near) / kSide};
  double largest = fill(box, weight, point);
  for (int n = 0; n < kRefinements; ++n) {
    const Box finer = around_the_likely(box, largest);
    if (finer.step_x * finer.step_y > kWorthRefining * box.step_x * box.step_y) break;
    box = finer;
    largest = fill(box, weight, point);
  }
  double sum = 0;
  Vector2d first = Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  std::size_t k = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j, ++k) {
      const double w = std::exp(values_[k] - largest);
      const Vector2d s = point(box.low_x + (i + 0.5) * box.step_x, box.low_y + (j + 0.5) * box.step_y) - best_->p_W;
      sum += w;
      first += w * s;
      second += w * s * s.transpose();
    }
  }
  const Vector2d mean = first / sum;
  place.mean = best_->p_W + mean;
  place.covariance = second / sum - mean * mean.transpose();
  const double disc = std::numbers::pi * max_range_m_ * max_range_m_;
  return largest + std::log(sum * box.step_x * box.step_y / disc);
}

}  // namespace isobath
