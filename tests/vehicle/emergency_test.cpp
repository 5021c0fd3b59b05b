// Emergency bits and the evaluator that raises them.
#include <atomic>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/vehicle/emergency_flags.hpp>
#include <isobath/vehicle/state_evaluator.hpp>
#include <tests/support/count_allocations.hpp>
#include <thread>

namespace isobath {
namespace {

Time at(double s) { return Time{seconds(s)}; }

// ledger: S1-43
TEST(EmergencyFlags, ABitIsUpWhileItsCauseLasts) {
  EmergencyFlags flags;
  EXPECT_EQ(flags.snapshot().raised, 0u);
  flags.set(Emergency::kLowFuel, at(1));
  EXPECT_TRUE(flags.snapshot().has(Emergency::kLowFuel));
  EXPECT_EQ(flags.snapshot().raised, 1u);
  flags.clear(Emergency::kLowFuel);
  EXPECT_EQ(flags.snapshot().raised, 0u);
}

// ledger: S1-43
TEST(EmergencyFlags, ALatchedBitStaysUntilAcknowledged) {
  EmergencyFlags flags;
  flags.set(Emergency::kLeak, at(1));
  flags.acknowledge(bit(Emergency::kLeak));
  EXPECT_TRUE(flags.snapshot().has(Emergency::kLeak)) << "the water is still inside";
  flags.clear(Emergency::kLeak);
  EXPECT_FALSE(flags.snapshot().has(Emergency::kLeak)) << "acknowledged before";

  flags.set(Emergency::kLeak, at(2));
  flags.clear(Emergency::kLeak);
  EXPECT_EQ(flags.snapshot(), (EmergencyFlags::Snapshot{bit(Emergency::kLeak), 0, bit(Emergency::kLeak)}));
  flags.acknowledge(~bit(Emergency::kLeak));
  EXPECT_TRUE(flags.snapshot().has(Emergency::kLeak));
  flags.acknowledge(bit(Emergency::kLeak));
  EXPECT_EQ(flags.snapshot().raised, 0u);
}

// ledger: S1-43
TEST(EmergencyFlags, EachBeginningOfACauseIsToBeAcknowledged) {
  EmergencyFlags flags;
  const auto waits = [&] { return (flags.snapshot().unacknowledged & bit(Emergency::kImminentCollision)) != 0; };
  flags.set(Emergency::kImminentCollision, at(1));
  flags.clear(Emergency::kImminentCollision);
  EXPECT_TRUE(waits()) << "it is over, and nobody has seen it";
  flags.acknowledge(~0U);
  EXPECT_FALSE(waits());
  flags.set(Emergency::kImminentCollision, at(2));
  EXPECT_TRUE(waits());
  flags.acknowledge(~0U);
  flags.set(Emergency::kImminentCollision, at(3));
  EXPECT_FALSE(waits()) << "the same cause goes on";
}

// ledger: S1-43
TEST(EmergencyFlags, BitsWithoutANameAreKept) {
  EmergencyFlags flags(1U << 31 | 1U << 17);
  flags.set(0x8002'0100U, at(5));
  flags.set(Emergency::kLeak, at(6));
  flags.clear(~0U);
  EXPECT_EQ(flags.snapshot().raised, 0x8002'0000U);
  EXPECT_EQ(flags.first_raise(31), at(5));
  EXPECT_EQ(name_of_emergency(31), nullptr);
  EXPECT_STREQ(name_of_emergency(3), "imminent collision");
}

// ledger: S1-43
TEST(EmergencyFlags, TheTimeIsThatOfTheFirstRaise) {
  EmergencyFlags flags;
  EXPECT_EQ(flags.first_raise(Emergency::kLeak), std::nullopt);
  flags.set(Emergency::kLeak, at(2));
  flags.set(Emergency::kLeak, at(3));
  flags.clear(Emergency::kLeak);
  flags.set(Emergency::kLeak, at(4));
  EXPECT_EQ(flags.first_raise(Emergency::kLeak), at(2));
}

// Every bit reaches an executor on another thread within its next look, with its time. ledger: S1-43
TEST(EmergencyFlags, ABitRaisedInOneThreadIsSeenInAnother) {
  EmergencyFlags flags;
  std::atomic<int> raised{-1}, seen{-1};
  std::thread sensor([&] {
    for (int i = 0; i < 32; ++i) {
      flags.set(1U << i, at(i));
      raised = i;
      while (seen < i) std::this_thread::yield();
    }
  });
  for (int i = 0; i < 32; ++i) {
    while (raised < i) std::this_thread::yield();
    const std::uint32_t up = flags.snapshot().raised;
    EXPECT_EQ(up, i == 31 ? ~0U : (1U << (i + 1)) - 1);
    EXPECT_EQ(flags.first_raise(i), at(i));
    seen = i;
  }
  sensor.join();
}

// Threads that set, clear and acknowledge other bits lose nothing of each other. ledger: S1-43
TEST(EmergencyFlags, ManyThreadsDisturbNoOthersBits) {
  EmergencyFlags flags(0xf0f0f0f0U);
  std::vector<std::thread> threads;
  for (std::uint32_t k = 0; k < 4; ++k) {
    threads.emplace_back([&flags, k] {
      const std::uint32_t mine = 0xffU << (8 * k);
      for (int i = 0; i < 2000; ++i) {
        flags.set(mine, at(i));
        if (i == 1999) return;
        flags.clear(mine);
        flags.acknowledge(mine);
        EXPECT_EQ(flags.snapshot().raised & mine, 0u);
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(flags.snapshot().raised, ~0U);
}

const std::vector<WatchedModule> kModules = {
    {"mapper", seconds(0.6)}, {"pilot", seconds(0.6)}, {"planner", seconds(60)}};

// ledger: S1-05
TEST(StateEvaluator, ASilentModuleIsLostWithinKCyclesAndWellAgainWithItsNextBeat) {
  StateEvaluator evaluator({}, kModules, at(0));
  EmergencyFlags flags;
  int lost_at = -1, well_at = -1;
  for (int cycle = 1; cycle <= 30; ++cycle) {
    const Time now{cycle * seconds(0.6)};
    evaluator.beat(0, now);
    if (cycle <= 10 || cycle >= 20) evaluator.beat(1, now);
    const auto table = evaluator.evaluate(now, flags);
    EXPECT_EQ(table[0].state, HealthState::kOk);
    EXPECT_EQ(table[2].state, HealthState::kOk);  // slow by design: 18 s of its 180
    const bool lost = table[1].state == HealthState::kLost;
    EXPECT_EQ(flags.snapshot().has(Emergency::kModuleFailure), lost);
    if (lost && lost_at < 0) lost_at = cycle;
    if (!lost && lost_at > 0 && well_at < 0) well_at = cycle;
  }
  EXPECT_EQ(lost_at, 14);  // three periods after the last beat are allowed, a fourth is not
  EXPECT_EQ(well_at, 20);
}

// ledger: S1-05
TEST(StateEvaluator, AModuleThatNeverStartsIsLost) {
  StateEvaluator evaluator({}, kModules, at(100));
  EmergencyFlags flags;
  EXPECT_EQ(evaluator.evaluate(at(101), flags)[0].state, HealthState::kOk);
  EXPECT_EQ(evaluator.evaluate(at(102), flags)[0].state, HealthState::kLost);
  EXPECT_NEAR(evaluator.evaluate(at(103), flags)[0].periods_silent, 5, 1e-9);
  evaluator.beat(0, at(103));
  evaluator.beat(0, at(90));  // out of order
  EXPECT_EQ(evaluator.evaluate(at(103), flags)[0].state, HealthState::kOk);
  EXPECT_THROW(StateEvaluator({}, {{"x", Duration(0)}}, at(0)), Error);
}

// ledger: S1-05 S1-43
TEST(StateEvaluator, HealthReportsBecomeBits) {
  StateEvaluator evaluator({}, {}, at(0));
  EmergencyFlags flags;
  const auto raised = [&](const Health& report) {
    evaluator.on_health(report);
    evaluator.evaluate(report.time, flags);
    return flags.snapshot().raised;
  };
  EXPECT_EQ(raised({at(1), "vehicle", HealthState::kOk, 0.9F, false, ""}), 0u);
  EXPECT_EQ(raised({at(2), "vehicle", HealthState::kOk, 0.1F, false, ""}), bit(Emergency::kLowFuel));
  EXPECT_EQ(raised({at(3), "vehicle", HealthState::kOk, NAN, false, ""}), bit(Emergency::kLowFuel));
  EXPECT_EQ(raised({at(1), "vehicle", HealthState::kOk, 0.9F, false, ""}), bit(Emergency::kLowFuel)) << "late";
  EXPECT_EQ(raised({at(4), "vehicle", HealthState::kOk, 0.9F, false, ""}), 0u);
  EXPECT_EQ(raised({at(5), "sonar", HealthState::kLost, 1, false, ""}), bit(Emergency::kSensorFailure));
  EXPECT_EQ(raised({at(6), "sonar", HealthState::kDegraded, 1, false, ""}), 0u);
  EXPECT_EQ(raised({at(7), "vehicle", HealthState::kOk, 0.9F, true, ""}), bit(Emergency::kLeak));
  EXPECT_EQ(raised({at(8), "vehicle", HealthState::kOk, 0.9F, false, ""}), bit(Emergency::kLeak)) << "latched";
  flags.acknowledge(~0U);
  EXPECT_EQ(raised({at(9), "vehicle", HealthState::kLost, 0.9F, false, ""}), bit(Emergency::kModuleFailure));
  EXPECT_EQ(evaluator.reports().size(), 2u);
}

TEST(StateEvaluator, WatchingAllocatesNothing) {
  StateEvaluator evaluator({}, kModules, at(0));
  EmergencyFlags flags;
  const std::uint64_t before = test::allocations();
  for (int i = 0; i < 10; ++i) {
    evaluator.beat(1, at(i));
    evaluator.evaluate(at(i), flags);
  }
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath
