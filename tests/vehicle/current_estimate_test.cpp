// The current that a vehicle has sailed through, and what its headings have not shown of it.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/vehicle/current_estimate.hpp>
#include <limits>

namespace isobath {
namespace {

using Eigen::Vector2d;

const Vector2d kCurrent(0.4, -0.2);

/// Ten fixes a second on one heading, 1.2 m/s through the water, with noise.
void sail(CurrentEstimate& estimate, Angle heading, double for_s, Random& random, double yaw_rate = 0) {
  for (int i = 0; i < static_cast<int>(for_s * 10); ++i) {
    const Vector2d v = 1.2 * Vector2d(cos(heading), sin(heading)) + kCurrent;
    const Eigen::Vector3d v_W(v.x() + 0.05 * random.normal(), v.y() + 0.05 * random.normal(), 0);
    estimate.update(heading, v_W, yaw_rate, 0.1);
  }
}

TEST(CurrentEstimate, OneHeadingShowsWhatCrossesTheHullAndNoMore) {
  CurrentEstimate estimate(0.5);
  Random random(1);
  sail(estimate, {}, 60, random);  // north
  EXPECT_NEAR(estimate.velocity_W().y(), kCurrent.y(), 0.05);
  EXPECT_EQ(estimate.velocity_W().x(), 0);
  EXPECT_GT(estimate.sigma_along({}), 0.45);
  EXPECT_LT(estimate.sigma_along(Angle::degrees(90)), 0.1);
}

TEST(CurrentEstimate, AnotherHeadingShowsTheRest) {
  CurrentEstimate estimate(0.5);
  Random random(2);
  sail(estimate, {}, 30, random);
  sail(estimate, Angle::degrees(70), 15, random);
  EXPECT_NEAR((estimate.velocity_W() - kCurrent).norm(), 0, 0.08);
  for (int degrees = 0; degrees < 180; degrees += 15) EXPECT_LT(estimate.sigma_along(Angle::degrees(degrees)), 0.2);
}

// What it says it does not know is what it does not know: over many currents the error along a heading has the
// deviation that is told.
TEST(CurrentEstimate, ItsDeviationIsThatOfItsErrors) {
  Random random(3);
  double squares = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const Vector2d current(0.5 * random.normal(), 0.5 * random.normal());
    CurrentEstimate estimate(0.5);
    const Angle first, second = Angle::degrees(30);
    for (int i = 0; i < 60; ++i) {
      const Angle heading = i < 30 ? first : second;
      const Vector2d across(-sin(heading), cos(heading));
      const Vector2d v = 1.2 * Vector2d(cos(heading), sin(heading)) + current + 0.2 * random.normal() * across;
      estimate.update(heading, {v.x(), v.y(), 0}, 0, 1);
    }
    const Angle along = Angle::degrees(15);
    const double error = (estimate.velocity_W() - current).dot(Vector2d(cos(along), sin(along)));
    squares += std::pow(error / estimate.sigma_along(along), 2) / kRuns;
  }
  EXPECT_LT(squares, 1.2) << "the current did not change, though it might have";
  EXPECT_GT(squares, 0.2);
}

TEST(CurrentEstimate, ATurnSaysLittleAndWhatIsNoNumberNothing) {
  CurrentEstimate estimate(0.5), turning(0.5);
  Random random(4);
  sail(estimate, {}, 2, random);
  sail(turning, {}, 2, random, 0.25);
  EXPECT_LT(std::abs(turning.velocity_W().y()), 0.5 * std::abs(estimate.velocity_W().y()));
  const Vector2d before = estimate.velocity_W();
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  estimate.update({}, {kNone, 0, 0}, 0, 0.1);
  estimate.update(Angle::radians(kNone), {1, 0, 0}, 0, 0.1);
  estimate.update({}, {1, 0, 0}, kNone, 0.1);
  estimate.update({}, {1, 0, 0}, 0, -1);
  EXPECT_EQ(estimate.velocity_W(), before);
}

}  // namespace
}  // namespace isobath
