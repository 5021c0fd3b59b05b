// Evidence of bearings against plain sums: over the bias, over directions, and over points of the plane.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/bearing_posterior.hpp>
#include <numbers>
#include <vector>

namespace isobath::bearing_posterior {
namespace {

using Eigen::Vector2d;

constexpr double kDegree = std::numbers::pi / 180;

Polygon box(double north, double east, double half_north, double half_east) {
  return {{north - half_north, east - half_east},
          {north + half_north, east - half_east},
          {north + half_north, east + half_east},
          {north - half_north, east + half_east}};
}

double density(double x, double variance) {
  return std::exp(-0.5 * x * x / variance) / std::sqrt(2 * std::numbers::pi * variance);
}

/// The likelihood with the bias summed over its values.
double likelihood(const std::vector<BearingFrom>& bearings, double bias_sigma, const Vector2d& s) {
  constexpr int kSteps = 2000;
  double sum = 0;
  const double step = 16 * bias_sigma / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double bias = (i + 0.5) * step - 8 * bias_sigma;
    double product = density(bias, bias_sigma * bias_sigma) * step;
    for (const BearingFrom& b : bearings) {
      const Vector2d d = s - b.p_W;
      const double residual = std::remainder(b.bearing - bias - std::atan2(d.y(), d.x()), 2 * std::numbers::pi);
      product *= density(residual, b.sigma * b.sigma + b.position_sigma_m * b.position_sigma_m / d.squaredNorm());
    }
    sum += product;
  }
  return sum;
}

/// Bearings to `sound` from places along a line.
std::vector<BearingFrom> passing(const Vector2d& sound, int count, double apart_m, double sigma, std::uint64_t seed) {
  Random random(seed);
  std::vector<BearingFrom> bearings;
  const double bias = 1.5 * kDegree * random.normal();
  for (int i = 0; i < count; ++i) {
    const Vector2d p(apart_m * i, 0);
    const Vector2d d = sound - p;
    bearings.push_back({p, std::atan2(d.y(), d.x()) + bias + sigma * random.normal(), sigma, 0.2});
  }
  return bearings;
}

// ledger: S4-54
TEST(BearingPosterior, TheBiasIsIntegratedOut) {
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const double sigma = random.uniform(1, 5) * kDegree, bias = random.uniform(0.5, 5) * kDegree;
    const Vector2d sound(random.uniform(-60, 60), random.uniform(10, 60));
    const auto bearings = passing(sound, 1 + static_cast<int>(random.index(6)), 5, sigma, random.bits());
    BearingPosterior posterior(bearings, bias, 300);
    const Vector2d s = sound + Vector2d(random.normal(), random.normal());
    EXPECT_NEAR(posterior.log_likelihood(s), std::log(likelihood(bearings, bias, s)), 1e-3);
  }
}

// One bearing at an obstacle far away: the mass of its angular extent under the normal error, over that extent.
// ledger: S4-54
TEST(BearingPosterior, OfOneBearingIsTheMassOfTheExtent) {
  const double sigma = 3 * kDegree;
  const Polygon far = box(0, 200, 20, 1);  // from -5.7 to 5.7 degrees off east
  const Polygon* pieces[] = {&far};
  const double low = std::atan2(-20, 200), high = std::atan2(20, 200);
  const auto phi = [&](double x) { return 0.5 * std::erfc(-x / std::sqrt(2) / sigma); };
  for (const double off : {0.0, 3.0, 6.0, 9.0, 14.0}) {
    const BearingFrom bearing{{0, 0}, std::numbers::pi / 2 - off * kDegree, sigma, 0};
    BearingPosterior posterior({&bearing, 1}, 0, 300);
    const double mass = phi(high - off * kDegree) - phi(low - off * kDegree);
    EXPECT_NEAR(posterior.log_evidence({pieces, 0}), std::log(mass / (high - low)), 0.03) << off;
    SoundPlace place;
    EXPECT_NEAR(posterior.log_evidence_of_none(place), std::log(1 / (2 * std::numbers::pi)), 0.02) << "uniform";
  }
}

