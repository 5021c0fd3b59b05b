#include <algorithm>
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/onboard/drift_estimate.hpp>

namespace isobath::drift_estimate_test {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// A navigation that drifts by 1 % of the way in one direction; a fix to 0.2 m every 20 m. ledger: S4-49
TEST(DriftEstimate, LearnsHowFastTheErrorGrows) {
  Random random(3);
  const Vector2d rate(-0.008, 0.006);
  DriftEstimate drift(0.01, 1000);
  drift.begin(Matrix2d::Zero());
  Vector2d truth = Vector2d::Zero();
  double before_learning = 0, after_learning = 0, normalised = 0;
  for (int i = 1; i <= 400; ++i) {
    drift.advance(1);
    truth += rate;
    const Vector2d error = drift.offset() - truth;
    if (i <= 20) before_learning = std::max(before_learning, error.norm());
    if (i > 200) after_learning = std::max(after_learning, error.norm());
    normalised = std::max(normalised, error.dot(drift.covariance().inverse() * error));
    if (i % 20 > 0) continue;
    const Vector2d by =
        drift.correct(truth + 0.2 * Vector2d(random.normal(), random.normal()), 0.04 * Matrix2d::Identity());
    EXPECT_LT(by.norm(), 1);
  }
  EXPECT_NEAR(before_learning, 0.2, 1e-9) << "20 m at 1 %";
  EXPECT_LT(after_learning, 0.45);
  drift.advance(100);
  truth += 100 * rate;
  EXPECT_LT((drift.offset() - truth).norm(), 0.6) << "100 m without a fix, 1 m at 1 %";
  EXPECT_LT(normalised, 14) << "0.1 % of a chi-square of two";
}

TEST(DriftEstimate, IsAsUncertainAsItIsTold) {
  DriftEstimate drift(0.02, 100);
  const Matrix2d start = Vector2d(1, 4).asDiagonal();
  drift.begin(start);
  EXPECT_EQ(drift.covariance(), start);
  drift.advance(10);
  EXPECT_NEAR(drift.covariance()(0, 0), 1 + 0.2 * 0.2, 1e-12);
  drift.scale_to(0.25);
  EXPECT_NEAR(drift.variance(), 0.25, 1e-12);
  drift.correct({0.3, 0}, 1e-12 * Matrix2d::Identity());
  EXPECT_NEAR(drift.offset().x(), 0.3, 1e-9);
  EXPECT_LT(drift.variance(), 1e-11);
  drift.begin(Matrix2d::Zero());
  EXPECT_EQ(drift.offset(), Vector2d(0, 0));
  drift.scale_to(1);  // it has no direction yet that could be scaled
  EXPECT_EQ(drift.variance(), 0);
}

}  // namespace
}  // namespace isobath::drift_estimate_test
