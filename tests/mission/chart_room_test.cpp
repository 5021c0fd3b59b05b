// Chart room: what the chart knows to be too shallow is in the way, as few outlines, and nothing else is.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/mission/agents/chart_room.hpp>
#include <isobath/mission/agents/shoal_outlines.hpp>
#include <tests/planning/array_field.hpp>
#include <tests/planning/measured_water.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::ArrayField;

const PixelGrid kGrid{{50, -50}, 1};  // north 50 .. -50, east -50 .. 50
constexpr PixelWindow kWindow{0, 0, 100, 100};

std::shared_ptr<ArrayField> deep_water() { return std::make_shared<ArrayField>(kGrid, kWindow, 20); }

bool covered(const std::vector<Polygon>& outlines, const Vector2d& p) {
  return std::any_of(outlines.begin(), outlines.end(), [&](const Polygon& o) { return encloses(o, p); });
}

/// Discs of shallow water, some cut off by the edge.
std::shared_ptr<ArrayField> random_shoals(Random& random) {
  auto field = deep_water();
  const auto discs = 1 + random.index(8);
  for (std::uint64_t i = 0; i < discs; ++i) {
    const double row = random.uniform(0, 100), column = random.uniform(0, 100), radius = random.uniform(0.5, 20);
    for (int r = 0; r < 100; ++r) {
      for (int c = 0; c < 100; ++c) {
        if (std::hypot(r - row, c - column) < radius) field->set({c, r}, 2.0);
      }
    }
  }
  return field;
}

// Against every pixel, one by one.
TEST(ShoalOutlines, HoldEveryBlockedPixelAndReachLittleFurther) {
  Random random(5);
  for (int round = 0; round < 30; ++round) {
    const auto field = random_shoals(random);
    const double overreach = round % 3;
    const std::vector<Polygon> outlines = shoal_outlines(*field, kWindow, {5, false, overreach, 100000}).charted;
    for (const Polygon& o : outlines) {
      EXPECT_TRUE(is_convex(o));
      EXPECT_GT(area(o), 0);
    }
    for (int row = 0; row < 100; ++row) {
      for (int column = 0; column < 100; ++column) {
        const Pixel p{column, row};
        const Vector2d centre = kGrid.centre(p);
        if (field->at(p).depth_m() < 5) {
          for (const Vector2d& corner : {Vector2d(-0.5, -0.5), Vector2d(-0.5, 0.5), Vector2d(0.5, 0.5)}) {
            ASSERT_TRUE(covered(outlines, centre + 0.999 * corner)) << round;
          }
        } else if (covered(outlines, centre)) {
          bool near = false;
          const int reach = static_cast<int>(overreach) + 1;
          for (int c = std::max(0, column - reach); c <= std::min(99, column + reach); ++c) {
            near = near || field->at({c, row}).depth_m() < 5;
          }
          ASSERT_TRUE(near && overreach > 0) << round << ": " << centre.transpose();
        }
      }
    }
  }
}

TEST(ShoalOutlines, AreFewWhereTheShoreIsStraight) {
  const auto field = deep_water();
  for (int r = 0; r < 100; ++r) {
    for (int c = 0; c < std::min(100, 20 + r / 2); ++c) field->set({c, r}, 1.0);  // a slanting shore
  }
  EXPECT_LE(shoal_outlines(*field, kWindow, {5, false, 1, 1000}).charted.size(), 4u);
  const auto square = deep_water();
  for (int r = 10; r < 40; ++r) {
    for (int c = 10; c < 60; ++c) square->set({c, r}, 1.0);
  }
  const auto outlines = shoal_outlines(*square, kWindow, {5, false, 0, 1000}).charted;
  ASSERT_EQ(outlines.size(), 1u);
  EXPECT_DOUBLE_EQ(area(outlines[0]), 30 * 50);
}

