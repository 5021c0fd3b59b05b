// Courses along pipelines, ridges and ravines.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/feature_course.hpp>
#include <isobath/planning/traversability.hpp>
#include <isobath/vehicle/plant.hpp>
#include <numbers>
#include <tests/planning/array_field.hpp>
#include <tests/vehicle/models.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Line = std::vector<Vector2d>;
using test::ArrayField;

double distance_to(const Vector2d& p, const Line& line) {
  double nearest = INFINITY;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector2d d = line[i + 1] - line[i];
    const double t = std::clamp((p - line[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p - line[i] - t * d).norm());
  }
  return nearest;
}

/// Points along a line, every `step` m.
Line sampled(const Line& line, double step) {
  Line out;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const int parts = 1 + static_cast<int>((line[i + 1] - line[i]).norm() / step);
    for (int k = 0; k < parts; ++k) out.push_back(line[i] + (line[i + 1] - line[i]) * (static_cast<double>(k) / parts));
  }
  out.push_back(line.back());
  return out;
}

Line wandering(Random& random, int segments, double length, double bend_deg) {
  Line line = {{0, 0}};
  double heading = random.uniform(-3, 3);
  for (int i = 0; i < segments; ++i) {
    line.push_back(line.back() + length * Vector2d(std::cos(heading), std::sin(heading)));
    heading += Angle::degrees(random.uniform(-bend_deg, bend_deg)).radians();
  }
  return line;
}

/// The line in pieces of one to `most` legs.
std::vector<Line> pieces_of(const Line& line, Random& random, std::size_t most) {
  std::vector<Line> pieces;
  for (std::size_t from = 0; from + 1 < line.size();) {
    const std::size_t to = std::min(line.size() - 1, from + 1 + random.index(most));
    pieces.emplace_back(line.begin() + static_cast<std::ptrdiff_t>(from),
                        line.begin() + static_cast<std::ptrdiff_t>(to) + 1);
    from = to;
  }
  return pieces;
}

// ledger: S1-24
TEST(FeatureCourse, ChainsPiecesInAnyOrderAndSense) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Line line = wandering(random, 20, 25, 20);
    auto pieces = pieces_of(line, random, trial % 2 == 0 ? 1 : 5);
    for (std::size_t i = pieces.size() - 1; i > 0; --i) std::swap(pieces[i], pieces[random.index(i + 1)]);
    for (Line& piece : pieces) {
      if (random.uniform() < 0.5) std::reverse(piece.begin(), piece.end());
    }
    pieces.push_back({{5000, 5000}, {5010, 5000}});  // another pipeline, elsewhere
    pieces.push_back({line.front()});                // no line at all
    EXPECT_EQ(chain_lines(pieces, line.front() + Vector2d(1, 1), 0.01), line);
    EXPECT_EQ(chain_lines(pieces, line.back() + Vector2d(1, 1), 0.01), Line(line.rbegin(), line.rend()));
  }
  EXPECT_TRUE(chain_lines({}, {0, 0}, 0.01).empty());
}

// ledger: S1-24
TEST(FeatureCourse, GoesStraightOnWhereAnotherLineJoins) {
  const std::vector<Line> tee = {{{0, 0}, {10, 0}}, {{10, 0}, {10, 8}}, {{10, 0}, {20, 1}}};
  EXPECT_EQ(chain_lines(tee, {0, 0}, 0.01), (Line{{0, 0}, {10, 0}, {20, 1}}));
}

// ledger: S1-24
TEST(FeatureCourse, FollowsThePartOfALineBetweenTwoPlaces) {
  const Line line = {{0, 0}, {10, 0}, {10, 10}};
  EXPECT_EQ(part_of_line(line, {2, 1}, Vector2d(11, 5)), (Line{{2, 0}, {10, 0}, {10, 5}}));
  EXPECT_EQ(part_of_line(line, {11, 5}, Vector2d(2, 1)), (Line{{10, 5}, {10, 0}, {2, 0}}));
  EXPECT_EQ(part_of_line(line, {2, 1}, {}), (Line{{2, 0}, {10, 0}, {10, 10}})) << "the farther end";
  EXPECT_EQ(part_of_line(line, {11, 5}, {}), (Line{{10, 5}, {10, 0}, {0, 0}}));
  const Line ring = chain_lines(std::vector<Line>{line, {{10, 10}, {0, 10}, {0.001, 0}}}, {0, 0}, 0.01);
  ASSERT_EQ(ring.front(), ring.back());
  EXPECT_EQ(part_of_line(ring, {4, -1}, Vector2d(11, 4)), (Line{{4, 0}, {10, 0}, {10, 4}})) << "the shorter way";
  EXPECT_EQ(part_of_line(ring, {4, -1}, Vector2d(-1, 4)).size(), 3u) << "the other way round";
  const Line once = part_of_line(ring, {4, -1}, {});
  EXPECT_EQ(once.front(), once.back());
  EXPECT_EQ(once.size(), ring.size() + 1);
}

