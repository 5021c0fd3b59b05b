// A MOOSDB over a real socket on this machine: the handshake, fixes, who may steer, obstacles, and cables that are
// pulled.
#include <gmock/gmock.h>
#include <tests/links/joined.hpp>

namespace isobath::moos_links {
namespace {

using test::Joined;

const std::string kMoos =
    "kind = \"moos\"\nlatitude_deg = 1.312\nlongitude_deg = 103.742\n[mission]\nfrom = \"none\"\n";

StandInRequest moosdb() {
  StandInRequest request;
  request.front_seat = FrontSeatKind::kMoos;
  return request;
}

Setpoint ahead() {
  Setpoint setpoint;
  setpoint.heading = Angle::degrees(-90);  // west: MOOS counts 270
  setpoint.speed = 0.5;
  setpoint.depth = 0.5;
  return setpoint;
}

TEST(MoosLinks, NavigationBecomesFixes) {
  Joined joined(moosdb(), kMoos);
  int fixes = 0, beats = 0;
  std::optional<Navigation> fix;
  EXPECT_TRUE(joined.until([&](const Event& event) {
    if (const auto* found = std::get_if<Navigation>(&event)) {
      EXPECT_TRUE(!fix || found->time > fix->time);
      fix = *found;
      ++fixes;
    }
    const auto* health = std::get_if<Health>(&event);
    beats += health && health->source == "vehicle";
    return fixes > 20 && beats > 1;
  })) << fixes
      << " fixes, " << beats << " reports";
  ASSERT_TRUE(fix);
  EXPECT_LT(fix->X_WB.translation.head<2>().norm(), 8) << "it stands at the origin of the scene";
  EXPECT_NEAR(fix->X_WB.translation.z(), 0.5, 0.5);
  ASSERT_TRUE(joined.vehicle().autopilot().origin());
  EXPECT_EQ(joined.vehicle().autopilot().origin()->latitude_deg, 1.312);
  EXPECT_EQ(joined.stand_ins().autopilot().malformed, 0u);
}

TEST(MoosLinks, SteerOnlyWhileTheOverrideIsFalse) {
  StandInRequest request = moosdb();
  request.guided_after_s = 12;
  request.turns = {{10, 20}};
  Joined joined(request, kMoos);
  FrontSeat& autopilot = joined.vehicle().autopilot();
  std::map<Authority, FrontSeat::Counts> first, last;
  std::optional<Authority> before;
  std::vector<Authority> course;
  using enum Authority;
  joined.until([&](const Event& event) {
    autopilot.command(ahead(), {}, time_of(event));
    const Authority now = autopilot.authority();
    if (now == kNoAutopilot || now == kDisarmed)
      return false;  // not heard yet, or a busy machine was silent for a moment
    if (before != now) {
      course.push_back(now);
      first[now] = autopilot.counts();
    }
    before = now;
    last[now] = autopilot.counts();
    return course.size() >= 4 && now == kOurs && last[now].setpoints > first[now].setpoints + 5 &&
           joined.stand_ins().autopilot().setpoints > 5;
  });
  EXPECT_THAT(course, testing::ElementsAre(kOtherMode, kOurs, kOtherMode, kOurs));
  EXPECT_EQ(last[kOtherMode].setpoints, first[kOtherMode].setpoints) << "the pilot has the vehicle";
  EXPECT_GT(last[kOtherMode].withheld, first[kOtherMode].withheld);
  EXPECT_EQ(joined.stand_ins().autopilot().malformed, 0u);
  EXPECT_NEAR(joined.stand_ins().setpoint().heading.wrapped_positive().degrees(), 270, 0.1);
}

TEST(MoosLinks, TheVehicleStopsWhenTheRunEnds) {
  Joined joined(moosdb(), kMoos);
  FrontSeat& autopilot = joined.vehicle().autopilot();
  EXPECT_TRUE(joined.until([&](const Event& event) {
    autopilot.command(ahead(), {}, time_of(event));
    return joined.stand_ins().setpoint().speed > 0;
  }));
  const Time before = joined.vehicle().now();
  autopilot.end();
  // Later than that the front seat stops by itself.
  EXPECT_TRUE(joined.stand_ins().setpoint().speed == 0 || joined.vehicle().now() - before > std::chrono::seconds(2));
  EXPECT_FALSE(autopilot.command(ahead(), {}, joined.vehicle().now()));
}

TEST(MoosLinks, TellObstaclesAndDecisions) {
  Joined joined(moosdb(), kMoos);
  FrontSeat& autopilot = joined.vehicle().autopilot();
  Surroundings around;
  around.reach_m = 20;
  around.obstacles = {
      {7, {{10, 3}, {12, 3}, {12, 5}, {10, 5}}}, {7, {{12, 3}, {14, 3}, {14, 4}}}, {9, {{1, 1}, {1, 1}}}};
  EXPECT_TRUE(joined.until([&](const Event&) {
    autopilot.show(around, {}, joined.vehicle().now());
    if (joined.stand_ins().autopilot().texts < 3) autopilot.say(6, "Captain: goes on");
    return joined.stand_ins().autopilot().obstacles >= 4 && joined.stand_ins().autopilot().texts > 2;
  }));
  EXPECT_EQ(joined.stand_ins().autopilot().malformed, 0u) << "all are convex";
}

TEST(MoosLinks, AreFoundAgainAfterEachPull) {
  StandInRequest request = moosdb();
  request.unplug = {.times = 4, .mean_s = 2, .longest_s = 2, .seed = 3};
  Joined joined(request, kMoos);
  FrontSeat& autopilot = joined.vehicle().autopilot();
  int fixes = 0;
  std::uint64_t setpoints = 0;
  EXPECT_TRUE(joined.until([&](const Event& event) {
    autopilot.command(ahead(), {}, time_of(event));
    const AutopilotCounts counts = joined.stand_ins().autopilot();
    if (counts.pulled < 4) {
      setpoints = counts.setpoints;
      return false;
    }
    fixes += std::holds_alternative<Navigation>(event);
    return fixes > 10 && counts.setpoints > setpoints + 5;
  })) << joined.stand_ins().autopilot().pulled
      << " pulls, then " << fixes << " fixes";
}

}  // namespace
}  // namespace isobath::moos_links