TEST(ShoalOutlines, StayFewHoweverRaggedTheBottomIs) {
  Random random(6);
  const auto field = deep_water();
  for (int r = 0; r < 100; ++r) {
    for (int c = 0; c < 100; ++c) {
      if (random.index(4) == 0) field->set({c, r}, 1.0);
    }
  }
  EXPECT_GT(shoal_outlines(*field, kWindow, {5, false, 0, 100000}).charted.size(), 1000u);
  const auto outlines = shoal_outlines(*field, kWindow, {5, false, 0, 100}).charted;
  EXPECT_LE(outlines.size(), 100u);
  for (int r = 0; r < 100; ++r) {
    for (int c = 0; c < 100; ++c) {
      if (field->at({c, r}).depth_m() >= 5) continue;
      ASSERT_TRUE(covered(outlines, kGrid.centre({c, r})));
    }
  }
}

struct Rig {
  ChartRoom room;
  Time now{};
  explicit Rig(const ChartRoomConfig& config = {}, const WorldSnapshot& chart = {}) : room(config) { tell(chart); }

  std::vector<Message> tell(const Message& message) {
    Outbox out;
    room.on_message(message, now, out);
    return std::move(out.said());
  }
  std::vector<Message> at(double north, double east, double depth) {
    Navigation fix;
    fix.X_WB.translation = {north, east, depth};
    return tell(fix);
  }
};

const std::vector<Hazard>& hazards(const std::vector<Message>& said) {
  static const std::vector<Hazard> kNone;
  return said.size() == 1 && std::holds_alternative<ChartedHazards>(said[0])
             ? *std::get<ChartedHazards>(said[0]).hazards
             : kNone;
}

/// A shoal of 4 m at north 20 .. 30, east 0 .. 10.
std::shared_ptr<ArrayField> one_shoal() {
  auto field = deep_water();
  for (int r = 20; r < 30; ++r) {
    for (int c = 50; c < 60; ++c) field->set({c, r}, 4.0);
  }
  return field;
}

TEST(ChartRoom, SaysWhatIsShallowerThanTheVehicleAndItsClearance) {
  Rig rig({}, {one_shoal(), nullptr});
  EXPECT_TRUE(hazards(rig.at(0, 0, 2.9)).empty()) << "3.9 m are wanted, 4 m are there";
  const auto said = rig.at(0, 0, 3.5);
  ASSERT_EQ(hazards(said).size(), 1u);
  const Hazard& h = hazards(said)[0];
  EXPECT_EQ(h.kind, HazardKind::kCharted);
  EXPECT_TRUE(encloses(h.outline, {25, 5}));
  EXPECT_DOUBLE_EQ(area(h.outline), 100);
}

TEST(ChartRoom, SpeaksAgainOnlyWhenPlaceDepthOrChartChange) {
  const auto field = one_shoal();
  Rig rig({.reach_m = 40, .recheck_share = 0.25, .depth_step_m = 0.5}, {field, nullptr});
  EXPECT_EQ(rig.at(0, 0, 5).size(), 1u);
  EXPECT_EQ(rig.at(9, 0, 5).size(), 0u);
  EXPECT_EQ(rig.at(9, 0, 5.4).size(), 0u);
  EXPECT_EQ(rig.at(10, 0, 5).size(), 1u);
  EXPECT_EQ(rig.at(10, 0, 4.5).size(), 1u);
  EXPECT_EQ(rig.tell(WorldSnapshot{field, nullptr}).size(), 0u) << "the same version";
  const auto changed = one_shoal();
  changed->set({0, 0}, 30.0);
  const auto said = rig.tell(WorldSnapshot{changed, nullptr});
  EXPECT_EQ(hazards(said).size(), 1u);
  EXPECT_EQ(rig.tell(WorldSnapshot{}).size(), 1u) << "no chart any more: nothing is in the way";
  Navigation nowhere;
  nowhere.X_WB.translation.setConstant(std::nan(""));
  EXPECT_EQ(rig.tell(nowhere).size(), 0u);
  EXPECT_TRUE(Rig().at(0, 0, 5).empty()) << "without a chart there is nothing to say";
}

TEST(ChartRoom, UnknownWaterIsFreeUnlessItIsAskedFor) {
  const auto field = deep_water();
  for (int r = 20; r < 30; ++r) {
    for (int c = 50; c < 60; ++c) field->set({c, r}, DepthPixel{});
  }
  EXPECT_TRUE(hazards(Rig({.reach_m = 40}, {field, nullptr}).at(0, 0, 5)).empty());
  EXPECT_EQ(hazards(Rig({.reach_m = 40, .unknown_blocks = true}, {field, nullptr}).at(0, 0, 5)).size(), 1u);
}

