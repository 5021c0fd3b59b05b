#include <gmock/gmock.h>
#include <isobath/sonar/sweep.hpp>
#include <tests/support/echoes.hpp>
#include <vector>

namespace isobath {
namespace {

/// Pings of a head at these bearings, 67 ms apart; the pings of each scan that was found.
class Head {
 public:
  void at(double bearing_deg, SweepMark mark = SweepMark::kUnknown, int beams = 1) {
    Ping ping;
    ping.fan = test::fan_of(beams, Angle::degrees(bearing_deg));
    ping.time = Time{seconds(0.067 * count_++)};
    ping.sweep = mark;
    if (const auto scan = finder_.add(ping)) scans.push_back(*scan);
  }
  [[nodiscard]] std::vector<int> pings() const {
    std::vector<int> all;
    for (const Scan& scan : scans) all.push_back(scan.pings);
    return all;
  }
  std::vector<Scan> scans;

 private:
  SweepSegmenter finder_;
  int count_ = 0;
};

// ledger: S6-01
TEST(SweepSegmenter, CountsThirtyOnePingsInASectorAndTurnsBack) {
  Head head;
  for (int sweep = 0; sweep < 4; ++sweep) {
    for (int i = 0; i <= 30; ++i) head.at((sweep % 2 == 0 ? 1 : -1) * (-45 + 3 * i));
  }
  EXPECT_THAT(head.pings(), testing::ElementsAre(31, 31, 31));
  EXPECT_TRUE(head.scans[0].clockwise);
  EXPECT_FALSE(head.scans[1].clockwise);
  EXPECT_NEAR(to_seconds(head.scans[1].begin), 31 * 0.067, 1e-9);
  EXPECT_NEAR(to_seconds(head.scans[1].end), 61 * 0.067, 1e-9);
}

// ledger: S6-01
TEST(SweepSegmenter, TurnsBackWithoutRepeatingTheLastBearing) {
  Head head;
  for (int i = 0; i <= 90; ++i) head.at(i % 60 < 30 ? -45 + 3 * (i % 30) : 45 - 3 * (i % 30));
  EXPECT_THAT(head.pings(), testing::ElementsAre(31, 30));
}

TEST(SweepSegmenter, EndsATurnWithItsLastPing) {
  Head head;
  for (int i = 0; i < 600; ++i) {
    head.at(1.8 * ((i + 77) % 200));
    EXPECT_EQ(head.scans.size(), std::size_t(i + 1) / 200) << i;
  }
  EXPECT_TRUE(head.scans[1].full_turn);
  EXPECT_THAT(head.pings(), testing::Each(200));
}

TEST(SweepSegmenter, TurnsStayAlignedWhenBearingsAreSkipped) {
  Head head;
  for (int turn = 0; turn < 5; ++turn) {
    for (int i = 0; i < 200; ++i) {
      if ((i + 13 * turn) % 29 != 0 && !(turn == 2 && i >= 195)) head.at(-1.8 * i);
    }
  }
  ASSERT_GE(head.scans.size(), 4u);
  for (const Scan& scan : head.scans) {
    EXPECT_TRUE(scan.full_turn);
    EXPECT_FALSE(scan.clockwise);
    EXPECT_NEAR(scan.pings, 193, 7);
  }
}

TEST(SweepSegmenter, SkippedAndJitteringBearingsDoNotTurnASectorBack) {
  Random random(3);
  Head head;
  for (int sweep = 0; sweep < 6; ++sweep) {
    for (int i = 0; i <= 30; ++i) {
      if (i % 30 != 0 && random.uniform() < 0.2) continue;
      head.at((sweep % 2 == 0 ? 1 : -1) * (-45 + 3 * i) + random.uniform(-0.5, 0.5));
    }
  }
  EXPECT_EQ(head.scans.size(), 5u);
}

TEST(SweepSegmenter, AHeadThatFliesBackSweepsOneWay) {
  Head head;
  for (int sweep = 0; sweep < 4; ++sweep) {
    for (int i = 0; i <= 30; ++i) head.at(-45 + 3 * i);
  }
  EXPECT_THAT(head.pings(), testing::ElementsAre(31, 31, 31));
  for (const Scan& scan : head.scans) EXPECT_TRUE(scan.clockwise);
}

// ledger: S6-01
TEST(SweepSegmenter, AMultibeamPingIsAScan) {
  Head head;
  for (int i = 0; i < 3; ++i) head.at(-15, SweepMark::kUnknown, 31);
  EXPECT_THAT(head.pings(), testing::ElementsAre(1, 1, 1));
}

TEST(SweepSegmenter, BelievesTheMarksOfTheLog) {
  Head head;
  for (int i = 0; i < 20; ++i) head.at(3 * i, i % 10 == 9 ? SweepMark::kEnd : SweepMark::kInside);
  EXPECT_THAT(head.pings(), testing::ElementsAre(10, 10));
}

TEST(SweepSegmenter, AHeadThatStandsStillEndsNothing) {
  Head head;
  for (int i = 0; i < 100; ++i) head.at(12);
  EXPECT_TRUE(head.scans.empty());
}

}  // namespace
}  // namespace isobath
