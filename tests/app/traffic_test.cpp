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

// The planner goes round the quay by its road map; without one it stays in it. ledger: S3-13 S3-26
TEST(Traffic, ArrivesBehindTheQuayByTheRoadMap) {
  const auto folder = test::scratch_folder();
  const auto result = test::isobath({"traffic", "--scene", "quay", "--bodies", "0", "--runs", "2", "-o",
                                     folder.string(), "--set", "planner.max_expansions=500", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto rows = nlohmann::json::parse(result.out)["rows"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["method"], "planner");
  EXPECT_EQ(rows[0]["arrived"], 2);
  EXPECT_EQ(rows[0]["contacts"], 0);
  EXPECT_LT(rows[0]["time_median"], 1.1) << "over the shortest path of the visibility graph";
  EXPECT_EQ(rows[0]["detail"], nlohmann::json({2, 0, 0}));
  EXPECT_EQ(rows[1]["method"], "search");
  EXPECT_EQ(rows[1]["arrived"], 0);
  const auto off =
      test::isobath({"traffic", "--scene", "quay", "--bodies", "0", "--runs", "1", "-o", folder.string(), "--set",
                     "planner.roads=false", "--set", "planner.max_expansions=500", "--planner", "planner", "--json"});
  EXPECT_EQ(nlohmann::json::parse(off.out)["rows"][0]["arrived"], 0);
}

// ledger: S3-D02 S3-D03 S3-D04
TEST(Traffic, CrossesEachSceneWithoutContact) {
  const auto folder = test::scratch_folder();
  for (const char* scene : {"walls", "harbour", "bar", "crossing"}) {
    for (const char* map : {"known", "unknown"}) {
      const auto result = test::isobath({"traffic", "--scene", scene, "--map", map, "--bodies", "10", "--runs", "2",
                                         "-o", folder.string(), "--planner", "planner", "--json"});
      ASSERT_EQ(result.exit_code, 0) << result.err;
      const auto row = nlohmann::json::parse(result.out)["rows"][0];
      EXPECT_EQ(row["arrived"], 2) << scene << " " << map;
      EXPECT_EQ(row["contacts"], 0) << scene << " " << map;
    }
  }
}

TEST(Traffic, RefusesWhatMakesNoSense) {
  using test::ends_with_one_line;
  EXPECT_THAT(test::isobath({"traffic", "--planner", "rvo"}), ends_with_one_line(HasSubstr("planner")));
  EXPECT_THAT(test::isobath({"traffic", "--bodies", "-1"}), ends_with_one_line(HasSubstr("--bodies")));
  EXPECT_THAT(test::isobath({"traffic", "--scene", "lagoon"}), ends_with_one_line(HasSubstr("--scene")));
  EXPECT_THAT(test::isobath({"traffic", "--scene", "walls", "--planner", "orca"}),
              ends_with_one_line(HasSubstr("planner or search")));
  EXPECT_THAT(test::isobath({"traffic", "--set", "planner.marjin=1"}), ends_with_one_line(HasSubstr("margin")));
  EXPECT_THAT(test::isobath({"traffic", "--runs", "1", "--set", "vehicle.min_speed=2"}),
              ends_with_one_line(HasSubstr("minimum speed")));
}

}  // namespace
}  // namespace isobath
