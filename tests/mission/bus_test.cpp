// Every message passes the bus once: numbered, counted by sender and type, recorded.
#include <gmock/gmock.h>
#include <isobath/mission/command/bus.hpp>
#include <set>
#include <stdexcept>
#include <tests/mission/scripted_agent.hpp>

namespace isobath {
namespace {

using testing::ElementsAre;

TEST(Bus, EveryTypeOfMessageHasANameOfItsOwn) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < kMessageTypes; ++i) names.insert(message_name(i));
  EXPECT_EQ(names.size(), kMessageTypes);
  EXPECT_STREQ(message_name(Message(HelmOrder{})), "helm order");
  EXPECT_STREQ(message_name(Message(AgentLost{})), "agent lost");
  EXPECT_STREQ(message_name(Message(Navigation{})), "navigation");
}

TEST(Decisions, AsOneLineSayWhenWhoWhatAndWhy) {
  EXPECT_EQ(to_text(Decision{test::at(27.2), "navigator", "replan", "leg 1 would run into an obstacle"}),
            "27.200 s navigator: replan: leg 1 would run into an obstacle");
}

// ledger: S6-33
TEST(Bus, NumbersCountsAndRecords) {
  std::vector<std::string> recorded;
  Bus bus([&](const Envelope& e) {
    recorded.push_back(fmt::format("{} {} {} {}", e.number, to_seconds(e.time), e.sender, test::text_of(e.message)));
  });
  bus.post("captain", test::call(7), test::at(1));
  bus.post("pilot", HelmOrder{}, test::at(1.5));
  const Envelope last = bus.post("captain", test::call(8), test::at(2));
  EXPECT_THAT(recorded, ElementsAre("1 1 captain task call 7", "2 1.5 pilot helm order", "3 2 captain task call 8"));
  EXPECT_EQ(last.number, 3u);
  EXPECT_EQ(bus.posted(), 3u);
  EXPECT_EQ(bus.said().at("captain").at(test::call(0).index()), 2u);
  EXPECT_EQ(bus.said().at("pilot").at(Message(HelmOrder{}).index()), 1u);
  EXPECT_EQ(bus.said().at("pilot").at(test::call(0).index()), 0u);
}

TEST(Bus, NumbersDecisionsFromOneWhoeverDecides) {
  std::vector<std::uint64_t> recorded;
  Bus bus([&](const Envelope& e) {
    if (const auto* decision = std::get_if<Decision>(&e.message)) recorded.push_back(decision->number);
  });
  bus.post("captain", Decision{test::at(0), "captain", "start", "all is well"}, test::at(0));
  bus.post("pilot", HelmOrder{}, test::at(1));
  const Envelope sent = bus.post("navigator", Decision{test::at(1), "navigator", "plan", "clear"}, test::at(1));
  EXPECT_THAT(recorded, ElementsAre(1u, 2u));
  EXPECT_EQ(std::get<Decision>(sent.message).number, 2u) << "the agents receive it with its number, too";
}

// ledger: S6-33
TEST(Bus, ARecorderThatThrowsIsGivenUpAndTheBusGoesOn) {
  int calls = 0;
  Bus bus([&](const Envelope&) {
    if (++calls == 2) throw std::runtime_error("disk full");
  });
  bus.post("a", test::call(1), test::at(0));
  EXPECT_EQ(bus.take_recorder_loss(), std::nullopt);
  EXPECT_EQ(bus.post("a", test::call(2), test::at(0)).number, 2u);
  bus.post("a", test::call(3), test::at(0));
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(bus.take_recorder_loss(), "disk full");
  EXPECT_EQ(bus.take_recorder_loss(), std::nullopt);
}

// ledger: S6-33
TEST(Bus, ATurnThatThrowsSaysNothing) {
  test::ScriptedAgent agent(
      [](const Message& message, Time, Outbox& out) {
        out.say(AgentLost{});
        if (test::id_of(message) == 1) throw std::runtime_error("no such leg");
        if (test::id_of(message) == 2) throw 5;
      },
      [](Time, Outbox& out) { out.say(HelmOrder{}); });
  const Turn broken = deliver_in_turn(agent, test::call(1), test::at(0));
  EXPECT_EQ(broken.died, "no such leg");
  EXPECT_TRUE(broken.said.empty());
  EXPECT_EQ(deliver_in_turn(agent, test::call(2), test::at(0)).died, "threw something that is not an exception");
  EXPECT_EQ(deliver_in_turn(agent, test::call(3), test::at(0)).died, std::nullopt);
  EXPECT_EQ(tick_in_turn(agent, test::at(0)).said.size(), 1u);
}

}  // namespace
}  // namespace isobath
