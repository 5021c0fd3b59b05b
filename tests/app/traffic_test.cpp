// `isobath traffic`: what it prints and writes, and what it refuses.
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using testing::HasSubstr;

// ledger: S3-D01
TEST(Traffic, PrintsARowForEachMethodAndDrawsARun) {
  const auto folder = test::scratch_folder();
  const std::vector<std::string> scenes = {"traffic", "--bodies", "20", "--speed",      "0.5",
                                           "--runs",  "3",        "-o", folder.string()};
  const auto text = test::isobath(scenes);
  EXPECT_EQ(text.exit_code, 0) << text.err;
  for (const char* method : {"planner", "orca", "orca_full", "straight"}) EXPECT_THAT(text.out, HasSubstr(method));
  auto arguments = scenes;
  arguments.insert(arguments.end(), {"--planner", "planner", "--json"});
  const auto result = test::isobath(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  ASSERT_EQ(json["rows"].size(), 1u);
  EXPECT_EQ(json["rows"][0]["method"], "planner");
  EXPECT_EQ(json["rows"][0]["contacts"], 0);
  EXPECT_EQ(json["rows"][0]["arrived"], 3);
  EXPECT_GE(json["rows"][0]["gap_least_m"], 0.25);
  EXPECT_TRUE(std::filesystem::exists(folder / "traffic.png"));
}

TEST(Traffic, RefusesWhatMakesNoSense) {
  using test::ends_with_one_line;
  EXPECT_THAT(test::isobath({"traffic", "--planner", "rvo"}), ends_with_one_line(HasSubstr("planner")));
  EXPECT_THAT(test::isobath({"traffic", "--bodies", "0"}), ends_with_one_line(HasSubstr("--bodies")));
  EXPECT_THAT(test::isobath({"traffic", "--set", "planner.marjin=1"}), ends_with_one_line(HasSubstr("margin")));
  EXPECT_THAT(test::isobath({"traffic", "--runs", "1", "--set", "vehicle.min_speed=2"}),
              ends_with_one_line(HasSubstr("minimum speed")));
}

}  // namespace
}  // namespace isobath