// ledger: S1-03
TEST(ChartRoom, WhatASonarHasMeasuredIsAHazardOfItsOwnKind) {
  const auto field = one_shoal();
  const DepthPixel sensed{DepthPixel::word_of_depth(3), DepthPixel::word_of_state(9, kSensed | kSeenByObstacle, 0)};
  for (int r = 60; r < 65; ++r) field->set({30, r}, sensed);
  const auto said = Rig({}, {field, nullptr}).at(0, 0, 5);
  ASSERT_EQ(hazards(said).size(), 2u);
  EXPECT_EQ(hazards(said)[0].kind, HazardKind::kCharted);
  EXPECT_EQ(hazards(said)[1].kind, HazardKind::kMapped);
  EXPECT_TRUE(encloses(hazards(said)[1].outline, kGrid.centre({30, 62})));
  EXPECT_DOUBLE_EQ(area(hazards(said)[1].outline), 5);
}

// ledger: S1-41 S1-62
TEST(ChartRoom, WaterThatIsClearDownToTheVehicleIsUnknownBelowAndNoObstacle) {
  const auto field = deep_water();
  const auto word = DepthPixel::word_of_depth(5.2);
  for (int r = 20; r < 30; ++r) field->set({30, r}, {word, DepthPixel::word_of_state(9, kSensed, 0)});
  EXPECT_TRUE(hazards(Rig({}, {field, nullptr}).at(0, 0, 5)).empty());
  field->set({30, 25}, {word, DepthPixel::word_of_state(9, kSensed | kSeenByObstacle, 0)});
  const auto said = Rig({}, {field, nullptr}).at(0, 0, 5);
  ASSERT_EQ(hazards(said).size(), 1u);
  EXPECT_DOUBLE_EQ(area(hazards(said)[0].outline), 1);
}

TEST(ChartRoom, AMapThatGrowsElsewhereLeavesTheHazardsAsTheyAre) {
  const auto field = one_shoal(), grown = one_shoal();
  grown->set({5, 5}, 18.0);
  Rig rig({}, {field, nullptr});
  const auto first = rig.at(0, 0, 5);
  const auto second = rig.tell(WorldSnapshot{grown, nullptr, Time(std::chrono::seconds(7))});
  ASSERT_EQ(hazards(second).size(), 1u);
  EXPECT_EQ(&hazards(first), &hazards(second)) << "the same hazards, not equal ones: nobody plans again";
  EXPECT_EQ(std::get<ChartedHazards>(second[0]).looked_ahead, Time(std::chrono::seconds(7)));
  const auto third = rig.tell(WorldSnapshot{grown, nullptr, Time(std::chrono::seconds(8))});
  ASSERT_EQ(third.size(), 1u) << "that it has looked again is news";
  EXPECT_EQ(std::get<ChartedHazards>(third[0]).looked_ahead, Time(std::chrono::seconds(8)));
}

TEST(ChartRoom, RocksAndLinesOfTheChartCountByTheirTops) {
  const auto objects = std::make_shared<const std::vector<ChartObstacle>>(
      std::vector<ChartObstacle>{{{10, 0}, {10, 0}, 2, 3},      // a rock up to 3 m of depth
                                 {{10, 0}, {10, 0}, 2, 15},     // a deep one
                                 {{-5, -5}, {-5, 20}, 1, 2},    // a pipeline
                                 {{900, 0}, {900, 0}, 2, 0}});  // far away
  const auto said = Rig({.margin_m = 0.5}, {nullptr, objects}).at(0, 0, 5);
  ASSERT_EQ(hazards(said).size(), 2u);
  EXPECT_EQ(hazards(said)[0].outline.size(), 1u);
  EXPECT_EQ(hazards(said)[0].margin_m, 2.5);
  EXPECT_EQ(hazards(said)[1].outline.size(), 2u);
  EXPECT_EQ(hazards(said)[1].margin_m, 1.5);
}

