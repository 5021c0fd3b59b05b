#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/occupancy/motion_uncertainty.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Shifting = BodyGridConfig::Shifting;
using Turning = BodyGridConfig::Turning;

const Matrix2d kExact = Matrix2d::Zero();

BodyGridConfig small(int cells = 41) {
  BodyGridConfig c;
  c.cells_x = c.cells_y = cells;
  return c;
}

double total(const BodyGrid& g) {
  double sum = 0;
  for (const double l : g.log_odds()) sum += probability_of(l);
  return sum;
}

struct Spot {
  Vector2d mean = Vector2d::Zero();
  double variance = 0;  ///< the larger one, cells^2
  double mass = 0;
};

// What stands out above the prior, in the level body frame.
Spot spot(const BodyGrid& g) {
  Spot s;
  Matrix2d second = Matrix2d::Zero();
  for (std::size_t i = 0; i < g.cells().size(); ++i) {
    const double w = probability_of(g.log_odds()[i]) - g.config().prior;
    if (w < 1e-9) continue;
    const Vector2d p = g.to_level_body(g.cells().centre(g.cells().cell(i)));
    s.mass += w;
    s.mean += w * p;
    second += w * p * p.transpose();
  }
  s.mean /= s.mass;
  const Matrix2d covariance = second / s.mass - s.mean * s.mean.transpose();
  s.variance = covariance.diagonal().maxCoeff() / (g.cells().cell_m * g.cells().cell_m);
  return s;
}

void put(BodyGrid& g, const Vector2d& p_L, double p = 0.9) { g.set_probability(g.cell_at(p_L).value(), p); }

Vector2d centre_of(const BodyGrid& g, const Vector2d& p_L) {
  return g.to_level_body(g.cells().centre(g.cell_at(p_L).value()));
}

// ledger: S6-10
TEST(BodyGrid, StandsRoundTheVehicleAsConfigured) {
  BodyGridConfig c;
  c.home_x = 1.0 / 6;
  const BodyGrid rear(c);
  EXPECT_EQ(rear.cell_at({0, 0}).value(), (Cell{16, 50}));
  EXPECT_TRUE(rear.cell_at({83, 0}).has_value());
  EXPECT_FALSE(rear.cell_at({-18, 0}).has_value());
  EXPECT_NEAR(rear.probability({3, 4}), 0.01, 1e-15);
}

// What the thesis leaves open has the defaults of the ledger: with them unseen water is no obstacle, one echo is not
// yet one (p_D 0.8, f 0.02), and two are. ledger: S6-10 S6-24 S6-E16
TEST(BodyGrid, HasDefaultsWhereTheThesisNamesNone) {
  const BodyGridConfig c;
  EXPECT_EQ(c.cell_m, 1);
  EXPECT_EQ(c.cells_x, 100);
  EXPECT_EQ(c.cells_y, 100);
  EXPECT_EQ(c.prior, 0.01);
  const double after_one = log_odds_of(c.prior) + std::log(0.8 / 0.02);
  EXPECT_LT(9 * c.prior, c.threshold);
  EXPECT_LT(probability_of(after_one), c.threshold);
  EXPECT_GT(probability_of(after_one + std::log(0.8 / 0.02)), c.threshold);
}

// ledger: S6-24 S6-E23
TEST(BodyGrid, RefusesAPriorThatMakesUnseenWaterAnObstacle) {
  BodyGridConfig c;
  c.prior = 0.8 / 9;
  EXPECT_THROW(BodyGrid{c}, Error);
  c.prior = 0.0888;
  EXPECT_NO_THROW(BodyGrid{c});
  c.cells_x = 0;
  EXPECT_THROW(BodyGrid{c}, Error);
}

// ledger: S6-20 S6-E11
TEST(BodyGrid, ForwardMotionBringsATargetNearer) {
  for (const Shifting shifting : {Shifting::kWholeCells, Shifting::kInterpolated}) {
    BodyGridConfig c = small();
    c.shifting = shifting;
    BodyGrid g(c);
    put(g, {10, 2});
    g.move({3.4, 0.25}, {}, kExact);  // more than one cell
    EXPECT_NEAR((spot(g).mean - Vector2d(6.6, 1.75)).norm(), 0, 1e-6) << static_cast<int>(shifting);
    EXPECT_NEAR(total(g), 41 * 41 * 0.01 + 0.89, 1e-9);
  }
}

