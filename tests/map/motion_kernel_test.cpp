#include <Eigen/Cholesky>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/map/occupancy/motion_kernel.hpp>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

struct Sums {
  double total = 0;
  Vector2d mean = Vector2d::Zero();
  Matrix2d covariance = Matrix2d::Zero();
};

Sums sums(const MotionKernel& k) {
  Sums s;
  Matrix2d second = Matrix2d::Zero();
  for (int x = k.first_x(); x < k.first_x() + k.size_x(); ++x) {
    for (int y = k.first_y(); y < k.first_y() + k.size_y(); ++y) {
      s.total += k.weight(x, y);
      s.mean += k.weight(x, y) * Vector2d(x, y);
      second += k.weight(x, y) * Vector2d(x, y) * Vector2d(x, y).transpose();
    }
  }
  s.covariance = second - s.mean * s.mean.transpose();
  return s;
}

Matrix2d diagonal(double xx, double yy) { return Vector2d(xx, yy).asDiagonal(); }

// ledger: S6-20
TEST(MotionKernel, BilinearSharesSumToOneWithTheMeanOfTheDisplacement) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Vector2d mean(random.uniform(-4, 4), random.uniform(-4, 4));
    const Sums s = sums(MotionKernel::bilinear(mean));
    EXPECT_NEAR(s.total, 1, 1e-14);
    EXPECT_NEAR((s.mean - mean).norm(), 0, 1e-13);
  }
}

// ledger: S6-21 S6-E10
TEST(MotionKernel, ExpectedOverlapHasSumMeanAndVariance) {
  for (const Vector2d& mean : {Vector2d(0.3, -0.2), Vector2d(1, 0), Vector2d(-2.4, 3.1)}) {
    for (const double sigma : {0.5, 1.0, 2.0}) {
      const Sums s = sums(MotionKernel::expected_overlap(mean, diagonal(sigma * sigma, sigma * sigma)));
      EXPECT_NEAR(s.total, 1, 2e-4);
      EXPECT_NEAR((s.mean - mean).norm(), 0, 2e-3);
      // Interpolation adds frac (1 - frac), 1/6 on average over a broad distribution.
      if (sigma < 1) continue;
      EXPECT_NEAR(s.covariance(0, 0), sigma * sigma + 1.0 / 6, 0.01);
    }
  }
}

// ledger: S6-21 S6-E10
TEST(MotionKernel, ExpectedOverlapBecomesBilinearAndThePrintedFormDoesNot) {
  const Vector2d mean(0.3, 0);
  const MotionKernel exact = MotionKernel::bilinear(mean);
  const MotionKernel limit = MotionKernel::expected_overlap(mean, diagonal(1e-8, 1e-8));
  for (int x = -1; x <= 2; ++x) EXPECT_NEAR(limit.weight(x, 0), exact.weight(x, 0), 1e-4);
  // The row's numbers: printed, mean shift 0.16 for mean 0.3 and sigma 0.2; 20 % outside 3 x 3 for mean 1, sigma 0.5.
  EXPECT_NEAR(sums(MotionKernel::printed(mean, diagonal(0.04, 0.04))).mean.x(), 0.16, 0.005);
  const MotionKernel wide = MotionKernel::expected_overlap({1, 0}, diagonal(0.25, 1e-20));
  double kept = 0;
  for (int x = -1; x <= 1; ++x) kept += wide.weight(x, 0);
  EXPECT_NEAR(1 - kept, 0.20, 0.005);
  EXPECT_NEAR(1 - sums(MotionKernel::printed({1, 0}, diagonal(0.25, 1e-20), 3)).total, 0.159, 0.001);
}

// ledger: S6-21
TEST(MotionKernel, CorrelatedMotionMatchesSampling) {
  Matrix2d covariance;
  covariance << 0.8, 0.5, 0.5, 0.6;
  const Vector2d mean(0.4, -0.7);
  const MotionKernel kernel = MotionKernel::expected_overlap(mean, covariance);
  EXPECT_NEAR(sums(kernel).total, 1, 2e-4);
  EXPECT_NEAR((sums(kernel).mean - mean).norm(), 0, 2e-3);
  const Matrix2d root = covariance.llt().matrixL();
  Random random(4);
  constexpr int kSamples = 200000;
  double at_origin = 0;
  double at_corner = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Vector2d p = mean + root * Vector2d(random.normal(), random.normal());
    at_origin += std::max(0.0, 1 - std::abs(p.x())) * std::max(0.0, 1 - std::abs(p.y()));
    at_corner += std::max(0.0, 1 - std::abs(p.x() - 1)) * std::max(0.0, 1 - std::abs(p.y() + 1));
  }
  EXPECT_NEAR(kernel.weight(0, 0), at_origin / kSamples, 3e-3);
  EXPECT_NEAR(kernel.weight(1, -1), at_corner / kSamples, 3e-3);
}

// ledger: S6-25
TEST(MotionKernel, DiffusionHasExactlyTheCovariance) {
  Matrix2d covariance;
  covariance << 0.2, -0.07, -0.07, 0.1;
  const Sums s = sums(MotionKernel::diffusion(covariance));
  EXPECT_NEAR(s.total, 1, 1e-15);
  EXPECT_NEAR(s.mean.norm(), 0, 1e-15);
  EXPECT_NEAR((s.covariance - covariance).norm(), 0, 1e-15);
}

}  // namespace
}  // namespace isobath
