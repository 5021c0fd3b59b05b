// A closer look: from where an obstacle is looked at, and when not.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/mission/agents/closer_look.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

constexpr double kKeep = 3.5, kLead = 6;  // m

RememberedObstacle box(double north, double east, double half_north, double half_east, int number,
                       double margin = 0.2) {
  RememberedObstacle o;
  o.id = static_cast<std::uint32_t>(100 * number) + static_cast<std::uint32_t>(std::abs(10 * east));
  o.number = number;
  o.margin_m = margin;
  o.outline_W = {{north - half_north, east - half_east},
                 {north + half_north, east - half_east},
                 {north + half_north, east + half_east},
                 {north - half_north, east + half_east}};
  return o;
}

// ledger: S4-53
TEST(CloserLook, StandsWithinRangeOnTheSideOfTheVehicle) {
  const std::vector<RememberedObstacle> wreck{box(50, 0, 3, 8, 1)};
  for (const Vector2d& vehicle : {Vector2d(0, 0), Vector2d(90, 10), Vector2d(50, -60)}) {
    const auto pose = viewing_pose(wreck, 0, 8, kKeep, kLead, vehicle);
    ASSERT_TRUE(pose);
    EXPECT_LE(distance_from(wreck[0].outline_W, pose->place), 8);
    EXPECT_GE(distance_from(wreck[0].outline_W, pose->place), kKeep + 0.2);
    EXPECT_NEAR(distance_from(wreck[0].outline_W, pose->seen), 0, 1e-9);
    EXPECT_LT((pose->place - vehicle).norm(), (Vector2d(50, 0) - vehicle).norm());
    ASSERT_TRUE(pose->from);
    const Vector2d leg = pose->place - *pose->from, sight = pose->seen - pose->place;
    EXPECT_GT(leg.dot(sight) / leg.norm() / sight.norm(), 0.99) << "the vehicle comes with its bow to it";
  }
}

// A post before the near side hides it: the pose stands where it does not, all round being tried. ledger: S4-53
TEST(CloserLook, HasAFreeLineOfSightAndKeepsClearOfAll) {
  const Vector2d vehicle(0, 0);
  std::vector<RememberedObstacle> known{box(50, 0, 1, 1, 1)};
  const auto before = viewing_pose(known, 0, 12, kKeep, kLead, vehicle);
  ASSERT_TRUE(before);
  ASSERT_NEAR(before->place.y(), 0, 0.5);
  known.push_back(box(44.5, 0, 0.4, 0.4, 2));
  const auto pose = viewing_pose(known, 0, 12, kKeep, kLead, vehicle);
  ASSERT_TRUE(pose);
  EXPECT_LE(pose->range_m(), 12);
  for (double share = 0; share <= 1; share += 0.01) {
    EXPECT_GT(distance_from(known[1].outline_W, pose->place + share * (pose->seen - pose->place)), 0);
  }
  for (const RememberedObstacle& o : known) EXPECT_GE(distance_from(o.outline_W, pose->place), kKeep + o.margin_m);
  // All round: a ring of posts leaves no pose.
  for (int i = 0; i < 24; ++i) {
    const double a = 2 * M_PI * i / 24;
    known.push_back(box(50 + 9 * std::cos(a), 9 * std::sin(a), 0.8, 0.8, 3 + i));
  }
  EXPECT_FALSE(viewing_pose(known, 0, 12, kKeep, kLead, vehicle));
}

// ledger: S4-53
TEST(CloserLook, PiecesOfOneObstacleAreLookedAtAsOne) {
  const std::vector<RememberedObstacle> wall{box(50, -4, 1, 4, 1), box(50, 4, 1, 4, 1)};
  const auto pose = viewing_pose(wall, 0, 6, kKeep, kLead, {0, 4});
  ASSERT_TRUE(pose);
  for (const RememberedObstacle& piece : wall) EXPECT_GE(distance_from(piece.outline_W, pose->place), kKeep + 0.2);
  EXPECT_LE(pose->range_m(), 6);
}

class Driver : public testing::Test {
 protected:
  std::vector<Message> tell(const Message& message) {
    Outbox out;
    driver.on_message(message, Time{}, out);
    return std::move(out.said());
  }
  void hear(std::vector<RememberedObstacle> obstacles) {
    ObstacleScan scan;
    auto known = std::make_shared<KnownObstacles>();
    known->obstacles = std::move(obstacles);
    scan.known = known;
    (void)tell(scan);
  }
  std::vector<Message> call(const std::string& task) {
    TaskCall c;
    c.id = 1;
    c.task = task;
    c.at.north_east = {40, 0};
    c.at.depth_m = 4;
    return tell(c);
  }
  std::string refusal(const std::string& task) {
    const auto said = call(task);
    const auto* decision = said.size() == 1 ? std::get_if<Decision>(&said[0]) : nullptr;
    return decision ? decision->reason : "";
  }
  CloserLookDriver driver{{}, kKeep, 2};
};

// ledger: S4-53 S6-41
TEST_F(Driver, OfACloserLookSaysWhyItDoesNotLook) {
  EXPECT_TRUE(call("survey").empty()) << "not its task";
  EXPECT_THAT(refusal("look"), HasSubstr("no obstacle is known within 30 m of the point"));
  hear({box(90, 0, 1, 1, 1)});
  EXPECT_THAT(refusal("look"), HasSubstr("no obstacle is known within 30 m of the point"));
  EXPECT_THAT(refusal("look within_m=60 range_m=3"), HasSubstr("3.5 m and more, which the route keeps from obstacles"));
  EXPECT_THAT(refusal("look far=1"), HasSubstr("far: unknown number"));
  hear({box(50, 0, 1, 1, 1, 30)});
  EXPECT_THAT(refusal("look"), HasSubstr("no place within 8 m of the obstacle is free"));
}

// Also where the obstacle has gone by the time of the award: the driver does what it bid. ledger: S4-53 S6-41
TEST_F(Driver, OfACloserLookLeadsToTheNearestObstacle) {
  hear({box(70, 0, 1, 1, 1), box(52, 6, 1, 1, 2)});
  ASSERT_TRUE(std::holds_alternative<TaskBid>(call("look range_m=6").at(0)));
  hear({});
  const auto said = tell(TaskAward{1, "closer look"});
  ASSERT_EQ(said.size(), 2u);
  EXPECT_THAT(std::get<Decision>(said[0]).reason, HasSubstr("obstacle 2 is"));
  const auto& plan = std::get<TaskPlan>(said[1]);
  EXPECT_EQ(plan.drop_distance_m, kKeep) << "a point so near to an obstacle is meant";
  const Waypoint& last = plan.waypoints.back();
  EXPECT_LE(distance_from(box(52, 6, 1, 1, 2).outline_W, {last.north, last.east}) + last.radius_m, 6);
  EXPECT_EQ(last.depth, 4);
}

}  // namespace
}  // namespace isobath