// ledger: S6-24 S6-E22
TEST(BodyGrid, WhatEntersTheGridHasThePrior) {
  for (const Shifting shifting : {Shifting::kWholeCells, Shifting::kInterpolated, Shifting::kPrinted}) {
    BodyGridConfig c = small(20);
    c.shifting = shifting;
    BodyGrid g(c);
    g.move({2.6, -1.3}, {}, shifting == Shifting::kPrinted ? Matrix2d(0.2 * Matrix2d::Identity()) : kExact);
    for (const double l : g.log_odds()) EXPECT_NEAR(probability_of(l), 0.01, 1e-12);
    put(g, {8, 8});
    g.move({500, 0}, {}, kExact);
    for (const double l : g.log_odds()) EXPECT_NEAR(probability_of(l), 0.01, 1e-12);
  }
}

// ledger: S6-25
TEST(BodyGrid, ManySmallStepsDoNotBlurATarget) {
  BodyGridConfig c;
  c.cells_x = 260;
  c.cells_y = 21;
  BodyGrid g(c);
  put(g, {105, 3});
  const Vector2d start = spot(g).mean;
  for (int i = 0; i < 2000; ++i) g.move({0.05, 0}, {}, kExact);
  EXPECT_NEAR((spot(g).mean - (start - Vector2d(100, 0))).norm(), 0, 1e-6);
  EXPECT_LT(spot(g).variance, 1e-9) << "one cell still";

  c.shifting = Shifting::kInterpolated;
  BodyGrid naive(c);
  put(naive, {105, 3});
  for (int i = 0; i < 10; ++i) naive.move({0.1, 0}, {}, kExact);
  EXPECT_NEAR(spot(naive).variance, 0.9, 0.01) << "the thesis's way spreads it";
}

// ledger: S6-21 S6-25
TEST(BodyGrid, UncertainMotionSpreadsATargetByItsCovarianceAndNoMore) {
  BodyGrid g(small(61));
  put(g, {5, 5});
  for (int i = 0; i < 100; ++i) g.move({0.05, 0}, {}, Vector2d(0.03, 0.01).asDiagonal());
  EXPECT_NEAR(spot(g).variance, 3, 0.1);
  EXPECT_NEAR(spot(g).mass, 0.89, 0.01);
  EXPECT_NEAR((spot(g).mean - centre_of(BodyGrid(small(61)), {5, 5}) + Vector2d(5, 0)).norm(), 0, 0.02);
}

// Range times the standard deviation of the heading, across the line of sight: 100 readings of half a degree are 5.
// ledger: S6-68
TEST(BodyGrid, AnUncertainHeadingSpreadsATargetByItsRange) {
  BodyGridConfig c = small(121);
  c.prior = 1e-3;
  c.p_min = 1e-7;
  const double step = Angle::degrees(0.5).radians();
  double before = 0;
  for (const double range : {8.0, 16.0, 32.0}) {
    BodyGrid g(c);
    put(g, {range, 0});
    const double r = spot(g).mean.norm();
    for (int i = 0; i < 100; ++i) g.move({0, 0}, {}, kExact, step * step);
    const double predicted = 100 * step * step * r * r;
    EXPECT_NEAR(spot(g).variance, predicted, 0.1 * predicted) << range;
    EXPECT_NEAR(spot(g).mass, 0.9, 0.02) << range;
    EXPECT_NEAR(spot(g).mean.norm(), r, 0.05 * r) << "it stays where it is";
    EXPECT_GT(spot(g).variance, 3 * before);
    before = spot(g).variance;
  }
  BodyGrid sure(c);
  put(sure, {32, 0});
  sure.move({0, 0}, Angle::degrees(3), kExact, 0);
  EXPECT_LT(spot(sure).variance, 1e-9);
}

