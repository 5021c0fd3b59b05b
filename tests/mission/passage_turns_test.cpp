// When a vehicle asks for a passage, waits before it, goes through and gives it back.
#include <gtest/gtest.h>
#include <isobath/mission/agents/passage_turns.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using Eigen::Vector2d;

/// One passage from 100 to 120 m north.
class PassageTurnsTest : public testing::Test {
 protected:
  void go(double north, double s) { turns.move({north, 0}, 60, at(s)); }
  const std::vector<GroupPassage> passages{{{}, "gap", {{100, -10}, {120, -10}, {120, 10}, {100, 10}}}};
  PassageTurns turns{passages, 300};
};

// ledger: S2-17
TEST_F(PassageTurnsTest, AsksAheadIsHeldNearAndGivesBackWhatItHasPassed) {
  turns.set_way({{200, 0}}, at(0));
  go(30, 1);
  EXPECT_FALSE(turns.ask()) << "70 m before it";
  go(45, 10);
  ASSERT_TRUE(turns.ask());
  EXPECT_EQ(*turns.ask(), (PassageAsk{0, 1, false}));
  EXPECT_FALSE(turns.waits()) << "the answer may come before it is near";
  go(71, 30);
  EXPECT_TRUE(turns.waits());
  turns.set_way({}, at(30));
  go(65, 40);
  EXPECT_TRUE(turns.waits()) << "also while it circles a little farther away";
  turns.take_turn(at(50));
  EXPECT_FALSE(turns.waits());
  go(65, 51);
  EXPECT_TRUE(turns.ask()) << "it has no way yet";
  turns.set_way({{200, 0}}, at(52));
  for (double north = 66; north < 123; ++north) {
    go(north, north);
    ASSERT_TRUE(turns.ask() && turns.ask()->passing) << north;
  }
  go(124, 124);
  EXPECT_FALSE(turns.ask()) << "3 m behind it";
}

// ledger: S2-17
TEST_F(PassageTurnsTest, AsksForNothingWhereItsWayLeadsElsewhere) {
  turns.set_way({{90, 0}, {90, 100}}, at(0));
  go(80, 1);
  EXPECT_FALSE(turns.ask());
  turns.set_way({{90, 0}, {200, 0}}, at(2));
  turns.pass(1);
  go(90, 3);
  ASSERT_TRUE(turns.ask());
  turns.take_turn(at(4));
  turns.set_way({{0, 0}}, at(5));
  go(90, 6);
  EXPECT_FALSE(turns.ask()) << "another order: the turn is for somebody else";
  turns.set_way({{200, 0}}, at(7));
  go(90, 8);
  EXPECT_EQ(turns.ask()->number, 2) << "a turn for the ask before is not one for this";
}

// A vehicle that waits may get another order, such as to go home. ledger: S2-17 S2-32
TEST_F(PassageTurnsTest, WaitsNoLongerWhereItsWayWouldLeadElsewhere) {
  turns.set_way({{200, 0}}, at(0));
  go(80, 1);
  go(80, 2);
  ASSERT_TRUE(turns.waits());
  turns.set_way({}, at(2));
  turns.offer_way(std::vector<Vector2d>{{150, 0}});
  EXPECT_TRUE(turns.waits());
  turns.offer_way(std::vector<Vector2d>{{0, 0}});
  EXPECT_FALSE(turns.waits());
  EXPECT_FALSE(turns.ask());
}

// Without a way nobody holds a passage that others could use. ledger: S2-17
TEST_F(PassageTurnsTest, GivesBackATurnThatItCannotUse) {
  turns.set_way({{200, 0}}, at(0));
  go(60, 1);
  turns.take_turn(at(2));
  turns.set_way({}, at(3));
  go(60, 31);
  EXPECT_TRUE(turns.ask());
  go(60, 34);
  EXPECT_FALSE(turns.ask());
  // In the passage, and where it would lie in the way of the next one, it keeps its turn without a way.
  turns.set_way({{200, 0}}, at(40));
  go(90, 41);
  turns.take_turn(at(42));
  turns.set_way({}, at(43));
  go(90, 100);
  go(105, 200);
  EXPECT_TRUE(turns.ask() && turns.ask()->passing);
}

// A vehicle that is in the passage tells so, whether or not it had its turn. ledger: S2-17
TEST_F(PassageTurnsTest, TakesItsTurnWhereItIsInside) {
  turns.set_way({{200, 0}}, at(0));
  go(110, 1);
  ASSERT_TRUE(turns.ask());
  EXPECT_TRUE(turns.ask()->passing);
}

// The wait is bounded; then the passage is closed for good, and the levels above decide. ledger: S2-17
TEST_F(PassageTurnsTest, TakesAPassageForBlockedAfterItsLongestWait) {
  turns.set_way({{200, 0}}, at(0));
  go(75, 0);
  for (double s = 1; s <= 300; ++s) go(75, s);
  EXPECT_TRUE(turns.waits());
  go(75, 301);
  EXPECT_FALSE(turns.waits());
  EXPECT_FALSE(turns.ask());
  EXPECT_TRUE(turns.is_blocked(0));
  go(20, 400);
  EXPECT_TRUE(turns.is_blocked(0));
  EXPECT_FALSE(turns.ask());
}

}  // namespace
}  // namespace isobath
