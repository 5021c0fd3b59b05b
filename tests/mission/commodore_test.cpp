// The Commodore under a script: what it orders, what it sends, and what it does when packets are lost, late or
// repeated.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/mission/agents/commodore.hpp>
#include <set>

#include "agent_script.hpp"

namespace isobath::commodore {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// One vehicle of a group of two, over eight lanes of 120 m.
class CommodoreTest : public testing::Test {
 protected:
  CommodoreTest() {
    plan.search.length_m = 120;
    plan.search.breadth_m = 80;
    plan.search.spacing_m = 10;
    plan.search.station_m = 120;  // its ends only
    plan.search.run_out_m = 0;
    for (const Lane& lane : lanes_of(plan.search)) {
      plan.points.push_back({.north_east = lane.from_W});
      plan.points.push_back({.north_east = lane.to_W});
    }
    plan.group = {{"alpha", {-5, 15}}, {"bravo", {-5, 55}}};
  }
  /// The vehicle starts; what it says.
  std::vector<Message> start(std::size_t own) {
    plan.own = own;
    agent = std::make_unique<Commodore>(CommodoreConfig{});
    script = std::make_unique<Script>(*agent);
    script->hear(fix(0, plan.group[own].start.x(), plan.group[own].start.y()), 0);
    MissionOrder order;
    order.plan = std::make_shared<const MissionPlan>(plan);
    return script->hear(order, 0);
  }
  void visit(std::initializer_list<std::size_t> points) {
    for (const std::size_t point : points) script->hear(PointReport{PointReport::Kind::kReached, point, ""}, now);
  }
  template <class Word>
  std::vector<Message> hear(const Word& word) {
    return script->hear(LinkFrame{LinkFrame::Way::kFromGroup, to_bytes(word)}, now);
  }
  std::vector<Message> wait(double s) {
    std::vector<Message> all;
    for (int i = 0; i < static_cast<int>(s * 10 + 0.5); ++i) {
      for (Message& one : script->tick(now += 0.1)) all.push_back(std::move(one));
    }
    return all;
  }
  /// A status of the other vehicle.
  GroupStatus status(std::uint8_t from, LaneBits done = 0) {
    GroupStatus s;
    s.from = from;
    s.number = ++number;
    s.place_W = plan.group[from].start;
    s.leader = 0;
    s.version = 1;
    s.lanes = 8;
    s.done = done;
    return s;
  }
  static std::vector<std::string> decided(const std::vector<Message>& said) {
    std::vector<std::string> all;
    for (const Decision& d : only<Decision>(said)) all.push_back(d.what);
    return all;
  }