TEST(FeatureCourse, ASimplifiedLineStaysWithinItsTolerance) {
  Random random(6);
  Line line;
  for (int i = 0; i < 500; ++i) line.emplace_back(i + random.normal(), 40 * std::sin(0.02 * i) + random.normal());
  const Line simple = simplified(line, 3);
  EXPECT_LT(simple.size(), 60u);
  for (const Vector2d& p : line) EXPECT_LE(distance_from_line(simple, p), 3);
  EXPECT_EQ(simplified(line, 0).size(), line.size());
}

// By hand: a line north, then east; starboard is the inside of the bend. ledger: S1-24
TEST(FeatureCourse, JointsAreMitredOrRound) {
  const Line bend = {{0, 0}, {100, 0}, {100, 100}};
  const Line inside = offset_line(bend, 10, 1.5, 0.1);
  ASSERT_EQ(inside.size(), 3u);
  EXPECT_LT((inside[0] - Vector2d(0, 10)).norm() + (inside[1] - Vector2d(90, 10)).norm() +
                (inside[2] - Vector2d(90, 100)).norm(),
            1e-9);
  const Line mitred = offset_line(bend, -10, 1.5, 0.1);
  ASSERT_EQ(mitred.size(), 3u);
  EXPECT_LT((mitred[1] - Vector2d(110, -10)).norm(), 1e-9);
  const Line round = offset_line(bend, -10, 1.2, 0.1);
  ASSERT_GT(round.size(), 5u);
  for (std::size_t i = 1; i + 1 < round.size(); ++i) EXPECT_NEAR((round[i] - bend[1]).norm(), 10, 1e-9);
  EXPECT_EQ(offset_line(bend, 0, 1.5, 0.1), bend);
}

// ledger: S1-24
TEST(FeatureCourse, KeepsItsDistance) {
  Random random(2);
  int judged = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Line line = wandering(random, 20, random.uniform(4, 25), 35);
    const double offset = random.uniform(2, 12) * (trial % 2 == 0 ? 1 : -1);
    const Line course = offset_line(line, offset, 1.5, 0.2);
    // A line that comes back to itself leaves no room; such a trial says nothing about joints.
    bool returns = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
      for (std::size_t j = i + 1; j < line.size(); ++j) {
        const double along = (line[1] - line[0]).norm() * static_cast<double>(j - i);
        returns = returns || (along > 40 && (line[i] - line[j]).norm() < 26);
      }
    }
    if (returns) continue;
    ++judged;
    for (const Vector2d& p : sampled(course, 0.5)) {
      EXPECT_GT(distance_to(p, line), std::abs(offset) - 0.2 - 1e-9) << trial;
      EXPECT_LT(distance_to(p, line), 1.5 * std::abs(offset) + 1e-9) << trial;
    }
    EXPECT_LT((course.front() - line.front()).norm(), std::abs(offset) + 1e-9);
    EXPECT_LT((course.back() - line.back()).norm(), std::abs(offset) + 1e-9);
  }
  EXPECT_GT(judged, 25);
}

// ledger: S1-24
TEST(FeatureCourse, ThereAndBackGoesRoundTheEnd) {
  const Line spur = {{0, 0}, {50, 0}, {0, 0}};
  const Line course = offset_line(spur, 5, 1.5, 0.1);
  double farthest = 0;
  for (const Vector2d& p : sampled(course, 0.5)) {
    EXPECT_GT(distance_to(p, spur), 4.9 - 1e-9);
    farthest = std::max(farthest, p.x());
  }
  EXPECT_NEAR(farthest, 55, 0.1);
}