// ledger: S6-68
TEST(Motion, AHeadingThatNothingCorrectsGrowsUncertainAndOneWithACompassDoesNot) {
  const MotionConfig c;
  TurnVariance turn;
  double sum = turn.since_last(c, {true, true, 1e-4});
  EXPECT_EQ(sum, 0) << "the first heading";
  for (int i = 0; i < 1000; ++i) sum += turn.since_last(c, {true, true, i % 2 == 0 ? 1.5e-4 : 1e-4});
  EXPECT_NEAR(sum, 0.5e-4, 1e-12) << "the readings of a compass, and the gyro between them";
  for (int i = 1; i <= 100; ++i) sum += turn.since_last(c, {true, true, 1.5e-4 + i * 1e-5});
  EXPECT_NEAR(sum, 0.5e-4 + 1e-3, 1e-12) << "the compass is lost";
  EXPECT_EQ(turn.since_last(c, {true, true, 1e-4}), 0) << "and found again";
  EXPECT_NEAR(turn.since_last(c, {true, true, 2e-4}), 1e-4, 1e-12) << "and lost";
  TurnVariance exact;
  exact.since_last({.kind = MotionKind::kDeterministic}, {true, true, 1e-4});
  EXPECT_EQ(exact.since_last({.kind = MotionKind::kDeterministic}, {true, true, 1}), 0);
}

// ledger: S6-22
TEST(Motion, LosingFixAndVelocityLogMakesItProbabilistic) {
  const MotionConfig c;
  EXPECT_EQ(motion_kind(c, {true, false}), MotionKind::kDeterministic);
  EXPECT_EQ(motion_kind(c, {false, true}), MotionKind::kDeterministic);
  EXPECT_EQ(motion_kind(c, {false, false}), MotionKind::kProbabilistic);
  EXPECT_TRUE(displacement_covariance(c, {true, true}, seconds(4)).isZero(0));
  const Matrix2d lost = displacement_covariance(c, {false, false}, seconds(4));
  EXPECT_NEAR(lost(0, 0), c.along * c.along * 4, 1e-12);
  EXPECT_NEAR(lost(1, 1), c.across * c.across * 4, 1e-12);
}

// ledger: S6-23
TEST(BodyGrid, HeadingAddsUpToWholeDegreesAndKeepsTheRest) {
  BodyGridConfig c = small();
  c.turning = Turning::kResampled;
  BodyGrid g(c);
  for (int i = 0; i < 3; ++i) g.move({0, 0}, Angle::degrees(0.4), kExact);
  EXPECT_NEAR(g.heading().degrees(), 0.2, 1e-9);
  g.move({0, 0}, Angle::degrees(-1.5), kExact);
  EXPECT_NEAR(g.heading().degrees(), -0.3, 1e-9);

  BodyGrid exact(small());
  for (int i = 0; i < 5; ++i) exact.move({0, 0}, Angle::degrees(100), kExact);
  EXPECT_NEAR(exact.heading().degrees(), 140, 1e-9) << "wrapped";
}

// ledger: S6-23 S6-E12
TEST(BodyGrid, SharesOfATurnSumToOneFarFromTheAxis) {
  BodyGridConfig c;
  c.cells_x = 220;
  c.cells_y = 9;
  c.home_x = 0;
  c.turning = Turning::kResampled;
  c.prior = 0.05;
  BodyGrid g(c);
  for (double& l : g.log_odds()) l = log_odds_of(0.5);
  g.move({0, 0}, Angle::degrees(1), kExact);
  for (const int x : {10, 55, 58, 100, 140}) EXPECT_NEAR(g.probability({x, 2}), 0.5, 1e-9) << x;
}

// ledger: S6-23
TEST(BodyGrid, AWholeTurnInDegreesBringsATargetBack) {
  for (const Turning turning : {Turning::kExact, Turning::kResampled}) {
    BodyGridConfig c = small(33);
    c.turning = turning;
    c.prior = 1e-3;
    c.p_min = 1e-6;
    BodyGrid g(c);
    put(g, {5, 1}, 0.999);
    const Vector2d before = spot(g).mean;
    g.move({0, 0}, Angle::degrees(90), kExact);
    EXPECT_LT((spot(g).mean - Vector2d(1, -5)).norm(), 1) << "a turn to starboard leaves it to port";
    for (int i = 0; i < 270; ++i) g.move({0, 0}, Angle::degrees(1), kExact);
    EXPECT_LT((spot(g).mean - before).norm(), 1);
    EXPECT_NEAR(g.heading().radians(), 0, 1e-9);
  }
}

