#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/occupancy/motion_kernel.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

double normal_density(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); }
double normal_integral(double z) { return std::erfc(-z / std::numbers::sqrt2) / 2; }
// G(z) = z Phi(z) + phi(z), the integral of Phi.
double second_integral(double z) { return z * normal_integral(z) + normal_density(z); }

// Share of a unit cell, moved by N(mean, sigma), that arrives in the cell i cells farther.
double expected_share(int i, double mean, double sigma) {
  if (sigma < 1e-9) return std::max(0.0, 1 - std::abs(mean - i));
  const double z = (i - mean) / sigma;
  const double step = 1 / sigma;
  return std::max(0.0, sigma * (second_integral(z + step) - 2 * second_integral(z) + second_integral(z - step)));
}

// N(mean, sigma) integrated over cell i.
double printed_share(int i, double mean, double sigma) {
  if (sigma < 1e-9) return std::floor(mean + 0.5) == i ? 1 : 0;
  return normal_integral((i + 0.5 - mean) / sigma) - normal_integral((i - 0.5 - mean) / sigma);
}

double hat(int i, double x) { return std::max(0.0, 1 - std::abs(x - i)); }
double box(int i, double x) { return std::abs(x - i) <= 0.5 ? 1 : 0; }

int reach(double mean, double variance) {
  return static_cast<int>(std::ceil(std::abs(mean) + 4 * std::sqrt(variance) + 1));
}

struct ExpectedOverlap {
  static double share(int i, double mean, double sigma) { return expected_share(i, mean, sigma); }
  static double shape(int i, double x) { return hat(i, x); }
};

struct Printed {
  static double share(int i, double mean, double sigma) { return printed_share(i, mean, sigma); }
  static double shape(int i, double x) { return box(i, x); }
};

}  // namespace

MotionKernel::MotionKernel(int first_x, int first_y, int size_x, int size_y)
    : first_x_(first_x),
      first_y_(first_y),
      size_x_(size_x),
      size_y_(size_y),
      large_(size_x * size_y <= 9 ? 0 : static_cast<std::size_t>(size_x) * size_y, 0.0) {}

double MotionKernel::weight(int x, int y) const {
  if (x < first_x_ || x >= first_x_ + size_x_ || y < first_y_ || y >= first_y_ + size_y_) return 0;
  return (large_.empty() ? small_.data() : large_.data())[index(x, y)];
}

MotionKernel MotionKernel::bilinear(const Vector2d& mean) {
  const Vector2d low(std::floor(mean.x()), std::floor(mean.y()));
  const Vector2d rest = mean - low;
  MotionKernel k(static_cast<int>(low.x()), static_cast<int>(low.y()), rest.x() > 0 ? 2 : 1, rest.y() > 0 ? 2 : 1);
  for (int x = k.first_x_; x < k.first_x_ + k.size_x_; ++x) {
    for (int y = k.first_y_; y < k.first_y_ + k.size_y_; ++y) k.at(x, y) = hat(x, mean.x()) * hat(y, mean.y());
  }
  return k;
}

// Separable where the axes are independent. Otherwise y given x is normal too: its share has a closed form, and x is
// integrated by Simpson's rule.
template <class Form>
MotionKernel MotionKernel::gaussian(const Vector2d& mean, const Matrix2d& covariance, int reach_x, int reach_y, Form) {
  MotionKernel k(-reach_x, -reach_y, 2 * reach_x + 1, 2 * reach_y + 1);
  const double sigma_x = std::sqrt(covariance(0, 0));
  const double slope = covariance(0, 0) > 0 ? covariance(0, 1) / covariance(0, 0) : 0;
  if (slope == 0) {
    const double sigma_y = std::sqrt(covariance(1, 1));
    for (int x = -reach_x; x <= reach_x; ++x) {
      for (int y = -reach_y; y <= reach_y; ++y) {
        k.at(x, y) = Form::share(x, mean.x(), sigma_x) * Form::share(y, mean.y(), sigma_y);
      }
    }
    return k;
  }
  const double rest = std::sqrt(std::max(0.0, covariance(1, 1) - slope * covariance(0, 1)));
  constexpr int kPanels = 64;  // a half cell, even; corners of the shapes fall on the ends
  for (int x = -reach_x; x <= reach_x; ++x) {
    for (int half = -2; half < 2; ++half) {
      const double low = x + half / 2.0;
      for (int n = 0; n <= kPanels; ++n) {
        const double at = low + 0.5 * n / kPanels;
        const double simpson = (n == 0 || n == kPanels ? 1.0 : n % 2 == 1 ? 4.0 : 2.0) * 0.5 / kPanels / 3;
        // The ends of a box belong to the panel inside it.
        const double shape = Form::shape(x, n == 0 ? at + 1e-12 : n == kPanels ? at - 1e-12 : at);
        const double density = shape * normal_density((at - mean.x()) / sigma_x) / sigma_x * simpson;
        if (density == 0) continue;
        const double mean_y = mean.y() + slope * (at - mean.x());
        for (int y = -reach_y; y <= reach_y; ++y) k.at(x, y) += density * Form::share(y, mean_y, rest);
      }
    }
  }
  return k;
}

MotionKernel MotionKernel::expected_overlap(const Vector2d& mean, const Matrix2d& covariance) {
  if (covariance.isZero(0)) return bilinear(mean);
  return gaussian(mean, covariance, reach(mean.x(), covariance(0, 0)), reach(mean.y(), covariance(1, 1)),
                  ExpectedOverlap{});
}

MotionKernel MotionKernel::printed(const Vector2d& mean, const Matrix2d& covariance, int size) {
  const int x = size > 0 ? size / 2 : reach(mean.x(), covariance(0, 0));
  const int y = size > 0 ? size / 2 : reach(mean.y(), covariance(1, 1));
  return gaussian(mean, covariance, x, y, Printed{});
}

MotionKernel MotionKernel::diffusion(const Matrix2d& covariance) {
  const double xx = covariance(0, 0);
  const double yy = covariance(1, 1);
  ISOBATH_ASSERT(xx >= 0 && yy >= 0 && xx <= 0.5 && yy <= 0.5);
  const double smaller = std::min(xx, yy);
  const double xy = std::clamp(covariance(0, 1), -smaller, smaller);
  MotionKernel k(-1, -1, 3, 3);
  k.at(1, 0) = k.at(-1, 0) = (xx - std::abs(xy)) / 2;
  k.at(0, 1) = k.at(0, -1) = (yy - std::abs(xy)) / 2;
  const int side = xy < 0 ? -1 : 1;
  k.at(1, side) = k.at(-1, -side) = std::abs(xy) / 2;
  k.at(0, 0) = 1 - xx - yy + std::abs(xy);
  return k;
}

}  // namespace isobath