std::shared_ptr<const MissionPlan> plan_over(std::vector<Vector3d> points) {
  MissionPlan plan;
  for (const Vector3d& p : points) {
    MissionPoint point;
    point.name = "point " + std::to_string(plan.points.size() + 1);
    point.north_east = p.head<2>();
    point.depth_m = p.z();
    plan.points.push_back(point);
  }
  return std::make_shared<const MissionPlan>(std::move(plan));
}

// ledger: S6-43
TEST(ChartRoom, HoldsTheLegsOfAMissionAgainstTheChart) {
  Rig rig({}, {one_shoal(), nullptr});
  (void)rig.at(0, 0, 0.5);
  MissionOrder start;
  start.plan = plan_over({{40, -20, 2}, {40, 5, 3.5}, {0, 5, 3.5}, {0, -20, 3.5}});
  auto said = rig.tell(start);
  ASSERT_EQ(said.size(), 1u) << "the leg from (40, 5) to (0, 5) only: the others are clear or at 2 m";
  const Decision d = std::get<Decision>(said[0]);
  EXPECT_EQ(d.what, "leg too shallow");
  EXPECT_EQ(d.leg, 3);
  EXPECT_NEAR(d.margin_m.value(), 4 - 3.5 - 1, 1e-9);
  EXPECT_NEAR(d.obstacle.value().x(), 29.5, 1e-9) << "the first place on the way";
  EXPECT_NE(d.reason.find("leg 3 to point 3: 4.00 m of water"), std::string::npos) << d.reason;

  start.plan = plan_over({{40, -20, 2}, {40, 5, 2.5}, {0, 5, 2.5}});
  said = rig.tell(start);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(std::get<Decision>(said[0]).what, "legs deep enough");
  start.kind = MissionOrder::Kind::kHold;
  EXPECT_TRUE(rig.tell(start).empty());
}

TEST(ChartRoom, LegsOverUnknownWaterAndRocks) {
  MissionOrder start;
  start.plan = plan_over({{0, 40, 3}, {0, 200, 3}});  // leaves the chart at 50
  Rig rig({}, {deep_water(), nullptr});
  EXPECT_EQ(std::get<Decision>(rig.tell(start).at(0)).what, "legs deep enough");
  Rig strict({.unknown_blocks = true}, {deep_water(), nullptr});
  EXPECT_EQ(std::get<Decision>(strict.tell(start).at(0)).leg, 2);
  const auto rock =
      std::make_shared<const std::vector<ChartObstacle>>(std::vector<ChartObstacle>{{{1, 100}, {1, 100}, 1, 1}});
  Rig rocky({}, {nullptr, rock});
  const Decision d = std::get<Decision>(rocky.tell(start).at(0));
  EXPECT_EQ(d.leg, 2);
  EXPECT_NE(d.reason.find("obstacle 0 of the chart"), std::string::npos) << d.reason;
  EXPECT_TRUE(Rig().tell(start).empty());
}

/// An echo 10 m away in this direction of the grid's axes, at the level of the vehicle.
std::shared_ptr<const GridSnapshot> one_echo(Angle course, const Vector3d& at_G, const Vector3d& vehicle) {
  auto snapshot = std::make_shared<GridSnapshot>(SphericalGridConfig{});
  snapshot->version = 1;
  snapshot->X_WB.translation = vehicle;
  snapshot->grid.turn(course);
  const auto place = snapshot->grid.place_at(snapshot->grid.to_table(at_G));
  snapshot->grid.set_log_odds(*place, 5);
  snapshot->grid.add_echo(at_G, 0.1, Time{});
  return snapshot;
}

