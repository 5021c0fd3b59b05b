// The agents in one thread: who hears what when, who is given up, and that it is the same every time.
#include <gmock/gmock.h>
#include <isobath/mission/command/executor.hpp>
#include <map>
#include <rapidcheck/gtest.h>
#include <stdexcept>
#include <tests/mission/scripted_agent.hpp>

namespace isobath {
namespace {

using test::at;
using test::call;
using test::id_of;
using test::slot;
using test::slots;
using testing::ElementsAre;
using testing::HasSubstr;

ExecutorConfig without_safety_officer() {
  ExecutorConfig config;
  config.arbiter.safety_officer = "";
  config.arbiter.order_timeout_s = 60;
  return config;
}

/// "pilot: task call 3" of all that is said.
struct Log {
  std::vector<std::string> lines;
  Recorder recorder() {
    return [this](const Envelope& e) { lines.push_back(e.sender + ": " + test::text_of(e.message)); };
  }
};

/// Writes down what it hears.
test::ScriptedAgent::Hear listen(std::vector<std::string>& into) {
  return [&into](const Message& message, Time, Outbox&) { into.push_back(test::text_of(message)); };
}

// ledger: S6-33
TEST(Executor, MessagesAreHeardByAllInTheOrderInWhichTheyWereSaid) {
  std::vector<std::string> first;
  std::vector<std::string> second;
  const auto answering = [](std::vector<std::string>& heard, std::uint32_t base) {
    return [&heard, base](const Message& message, Time, Outbox& out) {
      heard.push_back(test::text_of(message));
      if (id_of(message) == 1) {
        out.say(TaskCall{base, "", {}});
        out.say(TaskCall{base + 1, "", {}});
      }
      if (id_of(message) == 10) out.say(TaskCall{base + 5, "", {}});
    };
  };
  Executor executor(slots(slot("a", answering(first, 10)), slot("b", answering(second, 20))), {},
                    without_safety_officer());
  EXPECT_TRUE(executor.on_message(call(1), at(0)));
  const std::vector<std::string> expected = {"task call 1",  "task call 10", "task call 11", "task call 20",
                                             "task call 21", "task call 15", "task call 25"};
  EXPECT_EQ(first, expected);
  EXPECT_EQ(second, expected);
}

TEST(Executor, TicksTenTimesASecondAndBeforeWhatIsSensedLater) {
  std::vector<std::string> events;
  Executor executor(slots(slot(
                        "a",
                        [&](const Message& m, Time t, Outbox&) {
                          events.push_back(fmt::format("{:.2f} {}", to_seconds(t), test::text_of(m)));
                        },
                        [&](Time t, Outbox&) { events.push_back(fmt::format("{:.2f} tick", to_seconds(t))); })),
                    {}, without_safety_officer());
  executor.on_message(call(1), at(5));
  executor.on_message(call(2), at(5.1));
  executor.on_message(call(3), at(5.25));
  executor.advance(at(5.3));
  executor.advance(at(5.3));
  EXPECT_THAT(events, ElementsAre("5.00 task call 1", "5.10 tick", "5.10 task call 2", "5.20 tick", "5.25 task call 3",
                                  "5.30 tick"));
  EXPECT_EQ(executor.counts().ticks, 3u);
}

TEST(Executor, AllHaveTickedBeforeAnythingThatWasSaidInTheTickIsHeard) {
  std::vector<std::string> events;
  const auto ticking = [&](std::uint32_t id) {
    return slot(
        fmt::format("agent {}", id),
        [&events, id](const Message& m, Time, Outbox&) { events.push_back(fmt::format("{} hears {}", id, id_of(m))); },
        [&events, id](Time, Outbox& out) {
          events.push_back(fmt::format("{} ticks", id));
          out.say(TaskCall{id, "", {}});
        });
  };
  Executor executor(slots(ticking(1), ticking(2)), {}, without_safety_officer());
  executor.advance(at(0));
  executor.advance(at(0.1));
  EXPECT_THAT(events, ElementsAre("1 ticks", "2 ticks", "1 hears 1", "2 hears 1", "1 hears 2", "2 hears 2"));
}

TEST(Executor, AClockThatGoesBackIsRefusedCountedAndToldOnce) {
  Log log;
  std::vector<std::string> heard;
  Executor executor(slots(slot("a", listen(heard))), {}, without_safety_officer(), log.recorder());
  executor.advance(at(10));
  EXPECT_FALSE(executor.on_message(call(1), at(9)));
  EXPECT_FALSE(executor.advance(at(9.9)));
  EXPECT_EQ(executor.counts().refused, 2u);
  EXPECT_TRUE(executor.on_message(call(2), at(10)));
  EXPECT_FALSE(executor.advance(at(1)));
  EXPECT_THAT(heard, ElementsAre("decision refuse time", "task call 2", "decision refuse time"));
}

TEST(Executor, AJumpAheadSkipsTicksButNotTheLastOnes) {
  Log log;
  std::vector<double> ticks;
  ExecutorConfig config = without_safety_officer();
  config.max_ticks = 3;
  Executor executor(slots(slot("a", {}, [&](Time t, Outbox&) { ticks.push_back(to_seconds(t)); })), {}, config,
                    log.recorder());
  executor.advance(at(0));
  executor.advance(at(0.3));
  EXPECT_EQ(ticks.size(), 3u);
  EXPECT_TRUE(log.lines.empty());
  executor.advance(at(1000.05));
  EXPECT_THAT(ticks, ElementsAre(0.1, 0.2, 0.3, 999.8, 999.9, 1000.0));
  EXPECT_EQ(executor.counts().skipped_ticks, 9994u);
  ASSERT_FALSE(log.lines.empty());
  EXPECT_EQ(log.lines[0], "supervisor: decision skip ticks");
}

// ledger: S6-33
TEST(Executor, AStormOfMessagesIsCutAndDoesNotDrownTheOthers) {
  Log log;
  ExecutorConfig config = without_safety_officer();
  config.max_messages = 20;
  const auto echo = [](const Message& m, Time, Outbox& out) {
    if (id_of(m) > 0) {
      out.say(TaskCall{id_of(m), "", {}});
      out.say(TaskCall{id_of(m), "", {}});
    }
  };
  int heard = 0;
  const auto late = [&](const Message& m, Time, Outbox& out) {
    if (id_of(m) > 0 && ++heard == 30) out.say(SafetyAction{SafetyActionKind::kStop, {}, "storm", "a storm"});
  };
  Executor executor(slots(slot("a", echo), slot("b", echo), slot("calm", late)), {}, config, log.recorder());
  executor.on_message(call(1), at(0));
  const std::size_t type = call(0).index();
  EXPECT_EQ(executor.said().at("a").at(type), 20u);
  EXPECT_EQ(executor.said().at("b").at(type), 20u);
  EXPECT_EQ(executor.counts().cut, 2u * 2u * 41u - 40u);  // each answers each of 1 + 40 calls twice
  EXPECT_EQ(executor.helm_state(), HelmState::kStop);
  EXPECT_EQ(std::count(log.lines.begin(), log.lines.end(), "supervisor: decision cut"), 2);
  executor.on_message(call(2), at(0.15));  // after the next tick they may speak again
  EXPECT_EQ(executor.said().at("a").at(type), 40u);
}

// ledger: S6-33
TEST(Executor, AnAgentThatThrowsIsDeadAndTheOthersGoOn) {
  Log log;
  std::vector<std::string> heard;
  int turns = 0;
  const auto fragile = [&](const Message& m, Time, Outbox& out) {
    ++turns;
    out.say(TaskCall{99, "", {}});
    if (id_of(m) == 1) throw std::runtime_error("no such leg");
  };
  std::string why;
  Executor executor(slots(slot("navigator", fragile), slot("captain",
                                                           [&](const Message& m, Time, Outbox&) {
                                                             heard.push_back(test::text_of(m));
                                                             if (const auto* lost = std::get_if<AgentLost>(&m))
                                                               why = lost->why;
                                                           })),
                    {}, without_safety_officer(), log.recorder());
  executor.on_message(call(1), at(0));
  executor.on_message(call(2), at(0));
  EXPECT_EQ(turns, 1);
  EXPECT_TRUE(executor.lost("navigator"));
  EXPECT_FALSE(executor.lost("captain"));
  EXPECT_EQ(why, "no such leg");
  EXPECT_THAT(heard, ElementsAre("task call 1", "agent lost navigator", "task call 2"));
}

// ledger: S6-33
TEST(Executor, AnAgentThatHangsIsGivenUpAfterItsMissedTicks) {
  std::vector<std::string> heard;
  int turns = 0;
  ExecutorConfig config = without_safety_officer();
  config.missed_ticks = 4;
  Executor executor(
      slots(slot(
                "navigator", [&](const Message&, Time, Outbox&) { ++turns; }, [&](Time, Outbox&) { ++turns; }),
            slot("captain", listen(heard))),
      {}, config);
  executor.advance(at(0));
  executor.advance(at(0.1));
  executor.hang("navigator");
  executor.on_message(call(1), at(0.15));
  executor.advance(at(0.4));
  EXPECT_EQ(turns, 1);
  EXPECT_FALSE(executor.lost("navigator"));
  executor.advance(at(0.5));
  EXPECT_TRUE(executor.lost("navigator"));
  EXPECT_EQ(executor.counts().lost, 1u);
  executor.advance(at(3));
  EXPECT_THAT(heard, ElementsAre("task call 1", "agent lost navigator hung"));
}

// ledger: S6-33
TEST(Executor, AnAgentThatIsKilledDiesInItsNextTurn) {
  std::vector<std::string> heard;
  Executor executor(slots(slot("pilot", {}), slot("captain", listen(heard))), {}, without_safety_officer());
  executor.kill("pilot");
  executor.on_message(call(1), at(0));
  EXPECT_THAT(heard, ElementsAre("task call 1", "agent lost pilot"));
}

// ledger: S2-28 S6-33
TEST(Executor, TheVehicleActsOnTheLossOfThoseWhoSteerIt) {
  const auto pilot = [](Time, Outbox& out) { out.say(HelmOrder{{Angle::degrees(30), 5, 1.5, 0}}); };
  for (const bool pilot_hangs : {true, false}) {
    Log log;
    Executor executor(slots(slot("pilot", {}, pilot), slot("safety officer", {})), {}, {}, log.recorder());
    executor.advance(at(0));
    EXPECT_EQ(executor.helm(at(1)).speed, 1.5);
    executor.hang(pilot_hangs ? "pilot" : "safety officer");
    executor.helm(at(1.4));
    EXPECT_EQ(executor.helm_state(), HelmState::kOrders);
    if (pilot_hangs) {
      EXPECT_EQ(executor.helm(at(3)).speed, 1.5);
      EXPECT_EQ(executor.helm(at(3.1)).speed, 0);
      EXPECT_EQ(executor.helm_state(), HelmState::kStop);
      EXPECT_EQ(log.lines.back(), "helm gate: decision stop");
    } else {
      EXPECT_EQ(executor.helm(at(1.6)).depth, 0);  // within one cycle of 0.6 s
      EXPECT_EQ(executor.helm_state(), HelmState::kSurface);
    }
  }
}

// ledger: S6-33
TEST(Executor, TheLossOfTheRecorderIsTold) {
  std::vector<std::string> heard;
  Executor executor(slots(slot("captain", listen(heard))), {}, without_safety_officer(),
                    [](const Envelope&) { throw std::runtime_error("disk full"); });
  executor.on_message(call(1), at(0));
  EXPECT_THAT(heard, ElementsAre("task call 1", "agent lost recorder"));
}

// ledger: S6-32
TEST(Executor, AgentsOfThreeLevelsSpeakAlongTheGraphOfMessages) {
  const auto on = [](std::size_t type, Message answer) {
    return [type, answer](const Message& m, Time, Outbox& out) {
      if (m.index() == type) out.said().push_back(answer);
    };
  };
  std::vector<AgentSlot> all = slots(slot("captain", on(Message(OperatorCommand{}).index(), MissionOrder{})),
                                     slot("executive officer", on(Message(MissionOrder{}).index(), RouteRequest{})),
                                     slot("navigator", on(Message(RouteRequest{}).index(), RoutePlanned{})),
                                     slot("pilot", on(Message(RoutePlanned{}).index(), HelmOrder{})));
  all[0].level = AgentLevel::kSupervisory;
  all[3].level = AgentLevel::kVehicle;
  Executor executor(std::move(all), {}, without_safety_officer());
  executor.on_message(OperatorCommand{}, at(0));
  std::map<std::string, std::string> graph;
  for (const auto& [sender, counts] : executor.said()) {
    for (std::size_t type = 0; type < kMessageTypes; ++type) {
      if (counts.at(type) > 0) graph[sender] += message_name(type);
    }
  }
  const std::map<std::string, std::string> expected = {
      {"sensed", "operator command"}, {"captain", "mission order"}, {"executive officer", "route request"},
      {"navigator", "route planned"}, {"pilot", "helm order"},      {"helm gate", "decision"}};
  EXPECT_EQ(graph, expected);
}

/// Says things that depend on all it has heard, so that any change of order shows.
AgentSlot talker(const std::string& name, std::uint32_t seed) {
  auto state = std::make_shared<std::uint32_t>(seed);
  return slot(
      name,
      [state](const Message& m, Time, Outbox& out) {
        *state = *state * 1664525u + id_of(m) + 1013904223u;
        if ((*state >> 16) % 5 < 2) out.say(TaskCall{*state >> 8, "", {}});
      },
      [state](Time, Outbox& out) {
        if ((*state >> 20) % 2 == 0) out.say(TaskCall{*state >> 9, "", {}});
      });
}

std::vector<std::string> run_talkers(const std::vector<std::uint32_t>& calls) {
  std::vector<std::string> trace;
  Executor executor(
      slots(talker("a", 1), talker("b", 2), talker("c", 3)), {}, without_safety_officer(), [&](const Envelope& e) {
        trace.push_back(fmt::format("{} {} {} {}", e.number, to_seconds(e.time), e.sender, test::text_of(e.message)));
      });
  double t = 0;
  for (const std::uint32_t id : calls) {
    t += 0.001 * (id % 400);
    executor.on_message(call(id), at(t));
    if (id % 97 == 0) executor.hang("b");
    if (id % 101 == 0) executor.kill("c");
  }
  return trace;
}

// ledger: S6-33
RC_GTEST_PROP(Executor, TheSameCallsGiveTheSameEnvelopes, (const std::vector<std::uint32_t>& calls)) {
  RC_ASSERT(run_talkers(calls) == run_talkers(calls));
}

// ledger: S6-33
RC_GTEST_PROP(Executor, EveryLivingAgentHearsExactlyWhatIsRecorded, (const std::vector<std::uint32_t>& calls)) {
  std::vector<std::string> recorded;
  std::vector<std::string> heard;
  Executor executor(slots(talker("a", 4), slot("listener", listen(heard)), talker("b", 5)), {},
                    without_safety_officer(), [&](const Envelope& e) { recorded.push_back(test::text_of(e.message)); });
  double t = 0;
  for (const std::uint32_t id : calls) {
    t += 0.001 * (id % 400);
    executor.on_message(call(id), at(t));
    if (id % 53 == 0) executor.kill("b");
  }
  RC_ASSERT(heard == recorded);
}

TEST(Executor, RefusesSlotsThatMakeNoSense) {
  const auto refusal = [](std::vector<AgentSlot> all, const ExecutorConfig& config) -> std::string {
    try {
      const Executor executor(std::move(all), {}, config);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  const ExecutorConfig none = without_safety_officer();
  EXPECT_THAT(refusal(slots(slot("a", {}), slot("a", {})), none), HasSubstr("'a'"));
  EXPECT_THAT(refusal(slots(slot("", {})), none), HasSubstr("empty"));
  EXPECT_THAT(refusal(slots(slot("helm gate", {})), none), HasSubstr("'helm gate'"));
  EXPECT_THAT(refusal(slots(slot("recorder", {})), none), HasSubstr("'recorder'"));
  EXPECT_THAT(refusal(slots(AgentSlot{"a", AgentLevel::kMission, nullptr}), none), HasSubstr("no agent"));
  EXPECT_THAT(refusal(slots(slot("a", {})), {}), HasSubstr("safety officer"));
  ExecutorConfig no_slot = none;
  no_slot.arbiter.safety_officer = "sensed";
  EXPECT_THAT(refusal(slots(slot("a", {})), no_slot), HasSubstr("'sensed'"));
  EXPECT_EQ(refusal(slots(slot("safety officer", {})), {}), "");
}

TEST(Executor, IsConfiguredByName) {
  ExecutorConfig config;
  std::vector<Section> sections = {{"executor", "", fields(config)}};
  read_toml("[executor]\nmissed_ticks = 7\norder_timeout_s = 1.5\nsafety_officer = \"guard\"\n", "c.toml", sections);
  EXPECT_EQ(config.missed_ticks, 7);
  EXPECT_EQ(config.arbiter.order_timeout_s, 1.5);
  EXPECT_EQ(config.arbiter.safety_officer, "guard");
  EXPECT_THROW(read_toml("[executor]\nmissed_ticks = 0\n", "c.toml", sections), Error);
}

}  // namespace
}  // namespace isobath
