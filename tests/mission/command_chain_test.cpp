// Which command serves which: by what a command names, so that one that serves an old order shows it.
#include <gtest/gtest.h>
#include <isobath/mission/command/bus.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

RouteRequest request_of(std::uint32_t id) {
  RouteRequest request;
  request.id = id;
  return request;
}
RoutePlanned route_of(std::uint32_t request, std::uint32_t version) {
  RoutePlanned route;
  route.request = request;
  route.version = version;
  return route;
}
MotionOrder motion_of(std::uint32_t version) {
  MotionOrder motion;
  motion.version = version;
  return motion;
}

class CommandChainTest : public testing::Test {
 protected:
  /// The number of the message on the bus, and its link.
  template <class Said>
  std::uint64_t post(Said said, double s = 0) {
    const Envelope envelope = bus.post("somebody", Message(std::move(said)), at(s));
    link = envelope.link;
    return envelope.number;
  }
  [[nodiscard]] std::uint64_t parent() const { return link ? link->parent : 999; }
  [[nodiscard]] CommandLevel level() const { return link.value().level; }

  Bus bus{nullptr};
  std::optional<CommandLink> link;
};

// ledger: S2-02 S2-26
TEST_F(CommandChainTest, LeadsFromTheMissionToThePrimitive) {
  const std::uint64_t start = post(OperatorCommand{OperatorCommand::Kind::kStart});
  EXPECT_FALSE(link) << "the operator stands above all levels";
  const std::uint64_t mission = post(MissionOrder{});
  EXPECT_EQ(parent(), start);
  EXPECT_EQ(level(), CommandLevel::kMission);
  const std::uint64_t visits = post(VisitOrder{1, {0, 1}, false, ""});
  EXPECT_EQ(parent(), mission);
  EXPECT_EQ(level(), CommandLevel::kGroup);
  const std::uint64_t request = post(request_of(7));
  EXPECT_EQ(parent(), visits);
  EXPECT_EQ(level(), CommandLevel::kVehicle);
  const std::uint64_t route = post(route_of(7, 3));
  EXPECT_EQ(parent(), request);
  const std::uint64_t follow = post(FollowOrder{3, {Waypoint{}}, {}, false});
  EXPECT_EQ(parent(), route);
  EXPECT_EQ(level(), CommandLevel::kMove);
  post(HelmOrder{});
  EXPECT_EQ(parent(), follow);
  EXPECT_EQ(level(), CommandLevel::kPrimitive);
  post(OperatorCommand{OperatorCommand::Kind::kBeat});
  EXPECT_EQ(post(MissionOrder{}), 9u);
  EXPECT_EQ(parent(), start) << "a beat is no order";
}

// A motion past moving bodies is followed while it lasts. ledger: S2-02
TEST_F(CommandChainTest, FollowsAMotionWhileItLasts) {
  post(MissionOrder{});
  post(request_of(1));
  post(route_of(1, 1));
  const std::uint64_t follow = post(FollowOrder{1, {Waypoint{}}, {}, false});
  const std::uint64_t motion = post(motion_of(1), 1);
  EXPECT_EQ(parent(), follow);
  post(HelmOrder{}, 1.4);
  EXPECT_EQ(parent(), motion);
  post(HelmOrder{}, 1.6);
  EXPECT_EQ(parent(), follow) << "the motion is over";
  post(motion_of(1), 2);
  post(route_of(1, 2), 2);
  const std::uint64_t newer = post(FollowOrder{2, {Waypoint{}}, {}, false}, 2);
  post(HelmOrder{}, 2.1);
  EXPECT_EQ(parent(), newer) << "a motion of the route before counts no more";
}

// ledger: S2-32
TEST_F(CommandChainTest, ShowsThatARouteServesAnOldRequest) {
  post(MissionOrder{});
  const std::uint64_t first = post(request_of(1));
  post(request_of(2));
  post(route_of(1, 1));
  EXPECT_EQ(parent(), first);
  post(route_of(5, 2));
  EXPECT_EQ(parent(), 0u) << "nobody asked for it";
}

// ledger: S2-28
TEST_F(CommandChainTest, AReflexServesNoOrder) {
  post(MissionOrder{});
  post(SafetyAction{});
  EXPECT_EQ(parent(), 0u);
  EXPECT_EQ(level(), CommandLevel::kPrimitive);
  post(Navigation{});
  EXPECT_FALSE(link);
}

// A stop is an order of the level that has no route for it. ledger: S2-02
TEST_F(CommandChainTest, AStopServesTheOrderInForce) {
  const std::uint64_t mission = post(MissionOrder{});
  const std::uint64_t stop = post(FollowOrder{0, {}, {}, false});
  EXPECT_EQ(parent(), mission);
  post(HelmOrder{});
  EXPECT_EQ(parent(), stop);
}

}  // namespace
}  // namespace isobath