// ledger: S4-51
TEST(ChartRoom, SendsTheCellsOfTheSphericalGridWhereAskedTo) {
  ChartRoomConfig config;
  config.sphere = true;
  const Vector3d vehicle(100, 200, 5);
  WorldSnapshot chart;
  chart.sphere = one_echo({}, {0, 10, 0}, vehicle);  // y' points north
  Rig rig(config, chart);
  const auto north_up = rig.at(100, 200, 5);
  ASSERT_EQ(hazards(north_up).size(), 1u);
  EXPECT_EQ(hazards(north_up)[0].kind, HazardKind::kMapped);
  EXPECT_LT((nearest_point(hazards(north_up)[0].outline, {110, 200}) - Vector2d(110, 200)).norm(), 0.5);

  chart.sphere = one_echo(Angle::degrees(90), {0, 10, 0}, vehicle);  // y' points east
  const auto course_up = Rig(config, chart).at(100, 200, 5);
  ASSERT_EQ(hazards(course_up).size(), 1u);
  EXPECT_LT((nearest_point(hazards(course_up)[0].outline, {100, 210}) - Vector2d(100, 210)).norm(), 0.5);

  chart.sphere = one_echo({}, {0, 10, 4}, vehicle);
  EXPECT_TRUE(hazards(Rig(config, chart).at(100, 200, 5)).empty()) << "4 m above the vehicle";
  chart.sphere = one_echo({}, {0, 10, 0}, vehicle);
  EXPECT_TRUE(hazards(Rig({}, chart).at(100, 200, 5)).empty()) << "not asked for";
}

// ledger: S1-41, S5-32
TEST(ChartRoom, HoldsTheLegsOfAMissionAgainstTheVoxelsToo) {
  test::MeasuredWater water;
  water.occupy({10, -2, 2}, {11, 3, 8});
  Rig rig({}, {.depths = deep_water(), .voxels = std::make_shared<const OccupancySnapshot>(water.grid())});
  (void)rig.at(0, 0, 4);
  MissionOrder start;
  start.plan = plan_over({{0, 1, 4}, {20, 1, 4}});
  const auto said = rig.tell(start);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(std::get<Decision>(said[0]).what, "leg too shallow");
  EXPECT_NE(std::get<Decision>(said[0]).reason.find("3.00 m of water"), std::string::npos)
      << "the top of the wall within a metre of the vehicle's depth: " << std::get<Decision>(said[0]).reason;
  start.plan = plan_over({{0, 20, 4}, {20, 20, 4}});
  EXPECT_EQ(std::get<Decision>(rig.tell(start).at(0)).what, "legs deep enough") << "beside the wall";
}

// ledger: S5-32
TEST(ChartRoom, SendsWhatTheVoxelsHoldNearTheVehiclesDepthThoughTheChartSaysDeepWater) {
  test::MeasuredWater water;
  water.occupy({10, -2, 2}, {11, 3, 8});  // a wall
  water.occupy({10, 8, 7}, {12, 10, 8});  // a rock below
  const auto voxels = std::make_shared<const OccupancySnapshot>(water.grid());
  const WorldSnapshot world{.depths = deep_water(), .voxels = voxels};
  const auto said = Rig({.voxels = true}, world).at(0, 0, 4);
  ASSERT_EQ(hazards(said).size(), 1u);
  EXPECT_EQ(hazards(said)[0].kind, HazardKind::kVoxels);
  EXPECT_DOUBLE_EQ(area(hazards(said)[0].outline), 5);
  EXPECT_TRUE(encloses(hazards(said)[0].outline, {10.5, 1}));
  EXPECT_EQ(hazards(Rig({.voxels = true}, world).at(0, 0, 6.5)).size(), 2u) << "the rock is 0.5 m below";
  EXPECT_TRUE(hazards(Rig({}, world).at(0, 0, 4)).empty());
  EXPECT_EQ(hazards(Rig({.voxels = true}, {.voxels = voxels}).at(0, 0, 4)).size(), 1u) << "without a depth map";
}

TEST(ChartRoom, LooksAtNewVoxelsAsOftenAsAtANewDepthMap) {
  test::MeasuredWater water;
  water.occupy({10, -2, 2}, {11, 3, 8});
  const auto snapshot = [&] {
    return WorldSnapshot{.voxels = std::make_shared<const OccupancySnapshot>(water.grid())};
  };
  Rig rig({.live_s = 1, .voxels = true}, snapshot());
  EXPECT_EQ(hazards(rig.at(0, 0, 4)).size(), 1u);
  water.occupy({20, -2, 2}, {21, 3, 8});
  EXPECT_TRUE(rig.tell(snapshot()).empty()) << "at the same time";
  rig.now += std::chrono::seconds(1);
  EXPECT_EQ(hazards(rig.tell(snapshot())).size(), 2u);
}

}  // namespace
}  // namespace isobath