struct Sums {
  double obstacle, none;
  Vector2d mean;
};

/// The means of the likelihood over the obstacle's region and over the disc, by points 0.25 m apart.
Sums sums(const std::vector<BearingFrom>& bearings, double bias, const Polygon& piece, double reach, double disc_m) {
  constexpr double kStep = 0.25;
  double in = 0, count_in = 0, all = 0;
  Vector2d moment = Vector2d::Zero();
  BearingPosterior posterior(bearings, bias, disc_m);
  const int half = static_cast<int>(disc_m / kStep);
  for (int i = -half; i < half; ++i) {
    for (int j = -half; j < half; ++j) {
      const Vector2d s((i + 0.5) * kStep, (j + 0.5) * kStep);
      if (s.norm() > disc_m) continue;
      const double value = std::exp(posterior.log_likelihood(s));
      all += value;
      moment += value * s;
      if (distance_from(piece, s) > reach) continue;
      in += value;
      count_in += 1;
    }
  }
  const double area = std::numbers::pi * disc_m * disc_m / (kStep * kStep);
  return {std::log(in / count_in), std::log(all / area), moment / all};
}

// ledger: S4-54
TEST(BearingPosterior, EvidenceIsThePlainSumOverPoints) {
  const Polygon barge = box(20, 25, 8, 3);
  const Polygon* pieces[] = {&barge};
  double worst = 0;
  for (const int count : {1, 2, 5, 9}) {
    for (const Vector2d& sound : {Vector2d(22, 26), Vector2d(8, 50)}) {
      const auto bearings = passing(sound, count, 4, 2 * kDegree, 5 + static_cast<std::uint64_t>(count));
      const double bias = 1.5 * kDegree;
      const Sums plain = sums(bearings, bias, barge, 3, 120);
      BearingPosterior posterior(bearings, bias, 120);
      SoundPlace place;
      worst = std::max(worst, std::abs(posterior.log_evidence_of_none(place) - plain.none));
      if (plain.obstacle > -12) {
        worst = std::max(worst, std::abs(posterior.log_evidence({pieces, 3}) - plain.obstacle));
      }
      EXPECT_TRUE(count < 5 || (place.mean - plain.mean).norm() < 0.5) << count;
    }
  }
  EXPECT_LT(worst, 0.05);
}

// ledger: S4-54
TEST(BearingPosterior, ManyBearingsFromOnePlaceSayNoMoreThanTheBiasAllows) {
  const Polygon barge = box(0, 30, 6, 3);
  const Polygon* pieces[] = {&barge};
  const auto ratio = [&](int count) {
    std::vector<BearingFrom> bearings(static_cast<std::size_t>(count), {{0, 0}, std::numbers::pi / 2, 3 * kDegree, 0});
    BearingPosterior posterior(bearings, 1.5 * kDegree, 300);
    SoundPlace place;
    const double none = posterior.log_evidence_of_none(place);
    return posterior.log_evidence({pieces, 0}) - none;
  };
  const double extent = 2 * std::atan2(6, 27);
  EXPECT_NEAR(ratio(30), std::log(2 * std::numbers::pi / extent), 0.4) << "at most a sharp direction, once";
  EXPECT_NEAR(ratio(30), ratio(15), 0.02);
}

TEST(BearingPosterior, BehindTheVehicleThereIsNoEvidence) {
  const Polygon astern = box(0, -30, 6, 3);
  const Polygon* pieces[] = {&astern};
  const BearingFrom bearing{{0, 0}, std::numbers::pi / 2, 3 * kDegree, 0};
  BearingPosterior posterior({&bearing, 1}, 0, 300);
  EXPECT_LT(posterior.log_evidence({pieces, 4}), -100);
  EXPECT_LT(posterior.log_evidence({{}, 4}), -100) << "an obstacle without an outline";
}

}  // namespace
}  // namespace isobath::bearing_posterior
