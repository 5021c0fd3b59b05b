// Lines and arcs met by rays: against closed forms, and against the three-dimensional world of the same scene.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/sim/plane_section.hpp>
#include <isobath/sim/world.hpp>
#include <numbers>
#include <set>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

Vector2d bearing_vector(double degrees) {
  const Angle a = Angle::degrees(degrees);
  return {cos(a), sin(a)};
}
double section_range(const PlaneSection& section, const Vector2d& p, double degrees) {
  const auto hit = section.cast(p, bearing_vector(degrees));
  return hit ? hit->range : -1;
}
PlaneSection square_section() {
  PlaneSection section;
  section.add(SectionLine{{-5, -5}, {5, -5}, 0});
  section.add(SectionLine{{5, -5}, {5, 5}, 1});
  section.add(SectionLine{{5, 5}, {-5, 5}, 2});
  section.add(SectionLine{{-5, 5}, {-5, -5}, 3});
  return section;
}
Scene polygon_room() { return load_scene((test::source_folder() / "scenarios/polygon_room.toml").string()); }

// ledger: S4-31
TEST(PlaneSection, MeetsASquareACircleAndTheirEndsWhereTheClosedFormsSay) {
  const PlaneSection box = square_section();
  const Vector2d p(1, 2);
  for (double a = 0.5; a < 360; a += 1) {
    const Vector2d u = bearing_vector(a);
    const double to_x = ((u.x() > 0 ? 5 : -5) - p.x()) / u.x(), to_y = ((u.y() > 0 ? 5 : -5) - p.y()) / u.y();
    const auto hit = box.cast(p, u);
    ASSERT_TRUE(hit);
    ASSERT_NEAR(hit->range, std::min(to_x, to_y), 1e-12);
    const double cosine = to_x < to_y ? std::abs(u.x()) : std::abs(u.y());
    ASSERT_NEAR(cos(hit->incidence), cosine, 1e-9);
    ASSERT_EQ(hit->object, to_x < to_y ? (u.x() > 0 ? 1 : 3) : (u.y() > 0 ? 2 : 0));
  }
  PlaneSection circle;
  circle.add(SectionArc{{0, 0}, 4, Angle::degrees(0), Angle::degrees(360)});
  EXPECT_NEAR(section_range(circle, {-10, 0}, 0), 6, 1e-12) << "from outside";
  EXPECT_NEAR(section_range(circle, {1, 0}, 0), 3, 1e-12) << "from inside";
  EXPECT_NEAR(section_range(circle, {-10, 4 - 1e-9}, 0), 10, 1e-3) << "tangent";
  EXPECT_EQ(section_range(circle, {-10, 4 + 1e-9}, 0), -1);
  EXPECT_NEAR(circle.cast({-10, 2}, {1, 0})->incidence.degrees(), 30, 1e-9);
  PlaneSection line;
  line.add(SectionLine{{10, -2}, {10, 3}});
  EXPECT_GT(section_range(line, {0, 3 - 1e-9}, 0), 0) << "its end";
  EXPECT_EQ(section_range(line, {0, 3 + 1e-9}, 0), -1);
  EXPECT_EQ(section_range(line, {20, 0}, 0), -1) << "behind";
  EXPECT_EQ(section_range(line, {10, -10}, 90), -1) << "edge on";
}

// ledger: S4-31
TEST(PlaneSection, MeetsAnArcWithinItsAnglesFromBothSides) {
  PlaneSection section;
  section.add(SectionArc{{0, 0}, 5, Angle::degrees(-30), Angle::degrees(60)});
  for (const double a : {-40.0, -30.01, -29.99, 0.0, 29.99, 30.01, 90.0, 180.0}) {
    const bool on = std::abs(a) < 30;
    EXPECT_NEAR(section_range(section, {0, 0}, a), on ? 5 : -1, 1e-12) << "hollow " << a;
    EXPECT_NEAR(section_range(section, 12 * bearing_vector(a), a + 180),
                on                  ? 7
                : std::abs(a) > 150 ? 17
                                    : -1,
                1e-12)
        << "round " << a;
  }
}

// ledger: S4-31 S4-34
TEST(PlaneSection, OfASceneIsWhatItsWorldIsAtThatDepth) {
  const Scene scene = parse_scene(
      "[scene]\n[[prism]]\nlines = [[-8, -9, 12, -9], [12, -9, 12, 9]]\narcs = [[2, 9, 10, 20, 200]]\ntop = 2\n"
      "bottom = 22\nbottom_scale = 2\n[[prism]]\narcs = [[-3, 1, 2, 0, 360]]\ntop = 8\nbottom = 12\n",
      "scene.toml");
  const World world(scene);
  for (const double depth : {3.0, 7.9, 10.0, 13.0, 21.0}) {
    const PlaneSection section(scene, depth);
    int met = 0;
    for (double a = 0.3; a < 360; a += 0.7) {
      const Vector2d u = bearing_vector(a), p(3, -2);
      const auto hit = section.cast(p, u);
      const auto truth = world.cast({p.x(), p.y(), depth}, {u.x(), u.y(), 0}, 1000);
      if (!hit || !truth || hit->incidence.degrees() > 80) continue;
      ASSERT_NEAR(hit->range, truth->range, 0.02) << depth << " " << a;  // the world's arcs are chords
      ++met;
    }
    EXPECT_GT(met, 150) << depth;
  }
  EXPECT_TRUE(PlaneSection(scene, 1).lines().empty());
}

