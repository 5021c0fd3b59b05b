// The table of faults: whole, in order, and what its page says.
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/mission/safety/fault_table.hpp>
#include <set>
#include <sstream>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(FaultTable, HasEveryFaultOnceAndInOrder) {
  ASSERT_EQ(fault_table().size(), kFaults);
  std::set<std::string> names;
  for (std::size_t i = 0; i < kFaults; ++i) {
    const FaultRow& row = fault_table()[i];
    EXPECT_EQ(static_cast<std::size_t>(row.fault), i) << row.name;
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_STRNE(row.noticed, "");
    EXPECT_STRNE(row.injected, "");
    EXPECT_EQ(&row_of(row.fault), &row);
  }
}

TEST(FaultTable, LimitsAreSettingsOrLimitsOfAMission) {
  SafetyConfig config;
  std::set<std::string> known = {"max_position_sigma_m", "max_depth_m", "min_altitude_m", "low_battery_share",
                                 "max_duration_s"};
  for (const Field& field : fields(config)) EXPECT_TRUE(known.insert(field.name()).second) << field.name();
  for (const FaultRow& row : fault_table()) {
    for (const char* limit : row.limits) EXPECT_TRUE(known.contains(limit)) << row.name << ": " << limit;
    EXPECT_EQ(row.later == SafetyActionKind::kNone, row.later_after.when == After::When::kNever) << row.name;
  }
}

TEST(FaultTable, EveryRowHasATestThatExists) {
  std::string all;
  for (const char* file : {"safety_officer_test.cpp", "last_ditch_test.cpp"}) {
    all += text_of(test::source_folder() / "tests/mission" / file);
  }
  for (const FaultRow& row : fault_table()) {
    const std::string name = row.test;
    const auto dot = name.find('.');
    ASSERT_NE(dot, std::string::npos) << row.name;
    EXPECT_THAT(all, testing::HasSubstr("TEST(" + name.substr(0, dot) + ", " + name.substr(dot + 1) + ")")) << row.name;
  }
}

TEST(FaultTable, ThePageIsWhatTheProgramActsBy) {
  const std::string page = fault_page({});
  const auto written = test::scratch_folder() / "faults.md";
  std::ofstream(written) << page;
  EXPECT_TRUE(text_of(test::source_folder() / "docs/faults.md") == page) << "copy " << written << " to docs/faults.md";
}

}  // namespace
}  // namespace isobath
