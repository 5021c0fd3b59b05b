// Where a body is and how it moves, against what it did.
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/tracking/motion_filter.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

const MotionFilterConfig kMotion;
const Matrix2d kNoise = 0.09 * Matrix2d::Identity();  // 0.3 m

Vector2d with_noise(Random& random, const Vector2d& p) { return p + 0.3 * Vector2d(random.normal(), random.normal()); }

/// The filter after `count` readings at 1 Hz of a body at path(time).
template <class Path>
MotionFilter follow(Random& random, const Path& path, int count) {
  MotionFilter filter(kMotion, with_noise(random, path(0)), kNoise);
  for (int k = 1; k < count; ++k) {
    filter.advance(kMotion, 1);
    filter.correct({with_noise(random, path(k)), kNoise});
  }
  return filter;
}

double velocity_error(const MotionFilter& filter, const Vector2d& truth) {
  return (filter.estimate().mean.segment<2>(2) - truth).norm();
}

// The best that ten readings allow: a straight line through them errs by 0.3 m sqrt(12 / (n (n^2 - 1))) on each axis.
// ledger: S3-15
TEST(MotionFilter, KnowsAVelocityAfterTenReadings) {
  Random random(1);
  double squares = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const Vector2d v = random.uniform(0.5, 1.5) * Vector2d(std::cos(run), std::sin(run));
    const auto path = [&](double t) -> Vector2d { return Vector2d(3, -7) + t * v; };
    const double error = velocity_error(follow(random, path, 10), v);
    squares += error * error;
  }
  const double on_each_axis = std::sqrt(squares / kRuns / 2);
  const double line = 0.3 * std::sqrt(12.0 / (10 * 99));
  EXPECT_LT(on_each_axis, 0.1);
  EXPECT_GT(on_each_axis, 0.8 * line);
}

// A head that turns gives readings of one body at uneven times; a filter that takes them all for the time of the look
// is off by what the body moves in the meantime.
// ledger: S3-15
TEST(MotionFilter, TakesAReadingForTheTimeAtWhichItWasMade) {
  const Vector2d v(1.2, -0.5);
  const auto rms_error = [&](bool knows_the_age) {
    Random random(3);
    double squares = 0;
    constexpr int kRuns = 100;
    for (int run = 0; run < kRuns; ++run) {
      MotionFilter filter(kMotion, with_noise(random, {0, 0}), kNoise);
      for (int k = 1; k <= 20; ++k) {
        const double age = random.uniform(0, 2);
        filter.advance(kMotion, 2);
        filter.correct({with_noise(random, (2 * k - age) * v), kNoise, knows_the_age ? age : 0});
      }
      squares += (filter.position() - 40 * v).squaredNorm();
    }
    return std::sqrt(squares / kRuns);
  };
  EXPECT_LT(rms_error(true), 0.45);
  EXPECT_GT(rms_error(false), 1);
}

// ledger: S3-15
TEST(MotionFilter, GivesABodyThatLiesStillNoVelocity) {
  Random random(2);
  int fast = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const MotionFilter filter = follow(
        random,
        [](double) -> Vector2d {
          return {5, 5};
        },
        10);
    fast += velocity_error(filter, {0, 0}) > 0.1;
    EXPECT_GT(filter.probability(MotionFilter::kStill), 0.3);
  }
  EXPECT_LT(fast, 0.05 * kRuns);
}

// A body that turns by 10 degrees a second from the 30th second on. ledger: S3-15
TEST(MotionFilter, NoticesAManoeuvre) {
  Random random(3);
  const double rate = 10 * std::numbers::pi / 180;
  const double radius = 1 / rate;
  const auto path = [&](double t) -> Vector2d {
    if (t <= 30) return {t - 30, 0};
    const double turned = rate * (t - 30);
    return {radius * std::sin(turned), radius * (1 - std::cos(turned))};
  };
  int noticed = 0;
  double turn_rate = 0;
  for (int run = 0; run < 50; ++run) {
    MotionFilter filter(kMotion, with_noise(random, path(0)), kNoise);
    double before = 1;
    bool within = false;
    for (int k = 1; k <= 45; ++k) {
      filter.advance(kMotion, 1);
      filter.correct({with_noise(random, path(k)), kNoise});
      const double p = filter.probability(MotionFilter::kManoeuvre);
      if (k == 30) before = p;
      within = within || (k > 30 && k <= 38 && p > 0.5);
    }
    noticed += within && before < 0.5;
    turn_rate += filter.estimate().mean[4] / 50;
  }
  EXPECT_GE(noticed, 45);
  EXPECT_NEAR(turn_rate, rate, 0.3 * rate);
}

// The covariance tells how large the errors are: squared errors in deviations are 4 on average.
TEST(MotionFilter, IsAsSureAsItIsRight) {
  Random random(4);
  double sum = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const Vector2d v = random.uniform(0.3, 1.5) * Vector2d(std::cos(run), std::sin(run));
    const MotionFilter filter = follow(
        random, [&](double t) -> Vector2d { return t * v; }, 20);
    const auto e = filter.estimate();
    Eigen::Vector4d off = e.mean.head<4>();
    off.head<2>() -= 19 * v;
    off.tail<2>() -= v;
    sum += off.dot(e.covariance.topLeftCorner<4, 4>().inverse() * off) / kRuns;
  }
  EXPECT_GT(sum, 2);
  EXPECT_LT(sum, 6);
}

// What the filter expects of a turn is the turn, however it is cut into steps.
TEST(MotionFilter, AdvancesAlikeInOneStepAndInMany) {
  Random random(5);
  const MotionFilter filter = follow(
      random,
      [](double t) -> Vector2d {
        return {t, 0.2 * t};
      },
      12);
  MotionFilter one = filter, many = filter;
  one.advance(kMotion, 0.8);
  for (int k = 0; k < 8; ++k) many.advance(kMotion, 0.1);
  EXPECT_NEAR((one.position() - many.position()).norm(), 0, 0.01);
  for (const auto motion : {MotionFilter::kStill, MotionFilter::kStraight, MotionFilter::kManoeuvre})
    EXPECT_NEAR(one.probability(motion), many.probability(motion), 0.005);
  one = filter;
  one.advance(kMotion, -5);  // time runs backwards
  EXPECT_EQ(one.position(), filter.position());
}

TEST(MotionFilter, MixesByMoments) {
  const MotionFilter a(kMotion, {0, 0}, kNoise), b(kMotion, {4, 0}, kNoise);
  MotionFilter mixed = a;
  const std::array<MotionFilter, 2> both = {a, b};
  mixed.mix(both, std::array<double, 2>{0.25, 0.75});
  EXPECT_NEAR(mixed.position().x(), 3, 1e-12);
  EXPECT_NEAR(mixed.estimate().covariance(0, 0), 0.09 + 0.25 * 0.75 * 16, 1e-12);
  mixed.shift({1, -2});
  EXPECT_NEAR(mixed.position().y(), -2, 1e-12);
}

}  // namespace
}  // namespace isobath
