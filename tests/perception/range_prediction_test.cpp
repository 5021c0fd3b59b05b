#include <functional>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/range_prediction.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMaximum = 50;

BeamCone cone_of(double azimuth_deg, double depression_deg, double half_deg, const Vector3d& apex) {
  const double a = azimuth_deg * kDegree;
  const double d = depression_deg * kDegree;
  return {apex, {std::cos(d) * std::cos(a), std::cos(d) * std::sin(a), std::sin(d)}, Angle::degrees(half_deg)};
}

/// A map that is a function of the place.
class Prediction : public testing::Test {
 protected:
  using Depth = std::function<double(const Vector2d& north_east)>;

  RangePrediction predict(const BeamCone& cone, const Depth& depth, RangeDeviation config = {}) {
    RangePredictor predictor(config, grid_);
    const PixelWindow window = predictor.window(cone, kMaximum);
    std::vector<float> patch;
    for (int r = window.row; r < window.row + window.height; ++r) {
      for (int c = window.column; c < window.column + window.width; ++c) {
        patch.push_back(static_cast<float>(depth(grid_.centre({c, r}))));
      }
    }
    predictor.pixels(cone, kMaximum, window);
    return predictor.predict_listed(cone, kMaximum, {window, patch});
  }
  static Depth flat(double depth_m) {
    return [depth_m](const Vector2d&) { return depth_m; };
  }

  PixelGrid grid_{{3.3, -8.7}, 0.5};
};

// ledger: S1-04
TEST_F(Prediction, OfADepthSonarOverAFlatBottomIsTheAltitude) {
  Random random(4);
  for (const double altitude : {0.7, 2.0, 10.0, 35.0}) {
    for (const double tilt : {0.0, 2.0}) {
      const Vector3d apex(random.uniform(-5, 5), random.uniform(-5, 5), 6);
      const BeamCone cone = cone_of(random.uniform(0, 360), 90 - tilt, 3, apex);
      EXPECT_NEAR(predict(cone, flat(6 + altitude)).expected_m, altitude, 1e-4);
    }
  }
}

// ledger: S1-04 S1-66
TEST_F(Prediction, OfAForwardBeamOverAFlatBottomIsThatOfItsLowerSide) {
  Random random(5);
  for (int i = 0; i < 60; ++i) {
    const double delta = random.uniform(-2, 60);
    const double half = random.uniform(2.1, 8);
    const double altitude = random.uniform(1.5, 20);
    const BeamCone cone =
        cone_of(random.uniform(0, 360), delta, half, {random.uniform(-5, 5), random.uniform(-5, 5), 4});
    const double expected = altitude / std::sin((delta + half) * kDegree);
    const double found = predict(cone, flat(4 + altitude)).expected_m;
    if (expected < kMaximum - 0.5) {
      EXPECT_NEAR(found, expected, grid_.pixel_m / 4) << delta << " " << half << " " << altitude;
    } else if (expected > kMaximum + 0.5) {
      EXPECT_GT(found, kMaximum);
    }
  }
}

// ledger: S1-04
TEST_F(Prediction, MeetsAWallWhereTheBeamDoes) {
  const auto wall = [](const Vector2d& p) { return p.x() > 25.0 ? 2.0 : 100.0; };
  // A level beam at 10 m: the wall stands across it. One that looks up by 20 degrees passes 2 m at 22 m and misses.
  EXPECT_NEAR(predict(cone_of(0, 0, 3, {0, 0, 10}), wall).expected_m, 25, grid_.pixel_m);
  EXPECT_GT(predict(cone_of(0, -24, 3, {0, 0, 10}), wall).expected_m, kMaximum);
  // Only ground in the beam counts: a wall whose top is below it is not met.
  const auto low = [](const Vector2d& p) { return p.x() > 25.0 ? 11.4 : 100.0; };
  EXPECT_NEAR(predict(cone_of(0, 0, 3, {0, 0, 10}), low).expected_m, 1.4 / std::sin(3 * kDegree), 0.3);
}

