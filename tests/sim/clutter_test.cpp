#include <cmath>
#include <gtest/gtest.h>
#include <isobath/geometry/polygon.hpp>
#include <isobath/sim/clutter.hpp>
#include <isobath/sim/world.hpp>
#include <rapidcheck/gtest.h>

namespace isobath {
namespace {

using Eigen::Vector2d;

double to_segment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d ab = b - a;
  const double share = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (a + share * ab - p).norm();
}

/// Points along the border of a body from above, each 5 cm.
std::vector<Vector2d> border_of(const Body& body) {
  std::vector<Vector2d> corners, points;
  if (const auto* c = std::get_if<Cylinder>(&body.shape)) {
    for (int i = 0; i < 360; ++i) {
      corners.push_back(c->centre.head<2>() + c->radius * Vector2d(cos(Angle::degrees(i)), sin(Angle::degrees(i))));
    }
  } else if (const auto* b = std::get_if<Box>(&body.shape)) {
    const Rotation R = Rotation::from_heading(b->heading);
    for (const auto& [x, y] : {std::pair{1, 1}, std::pair{-1, 1}, std::pair{-1, -1}, std::pair{1, -1}}) {
      corners.push_back((b->centre + R * Eigen::Vector3d(x * b->size.x() / 2, y * b->size.y() / 2, 0)).head<2>());
    }
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d a = corners[i], b = corners[(i + 1) % corners.size()];
    const int parts = 1 + static_cast<int>((b - a).norm() / 0.05);
    for (int k = 0; k < parts; ++k) points.push_back(a + (b - a) * (static_cast<double>(k) / parts));
  }
  return points;
}

ClutterConfig dense(double passage_m) {
  ClutterConfig config;
  config.density = 40;
  config.passage_m = passage_m;
  return config;
}

Scene scene_with(const ClutterField& field) {
  Scene scene;
  scene.bodies = field.bodies;
  return scene;
}

// ledger: S6-67
RC_GTEST_PROP(Clutter, KeepsStartGoalAndPassageFree, (std::uint64_t seed)) {
  ClutterConfig config = dense(*rc::gen::element(0.0, 6.0, 16.0, 24.0));
  config.free_m = *rc::gen::element(5.0, 20.0, 35.0);
  const ClutterField field = clutter_field(config, seed);
  for (const Body& body : field.bodies) {
    for (const Vector2d& p : border_of(body)) {
      RC_ASSERT(p.norm() >= config.free_m - 1e-6);
      RC_ASSERT((p - Vector2d(config.length_m, 0)).norm() >= config.free_m - 1e-6);
      for (std::size_t i = 0; i + 1 < field.passage.size(); ++i) {
        RC_ASSERT(to_segment(p, field.passage[i], field.passage[i + 1]) >= config.passage_m / 2);
      }
    }
  }
}

RC_GTEST_PROP(Clutter, ThePassageLeadsFromStartToGoalWithoutTurningBack, (std::uint64_t seed)) {
  const ClutterConfig config = dense(16);
  const std::vector<Vector2d> way = clutter_field(config, seed).passage;
  RC_ASSERT(way.size() >= 3u);
  RC_ASSERT(way.front().norm() == 0);
  RC_ASSERT((way.back() - Vector2d(config.length_m, 0)).norm() == 0);
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const Vector2d leg = way[i + 1] - way[i];
    RC_ASSERT(leg.x() > 0);
    RC_ASSERT(std::abs(leg.y()) <= 0.71 * leg.x());
    RC_ASSERT(std::abs(way[i].y()) <= config.wander_m);
  }
}

// The same numbers on every machine: whole centimetres and degrees, and these ones for this seed.
RC_GTEST_PROP(Clutter, IsAFunctionOfItsSeedInWholeCentimetres, (std::uint64_t seed)) {
  const ClutterConfig config = dense(16);
  const ClutterField a = clutter_field(config, seed), b = clutter_field(config, seed);
  RC_ASSERT(a.bodies.size() == b.bodies.size());
  const auto whole = [](double metres) { return std::abs(metres * 100 - std::round(metres * 100)) < 1e-9; };
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    RC_ASSERT(a.bodies[i].name == b.bodies[i].name);
    if (const auto* c = std::get_if<Cylinder>(&a.bodies[i].shape)) {
      RC_ASSERT(c->centre == std::get<Cylinder>(b.bodies[i].shape).centre);
      RC_ASSERT(whole(c->centre.x()));
      RC_ASSERT(whole(c->radius));
    } else if (const auto* box = std::get_if<Box>(&a.bodies[i].shape)) {
      RC_ASSERT(box->size == std::get<Box>(b.bodies[i].shape).size);
      RC_ASSERT(std::abs(box->heading.degrees() - std::round(box->heading.degrees())) < 1e-9);
    }
  }
}

TEST(Clutter, HasAsManyBodiesAsItsDensitySaysWhereThereIsRoom) {
  ClutterConfig config = dense(0);
  config.density = 25;
  EXPECT_EQ(clutter_field(config, 7).bodies.size(), 16u);  // of 80 m x 80 m
  config.density = 0;
  EXPECT_TRUE(clutter_field(config, 7).bodies.empty());
}

TEST(Clutter, DrawsTheKindsByTheirShares) {
  ClutterConfig config = dense(0);
  config.density = 300;
  config.free_m = 5;
  int poles = 0, boxes = 0, all = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const Body& body : clutter_field(config, seed).bodies) {
      ++all;
      poles += std::holds_alternative<Cylinder>(body.shape);
      boxes += body.name.starts_with("box");
    }
  }
  // Nothing that stands in the water is without thickness: a sheet that is met end on returns no sound.
  ASSERT_GT(all, 1000);
  // Binomial, four standard deviations; large bodies find room a little less often.
  EXPECT_NEAR(static_cast<double>(poles) / all, 0.5, 0.03);
  EXPECT_NEAR(static_cast<double>(boxes) / all, 0.3, 0.03);
}

TEST(Clutter, TheWorldTakesItsBodiesAndABasinClosesItsSides) {
  ClutterConfig config = dense(0);
  config.basin = true;
  const ClutterField field = clutter_field(config, 3);
  const Scene scene = scene_with(field);
  const World world(scene);
  ASSERT_EQ(world.bodies().size(), field.bodies.size());
  for (const double heading : {-90.0, 90.0, 180.0}) {  // from the start nothing else stands there
    const Eigen::Vector3d u(cos(Angle::degrees(heading)), sin(Angle::degrees(heading)), 0);
    const auto hit = world.cast({0, 0, 15}, u, 100);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->range, heading == 180 ? config.free_m : config.breadth_m / 2, 1e-3);
  }
}

TEST(Clutter, RefusesAFieldWithoutRoom) {
  ClutterConfig config = dense(16);
  config.free_m = 60;
  EXPECT_THROW(clutter_field(config, 1), Error);
  config = dense(81);
  EXPECT_THROW(clutter_field(config, 1), Error);
  config = dense(16);
  config.pole_share = 0.8;
  EXPECT_THROW(clutter_field(config, 1), Error);
}

}  // namespace
}  // namespace isobath
