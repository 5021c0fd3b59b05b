// Risk of a path through threats.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/mission_risk.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Path = std::vector<Vector2d>;

/// 25 x 25 pixels a square mile (S1-37), rates drawn at random.
RiskGrid random_grid(std::uint64_t seed) {
  RiskGrid risk{{{800, -800}, 1609.344 / 25}, {0, 0, 25, 25}, {}};
  Random random(seed);
  for (int i = 0; i < 625; ++i) risk.rate_per_m.push_back(rate_of_probability(0.3 * random.uniform(), 64.4));
  return risk;
}

double probability_of_rate(double rate_per_m, double length_m) { return -std::expm1(-rate_per_m * length_m); }

// ledger: S1-37
TEST(MissionRisk, ARateIsAProbabilityOverALength) {
  EXPECT_NEAR(probability_of_rate(rate_of_probability(0.2, 64.4), 64.4), 0.2, 1e-15);
  EXPECT_NEAR(probability_of_rate(rate_of_probability(0.2, 64.4), 128.8), 1 - 0.8 * 0.8, 1e-15);
  EXPECT_NEAR(probability_of_rate(rate_of_probability(1e-12, 1), 1), 1e-12, 1e-24);
  EXPECT_EQ(probability_of_rate(rate_of_probability(1, 64.4), 1), 1);
  EXPECT_EQ(rate_of_probability(0, 64.4), 0);
}

// Three pixels in a row, by hand: survival is the product. ledger: S1-37
TEST(MissionRisk, SurvivalMultipliesAlongThePath) {
  RiskGrid risk{{{10, 0}, 10}, {0, 0, 3, 1}, {}};
  for (const double p : {0.1, 0.2, 0.3}) risk.rate_per_m.push_back(rate_of_probability(p, 10));
  const PathRisk across = path_risk(risk, Path{{5, 0}, {5, 30}});
  EXPECT_NEAR(across.probability(), 1 - 0.9 * 0.8 * 0.7, 1e-14);
  EXPECT_NEAR(path_risk(risk, Path{{5, 5}, {5, 15}}).probability(), 1 - std::sqrt(0.9 * 0.8), 1e-14);
  EXPECT_NEAR(path_risk(risk, Path{{0, 0}, {10, 30}}).cost, across.cost * std::hypot(10, 30) / 30, 1e-14);
  const PathRisk beyond = path_risk(risk, Path{{5, -20}, {5, 40}});
  EXPECT_NEAR(beyond.cost, across.cost, 1e-14);
  EXPECT_NEAR(beyond.judged_m, 30, 1e-12);
  EXPECT_NEAR(beyond.outside_m, 30, 1e-12);
  EXPECT_NEAR(path_risk(risk, Path{{-5, -20}, {-5, 40}}).outside_m, 60, 1e-12);
  EXPECT_EQ(path_risk(risk, Path{{5, 5}}).cost, 0);
  PathRisk twice = across;
  twice += across;
  EXPECT_NEAR(twice.probability(), 1 - std::pow(0.9 * 0.8 * 0.7, 2), 1e-14);
}

// ledger: S1-37
TEST(MissionRisk, RefiningThePathChangesNothing) {
  const RiskGrid risk = random_grid(1);
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    Path coarse, fine;
    for (int i = 0; i < 5; ++i) coarse.emplace_back(random.uniform(-900, 900), random.uniform(-900, 900));
    for (std::size_t i = 0; i + 1 < coarse.size(); ++i) {
      const auto parts = 1 + random.index(40);
      for (std::uint64_t k = 0; k < parts; ++k) {
        fine.push_back(coarse[i] + (coarse[i + 1] - coarse[i]) * (static_cast<double>(k) / static_cast<double>(parts)));
      }
    }
    fine.push_back(coarse.back());
    const PathRisk a = path_risk(risk, coarse), b = path_risk(risk, fine);
    EXPECT_NEAR(a.cost, b.cost, 1e-10 * a.cost);
    EXPECT_NEAR(a.judged_m + a.outside_m, b.judged_m + b.outside_m, 1e-8);
    const PathRisk back = path_risk(risk, Path(coarse.rbegin(), coarse.rend()));
    EXPECT_NEAR(a.cost, back.cost, 1e-10 * a.cost);
  }
}

// Against the integral in small steps. ledger: S1-37
TEST(MissionRisk, IsTheIntegralOfTheRate) {
  const RiskGrid risk = random_grid(3);
  const Vector2d a(-700, -650), b(777, 333);
  constexpr int kSteps = 100000;
  double integral = 0;
  for (int i = 0; i < kSteps; ++i) {
    const Pixel p = risk.grid.at(a + (b - a) * ((i + 0.5) / kSteps));
    integral += risk.rate_per_m[static_cast<std::size_t>(p.row * 25 + p.column)] * (b - a).norm() / kSteps;
  }
  EXPECT_NEAR(path_risk(risk, Path{a, b}).cost, integral, 1e-4 * integral);
}

}  // namespace
}  // namespace isobath
