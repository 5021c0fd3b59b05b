// Numbers of obstacles over several scans: what stays the same thing keeps its number.
#include <gtest/gtest.h>
#include <isobath/map/occupancy/obstacle_numbers.hpp>
#include <isobath/map/occupancy/obstacle_outline.hpp>
#include <set>

namespace isobath {
namespace {

using Eigen::Vector2d;

Polygon box_at(const Vector2d& middle, double half_x, double half_y) {
  return {middle + Vector2d(-half_x, -half_y), middle + Vector2d(half_x, -half_y), middle + Vector2d(half_x, half_y),
          middle + Vector2d(-half_x, half_y)};
}

/// Obstacles of the world as a vehicle sees them, each with all its pieces, numbered as a detector does.
struct Sea {
  std::vector<std::vector<Polygon>> obstacles_W;

  /// The numbers after a scan, in the order of `obstacles_W`.
  std::vector<int> seen_by(ObstacleNumbers& numbers, const Pose& X_WL) const {
    std::vector<Obstacle> pieces;
    std::vector<std::size_t> of;
    for (std::size_t i = 0; i < obstacles_W.size(); ++i) {
      for (const Polygon& outline : obstacles_W[i]) {
        Obstacle& o = pieces.emplace_back();
        o.number = static_cast<int>(obstacles_W.size() - i);  // in another order
        for (const Vector2d& p : outline) {
          o.outline.emplace_back((X_WL.inverse() * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>());
        }
        of.push_back(i);
      }
    }
    numbers.keep(pieces, X_WL);
    std::vector<int> result(obstacles_W.size(), 0);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      EXPECT_TRUE(result[of[i]] == 0 || result[of[i]] == pieces[i].number) << "pieces of one obstacle share its number";
      result[of[i]] = pieces[i].number;
    }
    return result;
  }
};

Pose at(double north, double east, double heading_deg = 0) {
  return {Rotation::from_heading(Angle::degrees(heading_deg)), {north, east, 0}};
}

using Numbers = std::vector<int>;

TEST(ObstacleNumbers, CountFromOneAndStayWhileTheVehicleMovesAndTurns) {
  ObstacleNumbers numbers;
  Sea sea{{{box_at({20, 0}, 1, 1)}, {box_at({30, 10}, 1, 4), box_at({30, 18}, 1, 4)}, {box_at({5, -30}, 0.5, 0.5)}}};
  EXPECT_EQ(sea.seen_by(numbers, at(0, 0)), (Numbers{1, 2, 3}));
  for (int i = 1; i < 30; ++i) EXPECT_EQ(sea.seen_by(numbers, at(2 * i, i, 25 * i)), (Numbers{1, 2, 3})) << i;
  sea.obstacles_W.insert(sea.obstacles_W.begin(), {box_at({50, 50}, 1, 1)});
  EXPECT_EQ(sea.seen_by(numbers, at(60, 30)), (Numbers{4, 1, 2, 3})) << "what is new gets the next number";
}

TEST(ObstacleNumbers, ComeBackWithTheObstacle) {
  ObstacleNumbers numbers;
  const Sea sea{{{box_at({20, 0}, 1, 1)}, {box_at({40, 0}, 1, 1)}}};
  ASSERT_EQ(sea.seen_by(numbers, at(0, 0)), (Numbers{1, 2}));
  for (int i = 0; i < 20; ++i) Sea{{sea.obstacles_W[1]}}.seen_by(numbers, at(0, 0));
  EXPECT_EQ(sea.seen_by(numbers, at(0, 0)), (Numbers{1, 2}));
}

TEST(ObstacleNumbers, StayWithTheNearestWhereAnOutlineHasJumpedAside) {
  ObstacleNumbers numbers;
  ASSERT_EQ((Sea{{{box_at({20, 0}, 0.5, 0.5)}}}).seen_by(numbers, at(0, 0)), Numbers{1});
  EXPECT_EQ((Sea{{{box_at({20, 2.5}, 0.5, 0.5)}}}).seen_by(numbers, at(0, 0)), Numbers{1}) << "1.5 m apart";
  EXPECT_EQ((Sea{{{box_at({20, 6}, 0.5, 0.5)}}}).seen_by(numbers, at(0, 0)), Numbers{2}) << "2.5 m apart: another one";
}

// A wall that the sonar sees whole in every other scan.
TEST(ObstacleNumbers, OfAWallThatFallsApartAndJoinsAgainAreTheSameEachTime) {
  ObstacleNumbers numbers;
  const std::vector<Polygon> wall = {box_at({30, 0}, 1, 6), box_at({30, 12}, 1, 6), box_at({30, 22}, 1, 4)};
  const Sea whole{{wall}}, broken{{{wall[0], wall[1]}, {wall[2]}}};
  ASSERT_EQ(whole.seen_by(numbers, at(0, 0)), Numbers{1});
  EXPECT_EQ(broken.seen_by(numbers, at(0, 0)), (Numbers{1, 2})) << "the larger part keeps the number";
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(whole.seen_by(numbers, at(0, 0)), Numbers{1});
    EXPECT_EQ(broken.seen_by(numbers, at(0, 0)), (Numbers{1, 2}));
  }
}

TEST(ObstacleNumbers, MoveWithAJumpOfThePosition) {
  ObstacleNumbers numbers;
  const Vector2d jump(30, -20);
  const Sea before{{{box_at({20, 0}, 1, 1)}, {box_at({20, 20}, 1, 1)}}};
  ASSERT_EQ(before.seen_by(numbers, at(0, 0)), (Numbers{1, 2}));
  numbers.move(jump);
  Sea after = before;
  for (auto& obstacle : after.obstacles_W) obstacle[0] = moved_by(obstacle[0], jump);
  EXPECT_EQ(after.seen_by(numbers, at(jump.x(), jump.y())), (Numbers{1, 2}));
}

// A head that takes 8 s for a turn sees a body that moves 12 m farther each time.
TEST(ObstacleNumbers, GoWithABodyWhoseVelocityIsKnown) {
  ObstacleNumbers numbers;
  for (int i = 0; i < 5; ++i) {
    std::vector<Obstacle> pieces(2);
    pieces[0].outline = box_at({20, -20 + 12.0 * i}, 1, 1);
    pieces[0].motion = {.velocity_W = {0, 1.5}, .track = 7};
    pieces[0].number = 1;
    pieces[1].outline = box_at({30, 0}, 1, 1);
    pieces[1].number = 2;
    numbers.keep(pieces, Pose{}, Time(seconds(8 * i)));
    EXPECT_EQ(pieces[0].number, 1) << i;
    EXPECT_EQ(pieces[1].number, 2) << i;
  }
}

TEST(ObstacleNumbers, AreNeverGivenTwice) {
  ObstacleNumbers numbers;
  std::set<int> given;
  for (int i = 0; i < 700; ++i) {  // more than are known at a time
    const Numbers one = Sea{{{box_at({10.0 * i, 0}, 1, 1)}}}.seen_by(numbers, at(10.0 * i, 0));
    EXPECT_TRUE(given.insert(one[0]).second) << i;
  }
  EXPECT_EQ(*given.rbegin(), 700);
  numbers.forget();
  EXPECT_EQ((Sea{{{box_at({10, 0}, 1, 1)}}}).seen_by(numbers, at(0, 0)), Numbers{701});
}

TEST(ObstacleNumbers, OfNoObstaclesAreNone) {
  ObstacleNumbers numbers;
  numbers.keep({}, Pose{});
  EXPECT_EQ((Sea{{{box_at({10, 0}, 1, 1)}}}).seen_by(numbers, at(0, 0)), Numbers{1});
}

}  // namespace
}  // namespace isobath