// ledger: S4-32
TEST(SectionSonar, TakesTheNearestOfABeamsRaysOrTheStrongest) {
  PlaneSection section;  // a corner pointing at the sonar, in the middle of the beam to the north
  section.add(SectionLine{{10, 0}, {12, 2}, 1});
  section.add(SectionLine{{10, 0}, {12, -2}, 2});
  section.add(SectionLine{{10.3, -0.3}, {10.3, -4}, 3});
  SectionSonarConfig config;
  config.noise = false;
  Random random(1);
  const auto nearest = scan(section, {0, 0}, config, random);
  ASSERT_EQ(nearest.size(), 144u);
  EXPECT_NEAR(*nearest[0].range_m, 10, 1e-12) << "the corner itself";
  EXPECT_FALSE(nearest[72].range_m) << "nothing astern";
  PlaneSection facing;
  facing.add(SectionLine{{8, 0}, {9.9, 0.3}, 1});  // nearer, and nearly edge on
  facing.add(SectionLine{{10, -3}, {10, 3}, 2});
  EXPECT_EQ(scan(facing, {0, 0}, config, random)[0].truth.object, 1);
  config.pick = SectionSonarConfig::Pick::kStrongest;
  EXPECT_EQ(scan(facing, {0, 0}, config, random)[0].truth.object, 2);
  config.range_m = 9;
  EXPECT_FALSE(scan(section, {0, 0}, config, random)[0].range_m) << "out of range";
}

// ledger: S4-33 S4-E03
TEST(SectionSonar, ErrsAsItsDeviationsSay) {
  PlaneSection circle;
  circle.add(SectionArc{{0, 0}, 100, Angle::degrees(0), Angle::degrees(360)});
  SectionSonarConfig config;
  config.range_m = 200;
  for (const double radius : {20.0, 100.0}) {
    PlaneSection ring;
    ring.add(SectionArc{{0, 0}, radius, Angle::degrees(0), Angle::degrees(360)});
    Random random(2);
    double sum = 0, squares = 0, angles = 0;
    int n = 0;
    for (int turn = 0; turn < 100; ++turn) {
      const auto readings = scan(ring, {0, 0}, config, random);
      for (std::size_t i = 0; i < readings.size(); ++i) {
        const double e = *readings[i].range_m - radius;
        const double a = std::remainder(readings[i].bearing.degrees() - 2.5 * static_cast<double>(i), 360);
        sum += e;
        squares += e * e;
        angles += a * a;
        ++n;
      }
    }
    const double sigma = radius < 50 ? 0.15 : 0.3;
    EXPECT_NEAR(sum / n, 0, 4 * sigma / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(squares / n), sigma, 0.02 * sigma);
    EXPECT_NEAR(std::sqrt(angles / n), 2.5 / 2.355, 0.02);
  }
  Random a(3), b(3);
  EXPECT_EQ(*scan(circle, {0, 0}, config, a)[5].range_m, *scan(circle, {0, 0}, config, b)[5].range_m) << "seeded";
}

// ledger: S4-35
TEST(ScanPath, RunsAlongTheWayPointsInANoisySineOfDepth) {
  Scene scene = polygon_room();
  Random random(4);
  const ScanPath made = scan_path(scene, 10, random);
  ASSERT_EQ(made.scans.size(), 10u);
  EXPECT_EQ(made.scans.front().number, 1);
  EXPECT_EQ(made.scans.back().number, 10);
  EXPECT_LT((made.scans.front().at.head<2>() - Vector2d(-12, -10)).norm(), 1e-9);
  EXPECT_LT((made.scans.back().at.head<2>() - Vector2d(-2, 14)).norm(), 1e-9);
  double shallow = 1e9, deep = 0, length = 0, noise = 0;
  scene.vehicle.dive_noise = 0;
  Random again(4);
  const ScanPath smooth = scan_path(scene, 10, again);
  for (std::size_t i = 0; i < made.path.size(); ++i) {
    shallow = std::min(shallow, made.path[i].z());
    deep = std::max(deep, made.path[i].z());
    if (i > 0) length += (smooth.path[i] - smooth.path[i - 1]).head<2>().norm();
    const double sine = 10 + 2 * std::sin(2 * std::numbers::pi * length / 0.5 / 60);
    EXPECT_NEAR(smooth.path[i].z(), sine, 0.05) << "corners are cut by at most a part of a leg";
    noise += std::pow(made.path[i].z() - smooth.path[i].z(), 2);
  }
  EXPECT_NEAR(deep - shallow, 4, 0.8);
  EXPECT_NEAR(std::sqrt(noise / static_cast<double>(made.path.size())), 0.2, 0.12);
  scene.waypoints.clear();
  EXPECT_THROW((void)scan_path(scene, 10, random), Error);
}

}  // namespace
}  // namespace isobath