// ledger: S6-26
TEST(BodyGrid, TurningWhileMovingKeepsATargetInItsPlace) {
  for (const auto& [shifting, turning] :
       {std::pair(Shifting::kWholeCells, Turning::kExact), std::pair(Shifting::kInterpolated, Turning::kResampled)}) {
    BodyGridConfig c = small(81);
    c.shifting = shifting;
    c.turning = turning;
    c.prior = 1e-3;
    c.p_min = 1e-6;
    BodyGrid g(c);
    put(g, {20, 6}, 0.999);
    // World axes are L at the start; 1.5 m/s, 5 degrees a second, ten steps a second for 8 s on the true circle.
    const Vector2d target = spot(g).mean;
    const double rate = 5 * std::numbers::pi / 180;
    const double radius = 1.5 / rate;
    for (int i = 0; i < 80; ++i) {
      const double turn = rate / 10;
      g.move({radius * std::sin(turn), radius * (1 - std::cos(turn))}, Angle::radians(turn), kExact);
    }
    const double heading = rate * 8;
    const Vector2d there(radius * std::sin(heading), radius * (1 - std::cos(heading)));
    const Vector2d d = target - there;
    const Vector2d expected(std::cos(heading) * d.x() + std::sin(heading) * d.y(),
                            -std::sin(heading) * d.x() + std::cos(heading) * d.y());
    EXPECT_LT((spot(g).mean - expected).norm(), turning == Turning::kExact ? 1e-6 : 1);
  }
}

// ledger: S6-71
TEST(BodyGrid, MovedOccupancyIsASumOrTheChanceOfAnyTarget) {
  const auto moved = [](BodyGridConfig::Moved reading, double p) {
    BodyGridConfig c = small(9);
    c.shifting = Shifting::kInterpolated;
    c.moved = reading;
    BodyGrid g(c);
    for (const Cell cell : {Cell{4, 4}, Cell{4, 5}, Cell{5, 4}, Cell{5, 5}}) g.set_probability(cell, p);
    g.move({0.5, 0.5}, {}, kExact);
    return g.probability({4, 4});
  };
  const double full = 1 - 1e-4;
  EXPECT_NEAR(moved(BodyGridConfig::Moved::kSum, full), 1, 2e-4);
  EXPECT_NEAR(moved(BodyGridConfig::Moved::kAnyTarget, full), 0.684, 1e-3);
  for (const double p : {0.01, 0.02}) {
    const double sum = moved(BodyGridConfig::Moved::kSum, p);
    EXPECT_LT((sum - moved(BodyGridConfig::Moved::kAnyTarget, p)) / sum, 0.01);
  }
  EXPECT_LT(moved(BodyGridConfig::Moved::kSum, 0.1) - moved(BodyGridConfig::Moved::kAnyTarget, 0.1), 0.01);
}

// ledger: S6-19
TEST(BodyGrid, ProbabilitiesStayWithinTheirClamp) {
  BodyGrid g(small(5));
  g.set_probability({1, 1}, 1);
  g.set_probability({1, 2}, 0);
  EXPECT_NEAR(g.probability({1, 1}), 1 - 1e-4, 1e-12);
  EXPECT_NEAR(g.probability({1, 2}), 1e-4, 1e-12);
}

TEST(BodyGrid, FreeMeansLessLikelyThanUnseen) {
  BodyGrid g(small(5));
  EXPECT_FALSE(g.is_free({2, 2}));
  g.set_probability({2, 2}, 0.0049);
  EXPECT_TRUE(g.is_free({2, 2}));
  g.set_probability({2, 2}, 0.006);
  EXPECT_FALSE(g.is_free({2, 2}));
}

}  // namespace
}  // namespace isobath