/// A bottom with a ridge across, and an unknown patch.
ArrayField ridge() {
  ArrayField map({{50, -20}, 0.5}, {0, 0, 480, 200}, 30);
  for (int row = 0; row < 200; ++row) {
    for (int column = 0; column < 480; ++column) {
      const double east = -20 + 0.5 * (column + 0.5);
      map.set({column, row}, 30 - 18 * std::exp(-std::pow((east - 100) / 12, 2)));
      if (east > 170 && east < 172) map.set({column, row}, DepthPixel{});
    }
  }
  return map;
}

// ledger: S1-24
TEST(FeatureCourse, AltitudeIsKeptAboveTheShallowestOfEachLeg) {
  const ArrayField map = ridge();
  FeatureCourseConfig config;
  config.rule = DepthRule::kAltitude;
  config.altitude_m = 4;
  config.unknown_depth_m = 6;
  config.max_depth_m = 24;
  const Line pipeline = {{0, 0}, {0, 200}};
  const auto course = feature_course(pipeline, config, &map);
  ASSERT_TRUE(course);
  ASSERT_EQ(course->size(), 11u);
  EXPECT_EQ(course->front().depth, 24);  // not 26: the deepest allowed
  EXPECT_NEAR((*course)[5].depth, 12 - 4, 0.05);
  EXPECT_NEAR((*course)[9].depth, 6, 1e-12);  // the unknown patch
  for (std::size_t i = 0; i + 1 < course->size(); ++i) {
    const Waypoint &a = (*course)[i], &b = (*course)[i + 1];
    EXPECT_LE(a.depth - b.depth, 0.25 * 20 + 1e-9);
    // The path that the vehicle takes: to the depth of the way-point ahead, where it can be as deep as at the last.
    const double z = std::max(a.depth, b.depth);
    const std::vector<Eigen::Vector3d> leg = {{a.north, a.east, z}, {b.north, b.east, z}};
    const auto passage = traversability(map, leg, {2, 4 - 1e-6});
    EXPECT_EQ(passage->clear + passage->unknown, passage->pixels) << i;
  }
}

// ledger: S1-24
TEST(FeatureCourse, RefusesWhatIsNoFeature) {
  EXPECT_EQ(feature_course({}, {}, nullptr).error(), CourseRefusal::kNoFeature);
  EXPECT_EQ(feature_course(Line{{1, 1}, {1, 1}}, {}, nullptr).error(), CourseRefusal::kNoFeature);
  EXPECT_EQ(feature_course(Line{{1, 1}, {NAN, 1}}, {}, nullptr).error(), CourseRefusal::kNotFinite);
}

// A REMUS-100 follows a curved pipeline of 20 segments, above it and 4 m to either side. ledger: S1-24 S1-F05
TEST(FeatureCourse, AVehicleStaysWithinTheStatedTolerance) {
  Random random(4);
  double worst = 0;
  for (int trial = 0; trial < 3; ++trial) {
    const Line pipeline = wandering(random, 20, 25, 20);
    FeatureCourseConfig config;
    config.offset_m = 4.0 * (trial - 1);
    const auto course = feature_course(pipeline, config, nullptr);
    ASSERT_TRUE(course);
    Line wanted;
    for (const Waypoint& w : *course) wanted.emplace_back(w.north, w.east);
    VehicleState start = test::at_speed(1.5, 5);
    const Vector2d first = wanted[1] - wanted[0];
    start.X_WB.translation.head<2>() = wanted[0];
    start.X_WB.rotation = Rotation::from_heading(Angle::radians(std::atan2(first.y(), first.x())));
    const auto vehicle = make_plant(test::remus(), PlantKind::kDynamic, start);
    LineOfSight guidance({}, *course);
    for (int i = 0; i < 6000 && !guidance.finished(); ++i) {
      vehicle->step(guidance.step(vehicle->state(), 0.1), {1025, {0, 0, 0}}, 0.1);
      worst = std::max(worst, distance_to(vehicle->state().X_WB.translation.head<2>(), wanted));
    }
    EXPECT_TRUE(guidance.finished());
    EXPECT_EQ(guidance.missed(), 0u);
  }
  EXPECT_LT(worst, 0.5);
}

}  // namespace
}  // namespace isobath
