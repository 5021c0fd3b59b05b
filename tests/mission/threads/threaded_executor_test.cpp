// Agents in threads of their own. Threads meet at latches and when all is settled, never by waiting for a time; the
// clock is the test's.
#include <atomic>
#include <gmock/gmock.h>
#include <isobath/mission/command/threaded_executor.hpp>
#include <latch>
#include <mutex>
#include <stdexcept>
#include <tests/mission/scripted_agent.hpp>
#include <thread>

namespace isobath::threaded_executor_test {
namespace {

using test::at;
using test::call;
using test::id_of;
using test::slot;
using test::slots;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

ExecutorConfig config_of(int mailbox = 1024) {
  ExecutorConfig config;
  config.arbiter.safety_officer = "";
  config.mailbox = mailbox;
  return config;
}

/// A clock that any thread reads and the test sets.
struct Clock {
  std::atomic<std::int64_t> ns = 0;
  void set(double s) { ns = seconds(s).count(); }
  std::function<Time()> reader() {
    return [this] { return Time(Duration(ns.load())); };
  }
};

/// What was heard; written by one thread at a time, read when all is settled.
struct Heard {
  mutable std::mutex mutex;
  std::vector<std::string> lines;
  void add(const std::string& line) {
    const std::lock_guard lock(mutex);
    lines.push_back(line);
  }
  [[nodiscard]] std::vector<std::string> all() const {
    const std::lock_guard lock(mutex);
    return lines;
  }
  test::ScriptedAgent::Hear listener() {
    return [this](const Message& m, Time, Outbox&) { add(test::text_of(m)); };
  }
};

/// An agent that is stuck in its turn on call 1 until it is let go; tells when what it says then is released, and when
/// it is gone.
struct Stuck {
  std::latch released{1};
  std::latch in{1};
  std::latch go{1};
  std::latch gone{1};
  struct Farewell {
    std::latch& gone;
    explicit Farewell(std::latch& l) : gone(l) {}
    Farewell(const Farewell&) = delete;
    Farewell& operator=(const Farewell&) = delete;
    ~Farewell() { gone.count_down(); }
  };
  AgentSlot in_slot(const std::string& name) {
    return slot(name, [this, farewell = std::make_shared<Farewell>(gone)](const Message& m, Time, Outbox& out) {
      if (id_of(m) != 1) return;
      in.count_down();
      go.wait();
      out.say(ChartedHazards{{new std::vector<Hazard>, [this](const std::vector<Hazard>* said) {
                                delete said;
                                released.count_down();
                              }}});
    });
  }
};

// ledger: S6-33
TEST(ThreadedExecutor, AllHearTheSameInOneOrderWhicheverThreadSaysIt) {
  Clock clock;
  Heard recorded;
  Heard first;
  Heard second;
  ExecutorConfig config = config_of();
  config.max_messages = 1000;
  ThreadedExecutor executor(slots(slot("a", first.listener()), slot("b", second.listener()),
                                  slot("c",
                                       [](const Message& m, Time, Outbox& out) {
                                         if (id_of(m) > 0 && id_of(m) < 1000)
                                           out.say(TaskCall{id_of(m) + 1000, "", {}});
                                       })),
                            {}, config, clock.reader(),
                            [&](const Envelope& e) { recorded.add(test::text_of(e.message)); });
  std::vector<std::thread> senders;
  for (std::uint32_t sender = 0; sender < 3; ++sender) {
    senders.emplace_back([&executor, sender] {
      for (std::uint32_t i = 1; i <= 100; ++i) executor.on_message(call(sender * 200 + i), {});
    });
  }
  for (std::thread& sender : senders) sender.join();
  executor.settle();
  EXPECT_EQ(recorded.all().size(), 600u);
  EXPECT_EQ(first.all(), recorded.all());
  EXPECT_EQ(second.all(), recorded.all());
  EXPECT_EQ(executor.said().at("c").at(call(0).index()), 300u);
}

// ledger: S2-12 S6-33
TEST(ThreadedExecutor, ABlockedAgentDelaysNoOtherAndIsGivenUp) {
  Clock clock;
  Heard heard;
  Stuck stuck;
  {
    std::latch answered(1);
    std::latch went_on(1);
    const auto other = [&](const Message& m, Time, Outbox& out) {
      heard.add(test::text_of(m));
      if (id_of(m) == 2) out.say(TaskCall{7, "", {}});
      if (id_of(m) == 7) answered.count_down();
      if (id_of(m) == 3) went_on.count_down();
    };
    ThreadedExecutor executor(slots(stuck.in_slot("planner"), slot("other planner", other)), {}, config_of(),
                              clock.reader());
    executor.on_message(call(1), {});
    stuck.in.wait();
    executor.on_message(call(2), {});
    answered.wait();  // while the planner is stuck
    clock.set(0.4);
    executor.on_message(call(3), {});
    went_on.wait();  // a turn that began at 0.4 s
    clock.set(0.5);
    executor.advance();
    EXPECT_FALSE(executor.lost("planner"));
    clock.set(0.51);
    executor.advance();
    EXPECT_TRUE(executor.lost("planner"));
    executor.settle();
    EXPECT_THAT(heard.all(), Contains("agent lost planner hung"));
    EXPECT_EQ(executor.counts().lost, 1u);
    executor.on_message(call(4), {});
    executor.settle();
    EXPECT_EQ(heard.all().back(), "task call 4");
    EXPECT_EQ(executor.said().count("planner"), 0u);
  }  // the executor does not wait for it
  stuck.go.count_down();
  stuck.gone.wait();  // and it ends in peace when it comes back
}

// ledger: S6-33
TEST(ThreadedExecutor, WhatAnAgentSaysAfterItWasGivenUpIsNotHeard) {
  Clock clock;
  Heard heard;
  Stuck stuck;
  ThreadedExecutor executor(slots(stuck.in_slot("planner"), slot("a", heard.listener())), {}, config_of(),
                            clock.reader());
  executor.on_message(call(1), {});
  stuck.in.wait();
  clock.set(0.4);
  executor.on_message(call(2), {});
  while (heard.all().size() < 2) std::this_thread::yield();
  clock.set(0.51);
  executor.advance();
  stuck.go.count_down();
  stuck.released.wait();  // what it has said is no more
  executor.settle();
  EXPECT_TRUE(executor.lost("planner"));
  EXPECT_FALSE(executor.lost("a"));
  EXPECT_THAT(heard.all(), ElementsAre("task call 1", "task call 2", "agent lost planner hung"));
}

// ledger: S6-33
TEST(ThreadedExecutor, TheDestructorGivesUpWhatTheWatchdogWould) {
  Clock clock;
  Stuck stuck;
  {
    ThreadedExecutor executor(slots(stuck.in_slot("planner")), {}, config_of(),
                              [&] { return Time(Duration(clock.ns += 50'000'000)); });  // runs on whenever it is read
    executor.on_message(call(1), {});
    stuck.in.wait();
  }
  stuck.go.count_down();
  stuck.gone.wait();
}

// ledger: S6-33
TEST(ThreadedExecutor, AnAgentThatThrowsIsDeadAndTheOthersGoOn) {
  Clock clock;
  Heard heard;
  ThreadedExecutor executor(
      slots(slot("navigator", [](const Message&, Time, Outbox&) { throw std::runtime_error("bad leg"); }),
            slot("captain", heard.listener())),
      {}, config_of(), clock.reader());
  executor.on_message(call(1), {});
  executor.settle();
  executor.on_message(call(2), {});
  executor.settle();
  EXPECT_TRUE(executor.lost("navigator"));
  EXPECT_FALSE(executor.lost("captain"));
  EXPECT_THAT(heard.all(), ElementsAre("task call 1", "agent lost navigator", "task call 2"));
}

// ledger: S6-33
TEST(ThreadedExecutor, OneThatIsKilledDiesInItsNextTurn) {
  Clock clock;
  Heard killed;
  Heard heard;
  ThreadedExecutor executor(slots(slot("navigator", killed.listener()), slot("captain", heard.listener())), {},
                            config_of(), clock.reader());
  executor.on_message(call(1), {});
  executor.settle();
  executor.kill("navigator");
  executor.on_message(call(2), {});
  executor.settle();
  EXPECT_TRUE(executor.lost("navigator"));
  EXPECT_THAT(killed.all(), ElementsAre("task call 1"));
  EXPECT_THAT(heard.all(), ElementsAre("task call 1", "task call 2", "agent lost navigator"));
  EXPECT_TRUE(executor.has("captain"));
  EXPECT_FALSE(executor.has("parrot"));
}

// ledger: S6-33
TEST(ThreadedExecutor, OneThatIsMadeToHangIsGivenUpAndKeepsNobodyWaiting) {
  Clock clock;
  Heard hanging;
  Heard heard;
  ThreadedExecutor executor(slots(slot("navigator", hanging.listener()), slot("captain", heard.listener())), {},
                            config_of(), clock.reader());
  executor.hang("navigator");
  executor.on_message(call(1), {});
  executor.settle();
  EXPECT_THAT(heard.all(), ElementsAre("task call 1")) << "settling does not wait for it";
  for (double t = 0.1; !executor.lost("navigator"); t += 0.1) {  // whenever its thread begins the turn that never ends
    clock.set(t);
    executor.advance();
    std::this_thread::yield();
  }
  executor.on_message(call(2), {});
  executor.settle();
  EXPECT_FALSE(executor.lost("captain"));
  EXPECT_THAT(heard.all(), ElementsAre("task call 1", "agent lost navigator hung", "task call 2"));
  EXPECT_THAT(hanging.all(), IsEmpty());
}

TEST(ThreadedExecutor, AFullMailboxLosesItsOldestMessageAndSaysSo) {
  Clock clock;
  Heard slow;
  Heard other;
  std::latch in(1);
  std::latch go(1);
  ThreadedExecutor executor(slots(slot("slow",
                                       [&](const Message& m, Time, Outbox&) {
                                         slow.add(test::text_of(m));
                                         if (id_of(m) != 1) return;
                                         in.count_down();
                                         go.wait();
                                       }),
                                  slot("other", other.listener())),
                            {}, config_of(16), clock.reader());
  executor.on_message(call(1), {});
  in.wait();
  for (std::uint32_t id = 2; id <= 31; ++id) {
    executor.on_message(call(id), {});
    if (id % 8 == 0) {
      while (other.all().size() < id) std::this_thread::yield();  // only one mailbox is to be full
    }
  }
  go.count_down();
  executor.settle();
  // The one that it was busy with, and a full mailbox; the notice came with the first that found it full.
  std::vector<std::string> expected = {"task call 1", "task call 17", "task call 18", "decision drop messages"};
  for (int id = 19; id <= 31; ++id) expected.push_back(fmt::format("task call {}", id));
  EXPECT_EQ(slow.all(), expected);
  EXPECT_EQ(executor.counts().overflow, 30u + 1u - 16u);
  EXPECT_THAT(other.all(), Contains("decision drop messages").Times(1));
}

TEST(ThreadedExecutor, NoMoreThanOneTickWaits) {
  Clock clock;
  std::atomic<int> ticks = 0;
  std::latch in(1);
  std::latch go(1);
  ThreadedExecutor executor(slots(slot(
                                "a",
                                [&](const Message&, Time, Outbox&) {
                                  in.count_down();
                                  go.wait();
                                },
                                [&](Time, Outbox&) { ++ticks; })),
                            {}, config_of(), clock.reader());
  executor.on_message(call(1), {});
  in.wait();
  for (const double t : {0.1, 0.2, 0.3}) {
    clock.set(t);
    executor.advance();
  }
  go.count_down();
  executor.settle();
  EXPECT_EQ(ticks, 1);
  EXPECT_EQ(executor.counts().ticks, 3u);
  EXPECT_EQ(executor.counts().skipped_ticks, 2u);
}

TEST(ThreadedExecutor, AStormOfMessagesIsCut) {
  Clock clock;
  ExecutorConfig config = config_of();
  config.max_messages = 20;
  const auto echo = [](const Message& m, Time, Outbox& out) {
    if (id_of(m) > 0) out.say(TaskCall{id_of(m), "", {}});
  };
  ThreadedExecutor executor(slots(slot("a", echo), slot("b", echo)), {}, config, clock.reader());
  executor.on_message(call(1), {});
  executor.settle();
  EXPECT_EQ(executor.said().at("a").at(call(0).index()), 20u);
  EXPECT_EQ(executor.said().at("b").at(call(0).index()), 20u);
  EXPECT_EQ(executor.counts().cut, 2u * 41u - 40u);
}

// ledger: S6-33
TEST(ThreadedExecutor, TheVehicleActsOnTheLossOfThePilot) {
  Clock clock;
  ThreadedExecutor executor(slots(slot(
                                "pilot",
                                [](const Message& m, Time, Outbox&) {
                                  if (id_of(m) == 1) throw std::runtime_error("no bearing");
                                },
                                [](Time, Outbox& out) {
                                  out.say(HelmOrder{{Angle::degrees(30), 5, 1.5, 0}});
                                })),
                            {}, config_of(), clock.reader());
  executor.helm();
  clock.set(0.1);
  executor.helm();
  executor.settle();
  EXPECT_EQ(executor.helm().speed, 1.5);
  executor.on_message(call(1), {});
  executor.settle();
  clock.set(2.1);
  EXPECT_EQ(executor.helm().speed, 1.5);
  clock.set(2.2);
  EXPECT_EQ(executor.helm().speed, 0);
}

TEST(ThreadedExecutor, AClockThatGoesBackStandsStill) {
  Clock clock;
  Heard times;
  ThreadedExecutor executor(
      slots(slot("a", [&](const Message&, Time t, Outbox&) { times.add(fmt::format("{}", to_seconds(t))); })), {},
      config_of(), clock.reader());
  clock.set(5);
  executor.on_message(call(1), {});
  executor.settle();
  clock.set(3);
  executor.on_message(call(2), {});
  executor.settle();
  EXPECT_THAT(times.all(), ElementsAre("5", "5"));
  EXPECT_GT(executor.counts().refused, 0u);
}

TEST(ThreadedExecutor, RefusesSlotsThatMakeNoSense) {
  Clock clock;
  EXPECT_THROW(ThreadedExecutor(slots(slot("a", {}), slot("a", {})), {}, config_of(), clock.reader()), Error);
}

}  // namespace
}  // namespace isobath::threaded_executor_test