// Against the nearest of many points of the ground inside the cone, over ground of waves and steps.
// ledger: S1-04 S1-65
TEST_F(Prediction, IsTheNearestGroundInsideTheConeOfAnyAttitude) {
  const auto waves = [](const Vector2d& p) {
    return 16 + 2 * std::sin(p.x() / 4) + 1.5 * std::cos(p.y() / 5) - (p.y() > 20 ? 4 : 0);
  };
  Random random(65);
  int echoes = 0;
  for (int i = 0; i < 15; ++i) {
    const BeamCone cone = cone_of(random.uniform(0, 360), random.uniform(0, 90), random.uniform(3, 15), {0, 0, 5});
    const double found = predict(cone, waves).expected_m;
    double nearest = 1e9;
    // Ground as the map has it: level squares with upright sides, sampled.
    const PixelWindow window = RangePredictor({}, grid_).window(cone, kMaximum);
    for (int r = window.row; r < window.row + window.height; ++r) {
      for (int c = window.column; c < window.column + window.width; ++c) {
        const Vector2d centre = grid_.centre({c, r});
        const double depth = waves(centre);
        for (const double n : {-0.24, -0.08, 0.08, 0.24}) {
          for (const double e : {-0.24, -0.08, 0.08, 0.24}) {
            const Vector3d p(centre.x() + n, centre.y() + e, depth);
            const double range = (p - cone.apex()).norm();
            if (cone.axis().dot(p - cone.apex()) >= cone.cos_half_angle() * range) nearest = std::min(nearest, range);
          }
        }
      }
    }
    if (nearest > 49) continue;
    ++echoes;
    EXPECT_NEAR(found, nearest, 1.5 * grid_.pixel_m);
  }
  EXPECT_GT(echoes, 8);
}

// ledger: S1-04
TEST_F(Prediction, ExpectsNothingWhereTheMapKnowsNothing) {
  const RangePrediction p = predict(cone_of(0, 0, 3, {0, 0, 5}), flat(std::nan("")));
  EXPECT_GT(p.expected_m, kMaximum);
  EXPECT_TRUE(p.agrees(std::nullopt, 0.2, 3));
  EXPECT_FALSE(p.agrees(20.0, 0.2, 3));
}

// ledger: S1-04
TEST_F(Prediction, GrowsUnsureWhereTheBeamGrazes) {
  RangeDeviation config;
  config.vertical_m = 0.1;
  config.attitude = {};
  const double steep = predict(cone_of(0, 90, 3, {0, 0, 5}), flat(25), config).sigma_m;
  EXPECT_NEAR(steep, 0.1, 1e-3);
  const double grazing = predict(cone_of(30, 0, 3, {0, 0, 5}), flat(7), config).sigma_m;
  EXPECT_NEAR(grazing, 0.1 / std::sin(3 * kDegree), 0.2);
  config.vertical_m = 0;
  config.attitude = Angle::degrees(0.2);
  const RangePrediction turning = predict(cone_of(30, 10, 3, {0, 0, 5}), flat(12), config);
  EXPECT_NEAR(turning.sigma_m, turning.expected_m * 0.2 * kDegree / std::sin(13 * kDegree), 0.15);
}

// ledger: S1-04
TEST_F(Prediction, GateIsThatOfBothDeviations) {
  RangePrediction p;
  p.expected_m = 20;
  p.sigma_m = 0.4;
  p.max_range_m = 50;
  EXPECT_TRUE(p.agrees(21.49, 0.3, 3));
  EXPECT_FALSE(p.agrees(21.51, 0.3, 3));
  EXPECT_TRUE(p.agrees(18.51, 0.3, 3));
  EXPECT_FALSE(p.agrees(18.49, 0.3, 3));
  EXPECT_FALSE(p.agrees(std::nullopt, 0.3, 3));
  p.expected_m = 49;
  EXPECT_TRUE(p.agrees(std::nullopt, 0.3, 3));
  p.expected_m = 51;  // just beyond the limit: neither answer is a surprise
  EXPECT_TRUE(p.agrees(49.9, 0.3, 3));
  EXPECT_TRUE(p.agrees(std::nullopt, 0.3, 3));
}

// ledger: S1-66
TEST_F(Prediction, OfTheSurfaceIsThatOfTheUpperSide) {
  const auto expected = [](const BeamCone& cone) {
    return predict_surface(cone, kMaximum, RangeDeviation()).expected_m;
  };
  EXPECT_NEAR(expected(cone_of(0, 0, 3, {0, 0, 0.5})), 0.5 / std::sin(3 * kDegree), 1e-9);
  EXPECT_GT(expected(cone_of(0, 0, 3, {0, 0, 2.7})), kMaximum);
  EXPECT_GT(expected(cone_of(0, 4, 3, {0, 0, 0.5})), kMaximum);
  EXPECT_NEAR(expected(cone_of(0, -90, 3, {0, 0, 12})), 12, 1e-9);
}

// ledger: S1-73
TEST_F(Prediction, DeviationsAddInSquares) {
  RangeDeviation d;
  d.floor_m = 0.1;
  d.share = 0.01;
  d.attitude = Angle::radians(0.02);
  EXPECT_NEAR(d.total(50, 0.5), std::sqrt(0.6 * 0.6 + 0.5 * 0.5 + 1.0 * 1.0), 1e-12);
}

}  // namespace
}  // namespace isobath
