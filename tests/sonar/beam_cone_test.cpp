#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/sonar/beam_cone.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d direction(Angle azimuth, Angle depression) {
  return {cos(depression) * cos(azimuth), cos(depression) * sin(azimuth), sin(depression)};
}

BeamCone cone_of(double azimuth_deg, double depression_deg, double half_deg, const Vector3d& apex = {3, -2, 8}) {
  return {apex, direction(Angle::degrees(azimuth_deg), Angle::degrees(depression_deg)), Angle::degrees(half_deg)};
}

Vector3d random_direction(Random& random) {
  return Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

/// Uniform in the cone of directions, by rejection of what lies outside.
Vector3d random_inside(const BeamCone& cone, double range, Random& random) {
  const Vector3d across = cone.axis().unitOrthogonal();
  const double c = random.uniform(cone.cos_half_angle(), 1);
  const double s = std::sqrt(1 - c * c);
  const double turn = random.uniform(0, 2 * std::numbers::pi);
  const Vector3d u = c * cone.axis() + s * (std::cos(turn) * across + std::sin(turn) * cone.axis().cross(across));
  return cone.apex() + range * std::cbrt(random.uniform()) * u;
}

// ledger: S1-52
TEST(BeamCone, TakesApexAndAxisFromMountingAndAttitude) {
  RangeReading reading;
  reading.width = Angle::degrees(6);
  reading.X_BS.translation = {1, 0.5, 0.2};
  reading.X_BS.rotation = Rotation::from_heading_pitch_roll(Angle::degrees(30), {}, {});
  const Pose east{Rotation::from_heading(Angle::degrees(90)), {10, 20, 5}};
  const BeamCone level(reading, east);
  EXPECT_LT((level.apex() - Vector3d(9.5, 21, 5.2)).norm(), 1e-12);              // ahead is east, starboard is south
  EXPECT_LT((level.heading() - Vector2d(-0.5, std::sqrt(0.75))).norm(), 1e-12);  // 120 degrees
  EXPECT_NEAR(level.depression().degrees(), 0, 1e-12);
  EXPECT_NEAR(level.half_angle().degrees(), 3, 1e-12);

  reading.X_BS = {};
  const Pose nose_down{Rotation::from_heading_pitch_roll(Angle::degrees(90), Angle::degrees(-10), {}), {0, 0, 5}};
  EXPECT_NEAR(BeamCone(reading, nose_down).depression().degrees(), 10, 1e-12);
  EXPECT_LT((BeamCone(reading, nose_down).heading() - Vector2d(0, 1)).norm(), 1e-12);

  // Mounted 30 degrees to starboard, 5 degrees of roll: the axis dips by asin(sin 30 sin 5).
  reading.X_BS.rotation = Rotation::from_heading(Angle::degrees(30));
  const Pose rolled{Rotation::from_heading_pitch_roll({}, {}, Angle::degrees(5)), {0, 0, 5}};
  EXPECT_NEAR(std::sin(BeamCone(reading, rolled).depression().radians()), 0.5 * std::sin(5 * std::numbers::pi / 180),
              1e-12);
}

// ledger: S1-65
TEST(BeamCone, DepthIntervalAgreesWithTheDotProductAtAnyAttitude) {
  Random random(65);
  int inside = 0;
  int around_vertical = 0;
  for (int i = 0; i < 60000; ++i) {
    const Vector3d apex(random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(0, 30));
    const BeamCone cone(apex, random_direction(random), Angle::degrees(random.uniform(0.5, 80)));
    // Half of the points near the beam, so that both answers come often.
    const Vector3d p = i % 2 == 0 ? random_inside(cone, 50, random) : Vector3d(apex + 50 * random_direction(random));
    const Vector3d d = p - apex;
    const double margin = cone.axis().dot(d) - cone.cos_half_angle() * d.norm();
    if (std::abs(margin) < 1e-9 * d.norm()) continue;
    const auto interval = cone.depth_interval(p.head<2>());
    const bool by_interval = interval && interval->top_m <= p.z() && p.z() <= interval->bottom_m;
    ASSERT_EQ(by_interval, margin > 0) << "axis " << cone.axis().transpose() << ", half-angle "
                                       << cone.half_angle().degrees() << ", offset " << d.transpose();
    inside += margin > 0;
    around_vertical += cone.contains_vertical();
  }
  EXPECT_GT(inside, 20000);
  EXPECT_GT(around_vertical, 5000);
}

// ledger: S1-65
TEST(BeamCone, ASideThatIsExactlyOrNearlyVerticalCostsNoDigits) {
  for (const double near : {0.0, 1e-14, 1e-10, 1e-6, -1e-14, -1e-10, -1e-6}) {
    const double half = 20;
    const BeamCone cone = cone_of(40, 90 - half + near, half, {0, 0, 0});
    // Ahead at 10 m the upper side dips by tan(delta - a); below lies the cone, to great depth.
    const auto ahead = cone.depth_interval(10 * cone.heading());
    ASSERT_TRUE(ahead);
    EXPECT_NEAR(ahead->top_m, 10 * std::tan((90 - 2 * half + near) * std::numbers::pi / 180), 1e-9);
    EXPECT_GT(ahead->bottom_m, 1e7);
  }
}

// ledger: S1-65
TEST(BeamCone, EndsAcrossAtTheEdgeOfItsPlan) {
  for (const double delta : {0.0, 20.0, -35.0, 60.0}) {
    const BeamCone cone = cone_of(0, delta, 5, {0, 0, 0});
    const double edge = std::asin(std::sin(5 * std::numbers::pi / 180) / std::cos(delta * std::numbers::pi / 180));
    EXPECT_NEAR(std::atan(cone.plan_tangent()), edge, 1e-12);
    for (const double sign : {-1.0, 1.0}) {
      const double in = sign * edge * (1 - 1e-9);
      const double out = sign * edge * (1 + 1e-9);
      EXPECT_TRUE(cone.depth_interval(Vector2d(std::cos(in), std::sin(in))));
      EXPECT_FALSE(cone.depth_interval(Vector2d(std::cos(out), std::sin(out))));
    }
    EXPECT_FALSE(cone.depth_interval(Vector2d(-1, 0)));
  }
}

// ledger: S1-65
TEST(BeamCone, AroundTheVerticalEveryAzimuthIsInsideAndOneEndIsOpen) {
  const BeamCone down = cone_of(10, 85, 10, {0, 0, 2});
  const BeamCone up = cone_of(10, -85, 10, {0, 0, 2});
  EXPECT_EQ(down.plan_tangent(), std::numeric_limits<double>::infinity());
  for (int azimuth = 0; azimuth < 360; azimuth += 15) {
    const Vector2d at(std::cos(azimuth * std::numbers::pi / 180), std::sin(azimuth * std::numbers::pi / 180));
    const auto below = down.depth_interval(at);
    const auto above = up.depth_interval(at);
    ASSERT_TRUE(below && above);
    EXPECT_EQ(below->bottom_m, std::numeric_limits<double>::infinity());
    EXPECT_EQ(above->top_m, -std::numeric_limits<double>::infinity());
    EXPECT_NEAR(below->top_m - 2, 2 - above->bottom_m, 1e-12);
    const Vector3d edge(at.x(), at.y(), below->top_m);
    const double angle = std::acos(down.axis().dot((edge - down.apex()).normalized()));
    EXPECT_NEAR(angle * 180 / std::numbers::pi, 10, 1e-9);
  }
}

// ledger: S1-61 S1-65
TEST(BeamCone, OnTheAxisTheConeIsTheTwoPlanes) {
  for (const double delta : {-40.0, -3.0, 0.0, 5.0, 30.0, 80.0}) {
    const BeamCone cone = cone_of(77, delta, 3);
    for (const double h : {0.5, 10.0, 50.0}) {
      const auto exact = cone.depth_interval(cone.apex().head<2>() + h * cone.heading());
      ASSERT_TRUE(exact);
      EXPECT_NEAR(exact->top_m, cone.planes(h).top_m, 1e-9);
      EXPECT_NEAR(exact->bottom_m, cone.planes(h).bottom_m, 1e-9);
    }
  }
  EXPECT_NEAR(cone_of(0, 0, 3).planes(50).bottom_m - 8, 2.62, 0.005);
  EXPECT_NEAR(8 - cone_of(0, 0, 3).planes(50).top_m, 2.62, 0.005);
}

// ledger: S1-60
TEST(BeamCone, SlantRangeIsThatOfThePointNearestToTheAxis) {
  const BeamCone cone = cone_of(130, 20, 4);
  EXPECT_NEAR(cone.slant_range(cone.apex().head<2>() + 30 * cone.heading()), 30 / std::cos(20 * std::numbers::pi / 180),
              1e-9);
  Random random(60);
  for (int i = 0; i < 100; ++i) {
    const double eta = random.uniform(-0.07, 0.07);
    const Vector2d across(-cone.heading().y(), cone.heading().x());
    const Vector2d d = random.uniform(5, 50) * (std::cos(eta) * cone.heading() + std::sin(eta) * across);
    double best = -1;
    double range = 0;
    for (double w = 0; w < 60; w += 0.002) {
      const Vector3d p(d.x(), d.y(), w);
      const double c = cone.axis().dot(p) / p.norm();
      if (c > best) {
        best = c;
        range = p.norm();
      }
    }
    EXPECT_NEAR(cone.slant_range(cone.apex().head<2>() + d), range, 2e-3);
  }
}

// ledger: S1-57 S1-E08
TEST(BeamCone, PlanFootprintHoldsThePlanOfTheWholeCone) {
  Random random(57);
  int triangles = 0;
  for (int i = 0; i < 400; ++i) {
    const BeamCone cone = cone_of(random.uniform(0, 360), random.uniform(-89, 89), random.uniform(0.5, 50));
    const PlanFootprint footprint = plan_footprint(cone, 50, 0, cone.plan_tangent());
    triangles += footprint.is_triangle();
    Polygon grown(footprint.polygon().begin(), footprint.polygon().end());
    const Vector2d middle =
        footprint.is_triangle() ? Vector2d((grown[0] + grown[1] + grown[2]) / 3) : Vector2d((grown[0] + grown[2]) / 2);
    for (Vector2d& p : grown) p += 1e-9 * (p - middle);  // rounding
    EXPECT_GT(area(grown), 0);
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(contains(grown, random_inside(cone, 50, random).head<2>()));
  }
  EXPECT_GT(triangles, 150);
  EXPECT_LT(triangles, 350);
}

// ledger: S1-57 S1-58
TEST(BeamCone, PlanFootprintOfALevelBeamHasTheNumbersOfTheLedger) {
  const BeamCone cone = cone_of(0, 0, 3, {0, 0, 8});
  const PlanFootprint footprint = plan_footprint(cone, 50, 1, cone.plan_tangent());
  ASSERT_TRUE(footprint.is_triangle());
  EXPECT_NEAR(footprint.corners[1].x(), 51, 1e-9);
  EXPECT_NEAR(footprint.corners[2].y(), 2.67, 0.005);
  const BeamCone steep = cone_of(0, 20, 3, {0, 0, 8});
  EXPECT_NEAR(plan_footprint(steep, 50, 0, steep.plan_tangent()).corners[1].x(),
              50 * std::cos(17 * std::numbers::pi / 180), 1e-9);
}

// ledger: S1-04 S1-66
TEST(BeamCone, RangeToALevelPlaneIsThatOfTheSteepestSide) {
  EXPECT_NEAR(*cone_of(5, 0, 3).range_to_level(8 + 2.62), 50, 0.1);
  EXPECT_NEAR(*cone_of(5, 15, 3).range_to_level(18), 10 / std::sin(18 * std::numbers::pi / 180), 1e-9);
  EXPECT_NEAR(*cone_of(5, 88, 3).range_to_level(18), 10, 1e-12);
  EXPECT_NEAR(*cone_of(5, 2, 3).range_to_level(0), 8 / std::sin(std::numbers::pi / 180), 1e-9);
  EXPECT_FALSE(cone_of(5, 4, 3).range_to_level(0));
  EXPECT_FALSE(cone_of(5, -4, 3).range_to_level(20));
}

}  // namespace
}  // namespace isobath