  MissionPlan plan;
  std::unique_ptr<Commodore> agent;
  std::unique_ptr<Script> script;
  std::uint16_t number = 0;
  double now = 0;
};

// The first plan needs no packet: both make the same. ledger: S2-10 S2-19 S2-50
TEST_F(CommodoreTest, BothVehiclesBeginWithTheSamePlan) {
  const auto alpha = only<VisitOrder>(start(0));
  ASSERT_EQ(alpha.size(), 1u);
  EXPECT_THAT(alpha[0].points, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_FALSE(alpha[0].last);
  const std::string told = only<Decision>(script->said).at(0).reason;
  EXPECT_THAT(told, HasSubstr("alpha lanes 1 to 4; bravo lanes 5 to 8"));
  const auto bravo = only<VisitOrder>(start(1));
  EXPECT_THAT(bravo.at(0).points, ElementsAre(8, 9, 10, 11, 12, 13, 14, 15));
  EXPECT_EQ(only<Decision>(script->said).at(0).reason, told);
}

// While all goes as planned, no plan replaces the first. ledger: S2-25
TEST_F(CommodoreTest, KeepsItsPlanWhileNothingHappens) {
  start(0);
  for (int k = 0; k < 3; ++k) {
    wait(40);
    hear(status(1, LaneBits{(1U << k) - 1} << 4));
    visit({2 * static_cast<std::size_t>(k)});
    wait(40);
    hear(status(1, LaneBits{(1U << k) - 1} << 4));
    visit({2 * static_cast<std::size_t>(k) + 1});
  }
  EXPECT_EQ(only<VisitOrder>(script->said).size(), 1u);
}

// ledger: S2-17 S2-50
TEST_F(CommodoreTest, TakesOverTheLanesOfAVehicleThatIsNotHeard) {
  start(0);
  wait(55);
  EXPECT_THAT(decided(wait(10)), ElementsAre("vehicle lost", "share lanes")) << "after six turns of 10 s";
  const VisitOrder order = only<VisitOrder>(script->said).back();
  EXPECT_EQ(order.points.size(), 16u) << "all lanes";
  EXPECT_FALSE(order.last);
  // It is heard again: it gets lanes back, once.
  EXPECT_THAT(decided(hear(status(1))), ElementsAre("heard again"));
  EXPECT_THAT(decided(wait(30)), ElementsAre("share lanes"));
  EXPECT_LT(only<VisitOrder>(script->said).back().points.size(), 16u);
}

// The lane that is being sailed is sailed to its end, and a lane that the lost vehicle had done stays done.
// ledger: S2-24 S2-50
TEST_F(CommodoreTest, GoesOnWithItsLaneAndLeavesOutWhatIsDone) {
  start(0);
  hear(status(1, 0b1110'0000));
  visit({0, 1, 2});
  wait(70);
  const VisitOrder order = only<VisitOrder>(script->said).back();
  ASSERT_EQ(order.points.size(), 7u) << "the end of lane 2, lanes 3, 4 and 5";
  EXPECT_EQ(order.points[0], 3u);
  for (const std::size_t point : order.points) EXPECT_LT(point, 10u);
}

// A lane that the lost vehicle was sailing is resumed at the last station that it told. ledger: S2-50
TEST_F(CommodoreTest, ResumesALaneWhereTheLostVehicleLeftIt) {
  plan.search.station_m = 30;
  plan.points.clear();
  for (const Lane& lane : lanes_of(plan.search)) {
    for (std::size_t i = 0; i < 5; ++i) plan.points.push_back({.north_east = lane.at(plan.search.share_of_station(i))});
  }
  start(0);
  GroupStatus half = status(1, 0b1100'0000);  // lane 6 is half done, from its far end
  half.lane = 5;
  half.stations = 3;
  half.backwards = true;
  hear(half);
  wait(70);
  std::vector<std::size_t> of_lane_6;
  for (const std::size_t point : only<VisitOrder>(script->said).back().points) {
    if (point / 5 == 5) of_lane_6.push_back(point % 5);
  }
  EXPECT_THAT(of_lane_6, testing::UnorderedElementsAre(0, 1, 2)) << "and the way from station 2 to station 1";
  // It tells what it visits itself, too.
  visit({0, 1});
  std::optional<GroupStatus> told;
  for (const LinkFrame& frame : only<LinkFrame>(wait(25))) {
    if (const auto word = group_word_of(frame.bytes)) {
      if (const auto* one = std::get_if<GroupStatus>(&*word)) told = *one;
    }
  }
  ASSERT_TRUE(told);
  EXPECT_EQ(told->lane, 0);
  EXPECT_EQ(told->stations, 2);
  EXPECT_FALSE(told->backwards);
}

// A packet with a new plan was lost, and another vehicle begins a lane of the plan before. ledger: S2-50 S2-51
TEST_F(CommodoreTest, LeavesALaneToTheVehicleThatBeganIt) {
  start(0);
  GroupStatus other = status(1);
  other.lane = 2;
  auto orders = only<VisitOrder>(hear(other));
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_THAT(orders[0].points, testing::Not(testing::Contains(testing::AnyOf(4, 5)))) << "lane 3";
  EXPECT_THAT(orders[0].points, testing::Contains(6));
  EXPECT_THAT(orders[0].why, HasSubstr("bravo sails lane 3"));
  other.number = ++number;
  EXPECT_THAT(only<VisitOrder>(hear(other)), IsEmpty()) << "once";
  wait(70);
  EXPECT_THAT(only<VisitOrder>(script->said).back().points, testing::IsSupersetOf({4, 5})) << "bravo is lost";
}

// ledger: S2-50
TEST_F(CommodoreTest, TheSecondVehicleLeadsWhenTheFirstIsLost) {
  start(1);
  const auto said = wait(75);
  EXPECT_THAT(decided(said), ElementsAre("vehicle lost", "share lanes"));
  EXPECT_EQ(only<VisitOrder>(said).at(0).points.size(), 16u);
}

// ledger: S2-50 S2-51
TEST_F(CommodoreTest, FollowsTheNewestPlanOfItsLeaderOnly) {
  start(1);
  GroupPlan plan_2{0, 2, true, 0, std::vector<std::optional<std::uint8_t>>(8, std::uint8_t{0})};
  plan_2.owner[7] = 1;
  const auto taken = only<VisitOrder>(hear(plan_2));
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_THAT(taken[0].points, testing::UnorderedElementsAre(14, 15));
  EXPECT_THAT(hear(plan_2), IsEmpty()) << "again";
  GroupPlan older = plan_2;
  older.version = 1;
  older.owner[6] = 1;
  EXPECT_THAT(hear(older), IsEmpty()) << "late";
  GroupPlan of_another_mission = plan_2;
  of_another_mission.version = 9;
  of_another_mission.owner.resize(5);
  EXPECT_THAT(hear(of_another_mission), IsEmpty());
}

// ledger: S2-51
TEST_F(CommodoreTest, MergesWhatWasSailedFromEveryPacketAndEndsWhenAllIs) {
  start(0);
  visit({0, 1, 2, 3, 4, 5, 6, 7});
  hear(status(1, 0b0011'0000));
  GroupStatus late = status(1, 0b0111'0000);
  GroupStatus last = status(1, 0b1111'0000);
  const auto said = hear(last);
  EXPECT_THAT(decided(said), ElementsAre("area searched"));
  const auto order = only<VisitOrder>(said);
  ASSERT_EQ(order.size(), 1u);
  EXPECT_TRUE(order[0].last);
  EXPECT_THAT(order[0].points, IsEmpty());
  EXPECT_THAT(hear(late), IsEmpty());
  EXPECT_THAT(hear(last), IsEmpty());
}

// One packet a turn of all slots, in its own slot, and far below the bit rate of a slow modem. ledger: S2-51
TEST_F(CommodoreTest, SendsOnePacketATurnInItsSlot) {
  start(1);
  std::size_t bytes = 0;
  int frames = 0;
  for (int i = 0; i < 1200; ++i) {
    if (i % 100 == 0) hear(status(0));
    for (const LinkFrame& frame : only<LinkFrame>(script->tick(now += 0.1))) {
      EXPECT_EQ(frame.way, LinkFrame::Way::kToGroup);
      EXPECT_GE(std::fmod(now + 1e-9, 10.0), 5.0) << "the second half of the turn";
      bytes += frame.bytes.size();
      ++frames;
    }
  }
  EXPECT_NEAR(frames, 12, 1);
  EXPECT_LT(8 * static_cast<double>(bytes) / 120, 20) << "bit/s";
}

// A plan of its own is sent until the others have it. ledger: S2-51
TEST_F(CommodoreTest, RepeatsANewPlanUntilItIsConfirmed) {
  plan.group.push_back({"charlie", {-5, 35}});
  start(0);
  int plans = 0;
  std::uint16_t version = 0;
  const auto count = [&](const std::vector<Message>& said) {
    for (const LinkFrame& frame : only<LinkFrame>(said)) {
      const auto word = group_word_of(frame.bytes);
      if (!word || !std::holds_alternative<GroupPlan>(*word)) continue;
      ++plans;
      version = std::get<GroupPlan>(*word).version;
    }
  };
  for (int turn = 0; turn < 20; ++turn) {  // bravo is never heard
    hear(status(2));
    count(wait(15));
  }
  EXPECT_GE(plans, 4);
  plans = 0;
  for (int turn = 0; turn < 20; ++turn) {
    GroupStatus confirms = status(2);
    confirms.version = version;
    hear(confirms);
    count(wait(15));
  }
  EXPECT_EQ(plans, 0);
}

TEST_F(CommodoreTest, DoesNothingWithoutAGroup) {
  plan.group.clear();
  EXPECT_THAT(start(0), IsEmpty());
  EXPECT_THAT(wait(100), IsEmpty());
}

// Each status tells of what the own sonar has confirmed near lanes that are left: each obstacle eight times, three a
// packet, no wall and nothing that was told by others. ledger: S2-50 S2-51
TEST_F(CommodoreTest, TellsTheOthersOfObstaclesNearTheirLanes) {
  start(0);
  KnownObstacles known;
  for (int i = 0; i < 5; ++i) {
    RememberedObstacle seen;
    seen.id = static_cast<std::uint32_t>(300 + i);
    seen.outline_W = square(40, 20.0 * i, 1);
    known.obstacles.push_back(seen);
  }
  known.obstacles[1].told = true;
  known.obstacles[2].outline_W = square(40, 40, 20);
  known.obstacles[4].outline_W = square(300, 0, 1);
  ObstacleScan scan;
  scan.known = std::make_shared<const KnownObstacles>(known);
  script->hear(scan, now);
  std::map<int, int> tellings;
  for (const LinkFrame& frame : only<LinkFrame>(wait(300))) {
    const auto word = group_word_of(frame.bytes);
    ASSERT_TRUE(word && std::holds_alternative<GroupStatus>(*word));
    for (const ObstacleWord& o : std::get<GroupStatus>(*word).obstacles) {
      ++tellings[o.key];
      EXPECT_NEAR(o.radius_m, std::sqrt(2.0) + 0.36, 0.25);
    }
  }
  EXPECT_THAT(tellings, ElementsAre(testing::Pair(300 - 256, 8), testing::Pair(303 - 256, 8)));
}

// A vehicle that waits looks like an obstacle to the others: it is not told of as one, and does not believe it of
// itself. ledger: S2-50
TEST_F(CommodoreTest, TakesNoVehicleOfTheGroupForAnObstacle) {
  start(0);
  hear(status(1));  // bravo is at (-5, 55)
  RememberedObstacle bravo, rock;
  bravo.id = 1;
  bravo.outline_W = square(0, 58, 1);
  rock.id = 2;
  rock.outline_W = square(30, 58, 1);
  ObstacleScan scan;
  scan.known = std::make_shared<const KnownObstacles>(KnownObstacles{0, {bravo, rock}, {}});
  script->hear(scan, now);
  std::set<int> told;
  for (const LinkFrame& frame : only<LinkFrame>(wait(30))) {
    const auto word = group_word_of(frame.bytes);
    for (const ObstacleWord& o : std::get<GroupStatus>(*word).obstacles) told.insert(o.key);
  }
  EXPECT_THAT(told, ElementsAre(2));
  GroupStatus of_alpha = status(1);
  of_alpha.obstacles = {{7, {-4, 14}, 1.5, 1}};
  EXPECT_TRUE(only<GroupObstacles>(hear(of_alpha)).empty());
}

// ledger: S2-50 S2-51
TEST_F(CommodoreTest, HandsOnWhatTheOthersTell) {
  start(0);
  GroupStatus told = status(1);
  told.obstacles = {{7, {60, 45.5}, 2, 1}};
  const auto handed = only<GroupObstacles>(hear(told));
  ASSERT_EQ(handed.size(), 1u);
  EXPECT_EQ(handed[0].obstacles.at(0), (ToldObstacle{1, 7, {60, 45.5}, 2, 1}));
  EXPECT_TRUE(only<GroupObstacles>(hear(told)).empty()) << "a packet that is repeated";
}

// Two vehicles that were planned apart begin together; the one that does not lead hears the time from the leader.
// ledger: S2-19
TEST_F(CommodoreTest, BeginsTogetherWithTheOthers) {
  plan.search.together_s = 120;
  add_waiting_places(plan);
  EXPECT_THAT(only<VisitOrder>(start(0)).at(0).points, ElementsAre(16)) << "first to its waiting place";
  wait(30);
  visit({16});
  EXPECT_THAT(only<VisitOrder>(wait(10)), IsEmpty()) << "bravo is not there yet";
  GroupStatus there = status(1);
  there.ready = true;
  hear(there);
  const auto frames = only<LinkFrame>(wait(21));
  const auto told = std::get<GroupStatus>(group_word_of(frames.back().bytes).value());
  EXPECT_TRUE(told.ready);
  ASSERT_TRUE(told.begin_s);
  EXPECT_EQ(*told.begin_s, 81) << "four turns of 10 s after it heard, and a whole second";
  EXPECT_THAT(only<VisitOrder>(wait(20)), ElementsAre(testing::Field(&VisitOrder::points, testing::SizeIs(9))));
  EXPECT_THAT(decided(script->said), testing::Contains("begin together"));

  now = 0;
  number = 0;
  EXPECT_THAT(only<VisitOrder>(start(1)).at(0).points, ElementsAre(18));
  visit({18});
  GroupStatus leader = status(0);
  leader.begin_s = 81;
  hear(leader);
  EXPECT_THAT(only<VisitOrder>(wait(80.8)), IsEmpty());
  EXPECT_THAT(only<VisitOrder>(wait(0.3)), testing::SizeIs(1));
}

// ledger: S2-19
TEST_F(CommodoreTest, WaitsForAMissingVehicleNoLongerThanTheMissionSays) {
  plan.search.together_s = 40;
  add_waiting_places(plan);
  start(0);
  visit({16});
  EXPECT_THAT(only<VisitOrder>(wait(39.9)), IsEmpty());
  const auto said = wait(0.2);
  EXPECT_EQ(only<VisitOrder>(said).size(), 1u);
  EXPECT_THAT(only<Decision>(said).at(0).reason, HasSubstr("after 40 s bravo did not say to be ready"));
}

/// Two vehicles before one gap, over a link that loses packets; each goes where it is ordered, straight.
class PassageTest : public CommodoreTest {
 protected:
  struct Boat {
    std::unique_ptr<Commodore> agent;
    std::unique_ptr<Script> script;
    double north = 0, to = 0;
    bool waits = false, off = false;
    std::uint32_t version = 0;
  };
  PassageTest() {
    plan.passages = {{{}, "the gap", {{100, -10}, {120, -10}, {120, 10}, {100, 10}}}};
    plan.search.corner = {300, 0};
    for (std::size_t v = 0; v < 2; ++v) {
      plan.own = v;
      boats[v].agent = std::make_unique<Commodore>(CommodoreConfig{});
      boats[v].script = std::make_unique<Script>(*boats[v].agent);
      MissionOrder order;
      order.plan = std::make_shared<const MissionPlan>(plan);
      boats[v].script->hear(fix(0, 0, 0), 0);
      boats[v].script->hear(order, 0);
    }
  }
  void send_to(std::size_t v, double north) {
    boats[v].to = north;
    follow(v);
  }
  void follow(std::size_t v) {
    Boat& boat = boats[v];
    std::vector<Waypoint> way;
    if (!boat.waits) way.push_back({boat.to, 0, 10, 1.5});
    boat.script->hear(FollowOrder{++boat.version, std::move(way), {}, false}, now);
  }
  [[nodiscard]] bool inside(std::size_t v) const { return boats[v].north > 97 && boats[v].north < 123; }
  /// What a vehicle says takes effect; its packets reach the other one, or are lost.
  void act(std::size_t v, const std::vector<Message>& said, double loss, Random& random) {
    Boat &boat = boats[v], &other = boats[1 - v];
    for (const Message& one : said) {
      if (const auto* wait = std::get_if<PassageWait>(&one)) {
        EXPECT_NE(boat.waits, wait->waits);
        boat.waits = wait->waits;
        follow(v);
      }
      const auto* frame = std::get_if<LinkFrame>(&one);
      if (frame == nullptr || other.off || random.uniform() < loss) continue;
      act(1 - v, other.script->hear(LinkFrame{LinkFrame::Way::kFromGroup, frame->bytes}, now), loss, random);
    }
  }
  void sail(double s, double loss, Random& random) {
    for (int i = 0; i < static_cast<int>(s * 10); ++i) {
      now += 0.1;
      for (std::size_t v = 0; v < 2; ++v) {
        Boat& boat = boats[v];
        if (boat.off) continue;
        boat.north += boat.waits ? 0 : std::clamp(boat.to - boat.north, -0.15, 0.15);
        boat.script->hear(fix(now, boat.north, 0), now);
        act(v, boat.script->tick(now), loss, random);
      }
      both_inside = both_inside || (inside(0) && inside(1));
    }
  }
  Boat boats[2];
  bool both_inside = false;
};

// Both reach the gap at one time, again and again, from one side and from both; one waits each time, whatever the link
// loses. ledger: S2-17 S2-51
TEST_F(PassageTest, GoesThroughAGapInTurn) {
  Random random(11);
  for (int trial = 0; trial < 40; ++trial) {
    const double loss = 0.1 * (trial % 5);
    for (std::size_t v = 0; v < 2; ++v) {
      const bool out = (trial / (v + 1)) % 2 == 0;
      send_to(v, out ? 200 + 10.0 * random.uniform() : 10 * random.uniform());
    }
    sail(400, loss, random);
    ASSERT_FALSE(both_inside) << trial;
    for (std::size_t v = 0; v < 2; ++v) EXPECT_NEAR(boats[v].north, boats[v].to, 0.2) << trial << ", vehicle " << v;
  }
  EXPECT_THAT(decided(boats[1].script->said), testing::Contains("wait for passage"));
  EXPECT_THAT(decided(boats[1].script->said), testing::Contains("leave passage"));
}

// The Captain sends a vehicle home that waits before the gap: it goes at once. ledger: S2-17 S2-32
TEST_F(PassageTest, LetsAVehicleGoThatIsOrderedElsewhere) {
  Random random(13);
  send_to(0, 105);  // it stays in the gap
  sail(40, 0, random);
  send_to(1, 200);
  sail(120, 0, random);
  ASSERT_TRUE(boats[1].waits);
  boats[1].to = 0;
  const auto said = boats[1].script->hear(RoutePlanned{9, 9, {{0, 0, 10, 1.5}}, false, ""}, now);
  sail(0.2, 0, random);
  EXPECT_FALSE(boats[1].waits);
  sail(60, 0, random);
  EXPECT_LT(boats[1].north, 10);
}

// The gate keeper is lost in the gap: the other goes through after half of its longest wait. ledger: S2-17 S2-50
TEST_F(PassageTest, OutlivesTheVehicleThatGivesTheTurns) {
  Random random(12);
  send_to(0, 200);
  send_to(1, 200);
  sail(60, 0, random);
  boats[0].off = true;
  sail(120, 0, random);
  EXPECT_TRUE(boats[1].waits) << "it may still be in the gap, though it is lost since 80 s";
  sail(130, 0, random);
  EXPECT_NEAR(boats[1].north, 200, 0.2);
}

// No route to two stations of a lane, and to two lanes: the others get the lanes; and where all are without a way, the
// Captain decides. Attempts are bounded. ledger: S2-17
TEST_F(CommodoreTest, GivesUpLanesToWhichThereIsNoWayAndTellsTheCaptainWhenAllDo) {
  start(0);
  hear(status(1));
  const auto no_way = [&](std::size_t point) {
    return script->hear(PointReport{PointReport::Kind::kDropped, point, "no path", true}, now);
  };
  EXPECT_THAT(no_way(0), IsEmpty()) << "one station may be shut in";
  EXPECT_THAT(decided(no_way(1)), ElementsAre("give up lane"));
  EXPECT_EQ(only<VisitOrder>(script->said).back().points.front(), 3u) << "lane 2 from its near end";
  no_way(3);
  const auto said = no_way(2);
  EXPECT_THAT(decided(said), ElementsAre("give up lane", "give up lanes"));
  EXPECT_THAT(only<VisitOrder>(said).at(0).points, IsEmpty());
  hear(status(1));
  const auto shared = wait(15);
  EXPECT_THAT(decided(shared), testing::Contains("share lanes"));
  EXPECT_THAT(only<Decision>(shared).at(0).reason, HasSubstr("alpha no lane; bravo lanes 1 to 8"));
  EXPECT_THAT(only<VisitOrder>(shared), IsEmpty()) << "bravo may find a way";
  GroupStatus other = status(1);
  other.no_way = true;
  hear(other);
  const auto up = only<VisitOrder>(wait(1));
  ASSERT_EQ(up.size(), 1u);
  EXPECT_TRUE(up[0].given_up);
  EXPECT_THAT(only<VisitOrder>(wait(30)), IsEmpty()) << "once";
}

// A lane of which one end is shut in is sailed as far as there is a way. ledger: S2-17
TEST_F(CommodoreTest, GoesOnWhereOneStationHasNoWay) {
  start(0);
  script->hear(PointReport{PointReport::Kind::kDropped, 0, "no path", true}, now);
  visit({1, 2});
  script->hear(PointReport{PointReport::Kind::kDropped, 3, "no path", true}, now);
  visit({4});
  EXPECT_THAT(decided(script->said), ElementsAre("share lanes")) << "as at the start";
}

}  // namespace
}  // namespace isobath::commodore
