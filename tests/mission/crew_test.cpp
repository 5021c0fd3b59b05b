// The crew in one thread: who hears what when, who is given up, and that it is the same every time.
#include <gmock/gmock.h>
#include <isobath/mission/crew.hpp>
#include <map>
#include <rapidcheck/gtest.h>
#include <stdexcept>
#include <tests/mission/scripted_agent.hpp>

namespace isobath {
namespace {

using test::at;
using test::call;
using test::id_of;
using test::seat;
using test::seats;
using testing::ElementsAre;
using testing::HasSubstr;

CrewConfig without_safety_officer() {
  CrewConfig config;
  config.gate.safety_officer = "";
  config.gate.patience_s = 60;
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
TEST(Crew, MessagesAreHeardByAllInTheOrderInWhichTheyWereSaid) {
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
  Crew crew(seats(seat("a", answering(first, 10)), seat("b", answering(second, 20))), {}, without_safety_officer());
  EXPECT_TRUE(crew.hear(call(1), at(0)));
  const std::vector<std::string> expected = {"task call 1",  "task call 10", "task call 11", "task call 20",
                                             "task call 21", "task call 15", "task call 25"};
  EXPECT_EQ(first, expected);
  EXPECT_EQ(second, expected);
}

TEST(Crew, TicksTenTimesASecondAndBeforeWhatIsSensedLater) {
  std::vector<std::string> events;
  Crew crew(seats(seat(
                "a",
                [&](const Message& m, Time t, Outbox&) {
                  events.push_back(fmt::format("{:.2f} {}", to_seconds(t), test::text_of(m)));
                },
                [&](Time t, Outbox&) { events.push_back(fmt::format("{:.2f} tick", to_seconds(t))); })),
            {}, without_safety_officer());
  crew.hear(call(1), at(5));
  crew.hear(call(2), at(5.1));
  crew.hear(call(3), at(5.25));
  crew.advance(at(5.3));
  crew.advance(at(5.3));
  EXPECT_THAT(events, ElementsAre("5.00 task call 1", "5.10 tick", "5.10 task call 2", "5.20 tick", "5.25 task call 3",
                                  "5.30 tick"));
  EXPECT_EQ(crew.counts().ticks, 3u);
}

TEST(Crew, AllHaveTickedBeforeAnythingThatWasSaidInTheTickIsHeard) {
  std::vector<std::string> events;
  const auto ticking = [&](std::uint32_t id) {
    return seat(
        fmt::format("agent {}", id),
        [&events, id](const Message& m, Time, Outbox&) { events.push_back(fmt::format("{} hears {}", id, id_of(m))); },
        [&events, id](Time, Outbox& out) {
          events.push_back(fmt::format("{} ticks", id));
          out.say(TaskCall{id, "", {}});
        });
  };
  Crew crew(seats(ticking(1), ticking(2)), {}, without_safety_officer());
  crew.advance(at(0));
  crew.advance(at(0.1));
  EXPECT_THAT(events, ElementsAre("1 ticks", "2 ticks", "1 hears 1", "2 hears 1", "1 hears 2", "2 hears 2"));
}

TEST(Crew, AClockThatGoesBackIsRefusedCountedAndToldOnce) {
  Log log;
  std::vector<std::string> heard;
  Crew crew(seats(seat("a", listen(heard))), {}, without_safety_officer(), log.recorder());
  crew.advance(at(10));
  EXPECT_FALSE(crew.hear(call(1), at(9)));
  EXPECT_FALSE(crew.advance(at(9.9)));
  EXPECT_EQ(crew.counts().refused, 2u);
  EXPECT_TRUE(crew.hear(call(2), at(10)));
  EXPECT_FALSE(crew.advance(at(1)));
  EXPECT_THAT(heard, ElementsAre("decision refuse time", "task call 2", "decision refuse time"));
}

TEST(Crew, AJumpAheadSkipsTicksButNotTheLastOnes) {
  Log log;
  std::vector<double> ticks;
  CrewConfig config = without_safety_officer();
  config.most_ticks = 3;
  Crew crew(seats(seat("a", {}, [&](Time t, Outbox&) { ticks.push_back(to_seconds(t)); })), {}, config, log.recorder());
  crew.advance(at(0));
  crew.advance(at(0.3));
  EXPECT_EQ(ticks.size(), 3u);
  EXPECT_TRUE(log.lines.empty());
  crew.advance(at(1000.05));
  EXPECT_THAT(ticks, ElementsAre(0.1, 0.2, 0.3, 999.8, 999.9, 1000.0));
  EXPECT_EQ(crew.counts().skipped_ticks, 9994u);
  ASSERT_FALSE(log.lines.empty());
  EXPECT_EQ(log.lines[0], "supervisor: decision skip ticks");
}

// ledger: S6-33
TEST(Crew, AStormOfMessagesIsCutAndDoesNotDrownTheOthers) {
  Log log;
  CrewConfig config = without_safety_officer();
  config.most_said = 20;
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
  Crew crew(seats(seat("a", echo), seat("b", echo), seat("calm", late)), {}, config, log.recorder());
  crew.hear(call(1), at(0));
  const std::size_t type = call(0).index();
  EXPECT_EQ(crew.said().at("a").at(type), 20u);
  EXPECT_EQ(crew.said().at("b").at(type), 20u);
  EXPECT_EQ(crew.counts().cut, 2u * 2u * 41u - 40u);  // each answers each of 1 + 40 calls twice
  EXPECT_EQ(crew.helm_state(), HelmState::kStop);
  EXPECT_EQ(std::count(log.lines.begin(), log.lines.end(), "supervisor: decision cut"), 2);
  crew.hear(call(2), at(0.15));  // after the next tick they may speak again
  EXPECT_EQ(crew.said().at("a").at(type), 40u);
}

// ledger: S6-33
TEST(Crew, AnAgentThatThrowsIsDeadAndTheOthersGoOn) {
  Log log;
  std::vector<std::string> heard;
  int turns = 0;
  const auto fragile = [&](const Message& m, Time, Outbox& out) {
    ++turns;
    out.say(TaskCall{99, "", {}});
    if (id_of(m) == 1) throw std::runtime_error("no such leg");
  };
  std::string why;
  Crew crew(seats(seat("navigator", fragile), seat("captain",
                                                   [&](const Message& m, Time, Outbox&) {
                                                     heard.push_back(test::text_of(m));
                                                     if (const auto* lost = std::get_if<AgentLost>(&m)) why = lost->why;
                                                   })),
            {}, without_safety_officer(), log.recorder());
  crew.hear(call(1), at(0));
  crew.hear(call(2), at(0));
  EXPECT_EQ(turns, 1);
  EXPECT_TRUE(crew.lost("navigator"));
  EXPECT_FALSE(crew.lost("captain"));
  EXPECT_EQ(why, "no such leg");
  EXPECT_THAT(heard, ElementsAre("task call 1", "agent lost navigator", "task call 2"));
}

// ledger: S6-33
TEST(Crew, AnAgentThatHangsIsGivenUpAfterItsMissedTicks) {
  std::vector<std::string> heard;
  int turns = 0;
  CrewConfig config = without_safety_officer();
  config.missed_ticks = 4;
  Crew crew(seats(seat(
                      "navigator", [&](const Message&, Time, Outbox&) { ++turns; }, [&](Time, Outbox&) { ++turns; }),
                  seat("captain", listen(heard))),
            {}, config);
  crew.advance(at(0));
  crew.advance(at(0.1));
  crew.hang("navigator");
  crew.hear(call(1), at(0.15));
  crew.advance(at(0.4));
  EXPECT_EQ(turns, 1);
  EXPECT_FALSE(crew.lost("navigator"));
  crew.advance(at(0.5));
  EXPECT_TRUE(crew.lost("navigator"));
  EXPECT_EQ(crew.counts().lost, 1u);
  crew.advance(at(3));
  EXPECT_THAT(heard, ElementsAre("task call 1", "agent lost navigator hung"));
}

// ledger: S6-33
TEST(Crew, AnAgentThatIsKilledDiesInItsNextTurn) {
  std::vector<std::string> heard;
  Crew crew(seats(seat("pilot", {}), seat("captain", listen(heard))), {}, without_safety_officer());
  crew.kill("pilot");
  crew.hear(call(1), at(0));
  EXPECT_THAT(heard, ElementsAre("task call 1", "agent lost pilot"));
}

// ledger: S2-28 S6-33
TEST(Crew, TheVehicleActsOnTheLossOfThoseWhoSteerIt) {
  const auto pilot = [](Time, Outbox& out) { out.say(HelmOrder{{Angle::degrees(30), 5, 1.5, 0}}); };
  for (const bool pilot_hangs : {true, false}) {
    Log log;
    Crew crew(seats(seat("pilot", {}, pilot), seat("safety officer", {})), {}, {}, log.recorder());
    crew.advance(at(0));
    EXPECT_EQ(crew.helm(at(1)).speed, 1.5);
    crew.hang(pilot_hangs ? "pilot" : "safety officer");
    crew.helm(at(1.4));
    EXPECT_EQ(crew.helm_state(), HelmState::kOrders);
    if (pilot_hangs) {
      EXPECT_EQ(crew.helm(at(3)).speed, 1.5);
      EXPECT_EQ(crew.helm(at(3.1)).speed, 0);
      EXPECT_EQ(crew.helm_state(), HelmState::kStop);
      EXPECT_EQ(log.lines.back(), "helm gate: decision stop");
    } else {
      EXPECT_EQ(crew.helm(at(1.6)).depth, 0);  // within one cycle of 0.6 s
      EXPECT_EQ(crew.helm_state(), HelmState::kSurface);
    }
  }
}

// ledger: S6-33
TEST(Crew, TheLossOfTheRecorderIsTold) {
  std::vector<std::string> heard;
  Crew crew(seats(seat("captain", listen(heard))), {}, without_safety_officer(),
            [](const Envelope&) { throw std::runtime_error("disk full"); });
  crew.hear(call(1), at(0));
  EXPECT_THAT(heard, ElementsAre("task call 1", "agent lost recorder"));
}

// ledger: S6-32
TEST(Crew, AgentsOfThreeLevelsSpeakAlongTheGraphOfMessages) {
  const auto on = [](std::size_t type, Message answer) {
    return [type, answer](const Message& m, Time, Outbox& out) {
      if (m.index() == type) out.said().push_back(answer);
    };
  };
  std::vector<Seat> all = seats(seat("captain", on(Message(OperatorCommand{}).index(), MissionOrder{})),
                                seat("executive officer", on(Message(MissionOrder{}).index(), RouteRequest{})),
                                seat("navigator", on(Message(RouteRequest{}).index(), RoutePlanned{})),
                                seat("pilot", on(Message(RoutePlanned{}).index(), HelmOrder{})));
  all[0].level = AgentLevel::kSupervisory;
  all[3].level = AgentLevel::kVehicle;
  Crew crew(std::move(all), {}, without_safety_officer());
  crew.hear(OperatorCommand{}, at(0));
  std::map<std::string, std::string> graph;
  for (const auto& [sender, counts] : crew.said()) {
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
Seat talker(const std::string& name, std::uint32_t seed) {
  auto state = std::make_shared<std::uint32_t>(seed);
  return seat(
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
  Crew crew(
      seats(talker("a", 1), talker("b", 2), talker("c", 3)), {}, without_safety_officer(), [&](const Envelope& e) {
        trace.push_back(fmt::format("{} {} {} {}", e.number, to_seconds(e.time), e.sender, test::text_of(e.message)));
      });
  double t = 0;
  for (const std::uint32_t id : calls) {
    t += 0.001 * (id % 400);
    crew.hear(call(id), at(t));
    if (id % 97 == 0) crew.hang("b");
    if (id % 101 == 0) crew.kill("c");
  }
  return trace;
}

// ledger: S6-33
RC_GTEST_PROP(Crew, TheSameCallsGiveTheSameEnvelopes, (const std::vector<std::uint32_t>& calls)) {
  RC_ASSERT(run_talkers(calls) == run_talkers(calls));
}

// ledger: S6-33
RC_GTEST_PROP(Crew, EveryLivingAgentHearsExactlyWhatIsRecorded, (const std::vector<std::uint32_t>& calls)) {
  std::vector<std::string> recorded;
  std::vector<std::string> heard;
  Crew crew(seats(talker("a", 4), seat("listener", listen(heard)), talker("b", 5)), {}, without_safety_officer(),
            [&](const Envelope& e) { recorded.push_back(test::text_of(e.message)); });
  double t = 0;
  for (const std::uint32_t id : calls) {
    t += 0.001 * (id % 400);
    crew.hear(call(id), at(t));
    if (id % 53 == 0) crew.kill("b");
  }
  RC_ASSERT(heard == recorded);
}

TEST(Crew, RefusesSeatsThatMakeNoSense) {
  const auto refusal = [](std::vector<Seat> all, const CrewConfig& config) -> std::string {
    try {
      const Crew crew(std::move(all), {}, config);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  const CrewConfig none = without_safety_officer();
  EXPECT_THAT(refusal(seats(seat("a", {}), seat("a", {})), none), HasSubstr("'a'"));
  EXPECT_THAT(refusal(seats(seat("", {})), none), HasSubstr("empty"));
  EXPECT_THAT(refusal(seats(seat("helm gate", {})), none), HasSubstr("'helm gate'"));
  EXPECT_THAT(refusal(seats(seat("recorder", {})), none), HasSubstr("'recorder'"));
  EXPECT_THAT(refusal(seats(Seat{"a", AgentLevel::kMission, nullptr}), none), HasSubstr("no agent"));
  EXPECT_THAT(refusal(seats(seat("a", {})), {}), HasSubstr("safety officer"));
  CrewConfig no_seat = none;
  no_seat.gate.safety_officer = "sensed";
  EXPECT_THAT(refusal(seats(seat("a", {})), no_seat), HasSubstr("'sensed'"));
  EXPECT_EQ(refusal(seats(seat("safety officer", {})), {}), "");
}

TEST(Crew, IsConfiguredByName) {
  CrewConfig config;
  std::vector<Section> sections = {{"crew", "", fields(config)}};
  read_toml("[crew]\nmissed_ticks = 7\norder_patience = 1.5\nsafety_officer = \"guard\"\n", "c.toml", sections);
  EXPECT_EQ(config.missed_ticks, 7);
  EXPECT_EQ(config.gate.patience_s, 1.5);
  EXPECT_EQ(config.gate.safety_officer, "guard");
  EXPECT_THROW(read_toml("[crew]\nmissed_ticks = 0\n", "c.toml", sections), Error);
}

}  // namespace
}  // namespace isobath
