// The timing table of the levels of command, and its rules.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/mission/plan/timing_table.hpp>

namespace isobath {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

LevelTiming& level(TimingTable& table, CommandLevel level) { return table.levels[static_cast<std::size_t>(level)]; }

std::string refusal(const TimingTable& table) {
  try {
    check_timing(table);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

// The 18 values of Herman 1988, with 60 min for the horizon of the group. ledger: S2-38 S2-E01 S2-E02
TEST(TimingTable, IsThatOfThePaperUnlessItIsSet) {
  const TimingTable table;
  EXPECT_THAT(check_timing(table), IsEmpty());
  const double replan_s[] = {1800, 300, 60, 10, 2, 0.6}, horizon_s[] = {7200, 3600, 600, 120, 20, 4};
  for (std::size_t i = 0; i < kCommandLevels; ++i) {
    EXPECT_EQ(table.levels[i].replan_s, replan_s[i]);
    EXPECT_EQ(table.levels[i].horizon_s, horizon_s[i]);
  }
  EXPECT_EQ(table.input_s(CommandLevel::kMove), 60);
  EXPECT_EQ(table.input_s(CommandLevel::kServo), 2);
}

// ledger: S2-38 S2-E01
TEST(TimingTable, AcceptsTheHorizonThatThePaperPrintsForTheGroupAndSaysThatItDeparts) {
  TimingTable table;
  level(table, CommandLevel::kGroup).horizon_s = 3000;
  EXPECT_THAT(check_timing(table), ElementsAre(HasSubstr("group level reach 3000 s ahead, 3600 s by the rule")));
}

// ledger: S2-38 S2-E03
TEST(TimingTable, SaysWhereALevelPlansMuchMoreOftenThanTheOneAbove) {
  TimingTable table;
  level(table, CommandLevel::kVehicle).replan_s = 30;
  level(table, CommandLevel::kMove).horizon_s = 60;
  EXPECT_THAT(check_timing(table),
              ElementsAre(HasSubstr("the vehicle level plans 10 times as often as the group level")));
}

// ledger: S2-38 S2-41
TEST(TimingTable, RefusesPlansThatEndBeforeTheNextCommandComes) {
  TimingTable table;
  level(table, CommandLevel::kMove).horizon_s = 59;
  EXPECT_THAT(refusal(table), HasSubstr("a plan of the move level ends after 59 s, before the next command comes"));
}

// ledger: S2-38
TEST(TimingTable, RefusesALevelThatPlansNoMoreOftenThanTheOneAbove) {
  TimingTable table;
  level(table, CommandLevel::kPrimitive) = {10, 20};
  EXPECT_THAT(refusal(table), HasSubstr("the primitive level plans every 10 s, no more often than the move level"));
}

}  // namespace
}  // namespace isobath
