// Hazards against closed forms, against a list gone through one by one, and against dense samples.
#include <gtest/gtest.h>
#include <isobath/planning/hazard_map.hpp>
#include <isobath/planning/plan_frame.hpp>
#include <tests/planning/random_hazards.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using test::plain_distance;
using test::random_hazards;
using Way = std::vector<Vector2d>;

const Polygon kSquare = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};

Hazard hazard(Polygon outline, double margin = 0) { return {std::move(outline), margin, HazardKind::kSeen, 0}; }

TEST(HazardMap, DistancesOfSquareSegmentAndPoint) {
  const HazardMap square({hazard(kSquare)});
  EXPECT_DOUBLE_EQ(square.distance({5, 1}), 3);
  EXPECT_DOUBLE_EQ(square.distance({5, 6}), 5);
  EXPECT_DOUBLE_EQ(square.distance({1, 0.5}), -0.5) << "below 0 inside, by how deep";
  EXPECT_DOUBLE_EQ(square.distance({2, 1}), 0);
  const HazardMap wider({hazard(kSquare, 1.5)});
  EXPECT_DOUBLE_EQ(wider.distance({5, 6}), 3.5);
  EXPECT_DOUBLE_EQ(wider.distance({3, 1}), -0.5);
  const HazardMap fence({hazard({{0, 0}, {10, 0}})});
  EXPECT_DOUBLE_EQ(fence.distance({4, 3}), 3);
  EXPECT_DOUBLE_EQ(fence.distance({13, 4}), 5);
  const HazardMap buoy({hazard({{1, 1}}, 0.25)});
  EXPECT_DOUBLE_EQ(buoy.distance({4, 5}), 4.75);
  const HazardMap nothing({});
  EXPECT_EQ(nothing.distance({0, 0}), INFINITY);
  EXPECT_FALSE(nothing.nearest({0, 0}));
  EXPECT_TRUE(nothing.bounds().isEmpty());
}

TEST(HazardMap, IsAsGoodAsAListOfAllHazards) {
  ISOBATH_NOT_SANITIZED();
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const int count = trial < 10 ? 1 + trial : 300;
    HazardMap map(random_hazards(random, count, 100, trial % 2 == 0 ? 3 : 30));
    const std::vector<Hazard> all(map.hazards().begin(), map.hazards().end());
    for (int i = 0; i < 100; ++i) {
      const double x = random.uniform(-150, 150);
      const double y = random.uniform(-150, 150);
      const Vector2d p(x, y);
      const double expected = plain_distance(all, p);
      ASSERT_NEAR(map.distance(p), expected, 1e-9);
      ASSERT_NEAR(plain_distance(all[map.nearest(p).value()], p), expected, 1e-9);
      std::optional<std::size_t> holding;
      for (std::size_t k = all.size(); k-- > 0;) {
        if (plain_distance(all[k], p) + all[k].margin_m <= 0) holding = k;
      }
      ASSERT_EQ(map.holding(p), holding);
    }
  }
}

TEST(HazardMap, OfTwoAsNearTheFirstIsNearest) {
  const HazardMap map({hazard({{5, 0}}), hazard({{-1, 0}}), hazard({{1, 0}}), hazard({{1, 0}})});
  EXPECT_EQ(map.nearest({0, 0}), 1u);
  EXPECT_EQ(map.nearest({0.5, 0}), 2u);
}

TEST(HazardMap, TakesOutlinesAsTheirHulls) {
  const HazardMap map({hazard({{0, 0}, {0, 2}, {1, 1}, {2, 2}, {2, 0}})});  // a notch, in the negative sense
  EXPECT_LT(map.distance({1, 1.5}), 0);
  EXPECT_GT(area(map.hazards()[0].outline), 3.99);
}

TEST(HazardMap, RefusesWhatIsNotFinite) {
  const double nan = std::nan("");
  EXPECT_THROW(HazardMap({hazard({})}), Error);
  EXPECT_THROW(HazardMap({hazard({{0, nan}})}), Error);
  EXPECT_THROW(HazardMap({hazard({{INFINITY, 0}})}), Error);
  EXPECT_THROW(HazardMap({hazard({{1e300, 0}})}), Error);
  EXPECT_THROW(HazardMap({hazard({{0, 0}}, nan)}), Error);
  EXPECT_THROW(HazardMap({hazard({{0, 0}}, INFINITY)}), Error);
}

// ledger: S6-47
TEST(HazardMap, SaysWhereALegFirstComesTooNear) {
  const HazardMap buoy({hazard({{10, 3}}, 1)});
  // A disc of 1 + 4 m round (10, 3), met by the x axis at 10 - sqrt(25 - 9).
  const auto conflict = buoy.conflict(Way{{0, 0}, {20, 0}}, 4);
  ASSERT_TRUE(conflict);
  EXPECT_EQ(conflict->leg, 0);
  EXPECT_NEAR(conflict->along_m, 6, 1e-6);
  EXPECT_NEAR(conflict->distance_m, 2, 1e-12);
  EXPECT_EQ(conflict->place, Vector2d(10, 3));
  // The second leg of two; along counts from the start of the way.
  const auto second = buoy.conflict(Way{{0, -20}, {0, 0}, {20, 0}}, 4);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->leg, 1);
  EXPECT_NEAR(second->along_m, 26, 1e-6);
  // Through a square: from its side, less the clearance.
  const HazardMap square({hazard(kSquare)});
  const auto through = square.conflict(Way{{-5, 1}, {5, 1}}, 0.5);
  ASSERT_TRUE(through);
  EXPECT_NEAR(through->along_m, 4.5, 1e-6);
  EXPECT_EQ(through->distance_m, 0);
  // From within, at once; deep inside too, where no side is near.
  const HazardMap island({hazard({{-50, -50}, {50, -50}, {50, 50}, {-50, 50}})});
  EXPECT_EQ(island.conflict(Way{{0, 0}, {1, 0}}, 0.1)->along_m, 0);
}

// The leg from the vehicle to its first way-point is a leg like others; so is standing still.
// ledger: S6-47
TEST(HazardMap, LooksAtTheLegFromTheVehicleToo) {
  const HazardMap map({hazard({{10, 0}})});
  const Vector2d vehicle(0, 0);
  EXPECT_TRUE(map.conflict(Way{vehicle, {20, 0}, {20, 20}}, 1));
  EXPECT_FALSE(map.conflict(Way{{20, 0}, {20, 20}}, 1));
  EXPECT_TRUE(map.conflict(Way{{9.5, 0}}, 1));
  EXPECT_FALSE(map.conflict(Way{{8.5, 0}}, 1));
  EXPECT_FALSE(map.conflict(Way{}, 1));
  EXPECT_TRUE(map.conflict(Way{{9.5, 0}, {9.5, 0}}, 1));
}

// ledger: S6-47
TEST(HazardMap, GrazingLegs) {
  const HazardMap square({hazard(kSquare)});
  // Along a side, at the clearance and a hair nearer.
  EXPECT_FALSE(square.conflict(Way{{-10, 5}, {10, 5}}, 3));
  EXPECT_TRUE(square.conflict(Way{{-10, 4.999999}, {10, 4.999999}}, 3));
  // Past a corner, diagonally: the leg x + y = 4 + 3 sqrt 2 keeps 3 m from (2, 2).
  const double c = 4 + 3 * std::numbers::sqrt2;
  EXPECT_FALSE(square.conflict(Way{{-10, c + 10 + 1e-9}, {c + 10 + 1e-9, -10}}, 3));
  EXPECT_TRUE(square.conflict(Way{{-10, c + 10 - 1e-6}, {c + 10 - 1e-6, -10}}, 3));
  // Without any clearance what touches is in conflict: side, corner, end.
  EXPECT_TRUE(square.conflict(Way{{-10, 2}, {10, 2}}, 0));
  EXPECT_TRUE(square.conflict(Way{{0, 4}, {4, 0}}, 0));
  EXPECT_TRUE(square.conflict(Way{{5, 1}, {2, 1}}, 0));
  EXPECT_FALSE(square.conflict(Way{{5, 1}, {2.000001, 1}}, 0));
  // Through a corner and along a diagonal.
  EXPECT_EQ(square.conflict(Way{{-1, -1}, {3, 3}}, 0)->distance_m, 0);
}

// Cells of a map as hazards: one that lies between any two samples is found.
// ledger: S6-47
TEST(HazardMap, FindsWhatSamplesMiss) {
  const HazardMap map({hazard({{500.123, 0.001}})});
  EXPECT_TRUE(map.conflict(Way{{0, 0}, {1000, 0}}, 0.002));
  EXPECT_FALSE(map.conflict(Way{{0, 0}, {1000, 0}}, 0.0005));
}

// ledger: S6-54
TEST(HazardMap, OnlyWhatIsOnTheTrackAsksForAnotherWay) {
  const Way track = {{0, 0}, {100, 0}};
  const Polygon beside = {{50, 20}, {52, 20}, {52, 22}, {50, 22}};
  const Polygon moved = {{50, -1}, {52, -1}, {52, 1}, {50, 1}};
  EXPECT_FALSE(HazardMap({hazard(beside, 1)}).conflict(track, 10));
  EXPECT_TRUE(HazardMap({hazard(moved, 1)}).conflict(track, 10));
}

TEST(HazardMap, DistancesOfLegsAreThoseOfDenseSamples) {
  ISOBATH_NOT_SANITIZED();
  Random random(5);
  constexpr double kStep = 0.002;
  for (int trial = 0; trial < 200; ++trial) {
    const HazardMap map(random_hazards(random, 6, 10, 4));
    const std::vector<Hazard> all(map.hazards().begin(), map.hazards().end());
    const double x = random.uniform(-15, 15);
    const double y = random.uniform(-15, 15);
    const double angle = random.uniform(0, 7);
    const Way leg = {{x, y}, Vector2d(x, y) + 5 * Vector2d(std::cos(angle), std::sin(angle))};
    double widest = 0;
    for (const Hazard& h : all) widest = std::max(widest, h.margin_m);
    const double sampled = test::sampled_clearance(all, leg, kStep), exact = map.leg_distance(leg[0], leg[1]);
    if (sampled > 0) {
      ASSERT_LE(exact, sampled + 1e-9);
      ASSERT_GE(exact, sampled - kStep);
    } else {
      ASSERT_GE(exact, -widest) << "through an outline it is the margin, however deep";
      ASSERT_LE(exact, kStep);
    }
  }
}

// ledger: S6-47
TEST(HazardMap, ConflictsAreThoseOfDenseSamples) {
  ISOBATH_NOT_SANITIZED();
  Random random(7);
  constexpr double kStep = 0.01;
  int found = 0, clear = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const HazardMap map(random_hazards(random, 12, 20, 4));
    const std::vector<Hazard> all(map.hazards().begin(), map.hazards().end());
    Way way;
    for (int i = 0; i < 3; ++i) {
      const double x = random.uniform(-25, 25);
      const double y = random.uniform(-25, 25);
      way.emplace_back(x, y);
    }
    const double clearance = random.uniform(0, 1.5);
    double along = 0;
    std::optional<double> first;
    for (std::size_t leg = 0; leg + 1 < way.size() && !first; ++leg) {
      const double length = (way[leg + 1] - way[leg]).norm();
      for (double s = 0; s <= length && !first; s += kStep) {
        if (plain_distance(all, way[leg] + s / length * (way[leg + 1] - way[leg])) < clearance) first = along + s;
      }
      along += length;
    }
    const auto conflict = map.conflict(way, clearance);
    if (first) {
      ASSERT_TRUE(conflict);
      ++found;
      // What samples see, the closed form saw within a step before; it may have seen a graze before that.
      ASSERT_LE(conflict->along_m, *first + 1e-6);
      if (conflict->along_m < *first - kStep) {
        ASSERT_GT(conflict->distance_m, clearance - kStep);
      }
    } else if (conflict) {
      ASSERT_GT(conflict->distance_m, clearance - kStep) << "only a graze slips between samples";
    } else {
      ++clear;
      ASSERT_GE(test::sampled_clearance(all, way, kStep), clearance);
    }
  }
  EXPECT_GT(found, 50);
  EXPECT_GT(clear, 20);
}

// ledger: S6-45
TEST(PlanFrame, TheVehicleIsTheOriginAheadIsXStarboardIsY) {
  const PlanFrame frame{{225, 375}, Angle::radians(0.7)};
  EXPECT_LT(frame.to_local({225, 375}).norm(), 1e-12);
  const Vector2d ahead(std::cos(0.7), std::sin(0.7)), starboard(-std::sin(0.7), std::cos(0.7));
  EXPECT_LT((frame.to_local(Vector2d(225, 375) + 10 * ahead) - Vector2d(10, 0)).norm(), 1e-12);
  EXPECT_LT((frame.to_local(Vector2d(225, 375) + 10 * starboard) - Vector2d(0, 10)).norm(), 1e-12);
  // As printed, turned rightly but moved by the place itself, the vehicle would be at (639, 517).
  const Vector2d printed = frame.to_local({225 + 225, 375 + 375}) + Vector2d(225, 375);
  EXPECT_LT((printed - Vector2d(639, 517)).norm(), 0.5);
}

// x is north and the bearing is a compass's: heading east, what lies east is ahead, what lies south to starboard.
// ledger: S6-45 S6-E06 S6-E07 S6-E08
TEST(PlanFrame, AxesAreNorthAndEast) {
  const PlanFrame frame{{100, 200}, Angle::degrees(90)};
  EXPECT_LT((frame.to_local({100, 207}) - Vector2d(7, 0)).norm(), 1e-12);
  EXPECT_LT((frame.to_local({93, 200}) - Vector2d(0, 7)).norm(), 1e-12);
}

// ledger: S6-46
TEST(PlanFrame, ThereAndBackAgain) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double north = random.uniform(-500, 500);
    const double east = random.uniform(-500, 500);
    const double heading = random.uniform(-4, 4);
    const PlanFrame frame{{north, east}, Angle::radians(heading)};
    const double x = random.uniform(-200, 200);
    const double y = random.uniform(-200, 200);
    ASSERT_LT((frame.to_local(frame.to_world({x, y})) - Vector2d(x, y)).norm(), 1e-12);
    const Pose X_WL{Rotation::from_heading(Angle::radians(heading)), {north, east, 5}};
    ASSERT_LT((PlanFrame::of(X_WL).to_world({x, y}) - (X_WL * Eigen::Vector3d(x, y, 0)).head<2>()).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace isobath
