// Several vehicles in one water, as a user meets them: `isobath run` of a scene with a group.
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <isobath/base/random.hpp>
#include <isobath/io/mcap/mcap_index.hpp>
#include <isobath/recording/run_recorder.hpp>
#include <limits>
#include <map>
#include <set>
#include <tests/app/json_page.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using testing::HasSubstr;

/// Two vehicles over four lanes of 40 m, with a sonar that takes little time.
std::filesystem::path scene(const std::filesystem::path& folder, const std::string& bravo = "",
                            const std::string& more = "") {
  const std::string vehicle = (test::source_folder() / "vehicles/remus100.toml").string();
  return test::write(folder / "group.toml", fmt::format(R"([scene]
title = "A group"
duration_s = 500
[bottom]
kind = "flat"
material = "mud"
depth = 25
[vehicle]
name = "alpha"
file = "{}"
start = [-15, 15, 12]
[[group_vehicle]]
name = "bravo"
start = [-15, 45, 12]
{}
[acoustic_link]
loss = 0.3
[navigation]
kind = "drift"
[search_area]
length_m = 40
station_m = 20
breadth_m = 60
spacing_m = 15
depth_m = 12
[[sonar]]
preset = "oculus_m750d"
range_m = 30
bins = 60
interval_s = 1
{}
)",
                                                        vehicle, bravo, more));
}

// ledger: S2-10 S2-50 S2-51
TEST(Group, SharesAnAreaOverALinkThatLosesPackets) {
  const auto folder = test::scratch_folder();
  const auto file = scene(folder);
  const auto result = test::isobath({"run", file.string(), "--out", (folder / "one").string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err << result.out;
  test::JsonPage().compare("a group", nlohmann::json::parse(result.out));
  const auto group = test::json_of(folder / "one/group.json");
  EXPECT_GE(group["searched"].get<double>(), 0.95);
  EXPECT_LE(group["overlap"].get<double>(), 0.1);
  EXPECT_GT(group["least_separation_m"].get<double>(), 5);
  ASSERT_EQ(group["vehicles"].size(), 2u);
  for (const auto& vehicle : group["vehicles"]) {
    EXPECT_EQ(vehicle["lanes"], 2);
    EXPECT_EQ(vehicle["phase"], "finished");
    EXPECT_LT(vehicle["link"]["bit_rate"].get<double>(), 80);
    EXPECT_GT(vehicle["link"]["received"].get<int>(), 0);
    EXPECT_GT(vehicle["link"]["lost"].get<int>(), 0) << "the link loses packets";
  }
  // One page for both, which leads to theirs.
  const std::string report = test::content_of(folder / "one/report.html");
  EXPECT_THAT(report, HasSubstr("<a href=\"alpha/report.html\">report of alpha</a>"));
  EXPECT_THAT(report, HasSubstr("Levels of command of bravo"));
  EXPECT_THAT(report, HasSubstr("<td>bravo</td>"));
  EXPECT_TRUE(std::filesystem::is_regular_file(folder / "one/alpha/report.html"));
  // The vehicles err on their own: their navigation has its own errors.
  const auto error_m = [&](const char* name) {
    return test::json_of(folder / "one" / name / "mission.json")["truth"]["navigation_error_last_m"].get<double>();
  };
  EXPECT_NE(error_m("alpha"), error_m("bravo"));
}

// Each vehicle has its own simulator, maps and agents; together they are a function of scene and seed. ledger: S6-57
TEST(Group, IsTheSameOnAnyNumberOfThreads) {
  const auto folder = test::scratch_folder();
  const auto file = scene(folder);
  for (const char* threads : {"1", "2"}) {
    const auto result = test::isobath({"run", file.string(), "--out", (folder / threads).string(), "--threads", threads,
                                       "--set", "simulation.duration_s=25"});
    EXPECT_EQ(result.exit_code, 1) << "the mission did not end";
  }
  const auto one = test::files_of(folder / "1"), two = test::files_of(folder / "2");
  EXPECT_EQ(one.size(), two.size());
  for (const auto& [name, bytes] : one) EXPECT_TRUE(two.at(name) == bytes) << name;
}

// ledger: S2-17 S2-50
TEST(Group, TakesOverTheShareOfAVehicleThatIsLost) {
  const auto folder = test::scratch_folder();
  const auto result = test::isobath({"run", scene(folder, "lost_s = 30").string(), "--out", (folder / "out").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err << result.out;
  EXPECT_THAT(result.out, HasSubstr("2 vehicles searched"));
  EXPECT_THAT(result.out, HasSubstr("bravo: lost at 30 s"));
  const auto group = test::json_of(folder / "out/group.json");
  EXPECT_GE(group["searched"].get<double>(), 0.95);
  EXPECT_GE(group["vehicles"][0]["lanes"].get<int>(), 3) << "and what was left of the fourth";
  EXPECT_NEAR(group["vehicles"][1]["lost_s"].get<double>(), 30, 0.2);
  EXPECT_GT(group["least_separation_m"].get<double>(), 0) << "it passes the lost one, which it sees";
  const std::string decisions = test::content_of(folder / "out/alpha/decisions.json");
  EXPECT_THAT(decisions, HasSubstr("bravo was not heard for 60 s"));
  EXPECT_THAT(decisions, HasSubstr("all 4 lanes are done"));
}

// A pole that the sonar of alpha cannot reach from its lanes: alpha knows it from bravo. ledger: S2-50 S2-51
TEST(Group, TellsOneAnotherOfObstacles) {
  const auto folder = test::scratch_folder();
  const std::string pole = "[[cylinder]]\nname = \"pole\"\ncentre = [20, 60, 12]\nradius = 1\nlength = 25\n";
  std::string text = test::content_of(scene(folder, "", pole));
  const std::string coarse = "bins = 60\ninterval_s = 1";
  text.replace(text.find(coarse), coarse.size(), "bins = 200\ninterval_s = 0.5");
  const auto file = test::write(folder / "fine.toml", text);
  for (const char* told : {"3", "0"}) {
    test::isobath({"run", file.string(), "--out", (folder / told).string(), "--set", "simulation.duration_s=30",
                   "--set", std::string("commodore.told_obstacles=") + told});
  }
  EXPECT_THAT(test::content_of(folder / "3/alpha/decisions.json"),
              testing::ContainsRegex("bravo has seen an obstacle at north (1|2)[0-9.]*, east (5|6)"));
  EXPECT_THAT(test::content_of(folder / "0/alpha/decisions.json"), testing::Not(HasSubstr("has seen an obstacle")));
}

/// A cheap scene: two vehicles with sonars of one beam.
std::filesystem::path cheap_scene(const std::filesystem::path& folder, double together_s) {
  return test::write(folder / "cheap.toml",
                     fmt::format(R"([scene]
title = "Two beams"
duration_s = 400
[bottom]
kind = "flat"
depth = 25
[vehicle]
name = "alpha"
file = "{}"
dynamic = true
start = [-15, 15, 12]
[[group_vehicle]]
name = "bravo"
start = [-60, 45, 12]
[acoustic_link]
loss = 0.1
[navigation]
kind = "drift"
[search_area]
length_m = 80
breadth_m = 60
spacing_m = 15
depth_m = 12
together_s = {}
[[sonar]]
preset = "obstacle_cone"
interval_s = 1
)",
                                 (test::source_folder() / "vehicles/remus100.toml").string(), together_s));
}

/// When a vehicle first decides this, s.
double decided_s(const std::filesystem::path& out, const char* vehicle, const std::string& what) {
  const auto decisions = test::json_of(out / vehicle / "decisions.json");
  for (const auto& decision : decisions["decisions"]) {
    if (decision["what"] == what) return 1e-9 * decision["time_ns"].get<double>();
  }
  return -1;
}

// Planned apart, two vehicles that start at different distances begin their lanes at one time; where they wait too
// short a time, the first one begins alone. ledger: S2-19
TEST(Group, BeginsItsLanesTogether) {
  const auto folder = test::scratch_folder();
  for (const double together_s : {200.0, 20.0}) {
    const auto out = folder / fmt::format("{:g}", together_s);
    test::isobath(
        {"run", cheap_scene(folder, together_s).string(), "--out", out.string(), "--set", "simulation.duration_s=150"});
    if (together_s > 100) {
      EXPECT_GT(decided_s(out, "alpha", "begin together"), 30);
      EXPECT_EQ(decided_s(out, "alpha", "begin together"), decided_s(out, "bravo", "begin together"));
    } else {
      EXPECT_LT(decided_s(out, "alpha", "begin alone"), 22);
    }
  }
}

// Each level plans at least as often as the timing table says. A table with other intervals is followed, one that
// departs from the rules is told, and one that cannot be kept is refused. ledger: S2-25 S2-38 S2-41 S2-E04 S2-E05
TEST(Group, PlansByTheTimingTable) {
  const auto folder = test::scratch_folder();
  const auto file = cheap_scene(folder, 0);
  const auto run = [&](const std::vector<std::string>& settings) {
    std::vector<std::string> words{
        "run", file.string(), "--out", (folder / "out").string(), "--set", "simulation.duration_s=100"};
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", "timing." + setting});
    return test::isobath(words);
  };
  EXPECT_THAT(run({}).err, testing::Not(HasSubstr("timing")));
  for (const char* vehicle : {"alpha", "bravo"}) {
    const auto levels = test::json_of(folder / "out" / vehicle / "mission.json")["levels"];
    ASSERT_EQ(levels.size(), 6u);
    for (const auto& level : levels) EXPECT_EQ(level["in_time"], true) << level.dump();
    EXPECT_EQ(levels[2]["longest_replan_s"], 60);
    EXPECT_EQ(levels[5]["longest_interval_s"], 0.6);
  }
  const auto printed = run({"group_horizon_s=3000", "mission_replan_s=50", "mission_horizon_s=200", "group_replan_s=12",
                            "vehicle_replan_s=3", "move_replan_s=1", "primitive_replan_s=0.4", "servo_replan_s=0.1"});
  EXPECT_THAT(printed.err, HasSubstr("plans of the group level reach 3000 s ahead, 100 s by the rule"));
  const auto levels = test::json_of(folder / "out/bravo/mission.json")["levels"];
  EXPECT_LE(levels[1]["longest_replan_s"].get<double>(), 12.05);
  EXPECT_LE(levels[2]["longest_replan_s"].get<double>(), 3.05);
  EXPECT_EQ(levels[5]["in_time"], false) << "set-points change at 0.6 s";
  const auto refused = run({"move_replan_s=100"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("the move level plans every 100 s, no more often than the vehicle level above it"));
}

/// The commands of a recording by their numbers, and those to the actuators.
struct RecordedCommands {
  std::map<std::uint64_t, nlohmann::json> messages;
  std::vector<nlohmann::json> servo;
};
RecordedCommands commands_in(const std::filesystem::path& file) {
  McapIndex index(file);
  RecordedCommands all;
  const std::uint16_t messages = index.channel_of(kMessagesTopic).value(),
                      servo = index.channel_of(kServoTopic).value();
  const std::array<std::uint16_t, 2> both = {messages, servo};
  index.visit(both, 0, std::numeric_limits<std::uint64_t>::max(), [&](const McapMessage& message) {
    auto json = nlohmann::json::parse(message.data.begin(), message.data.end());
    if (message.channel_id == servo) {
      all.servo.push_back(std::move(json));
    } else {
      const auto number = json["number"].get<std::uint64_t>();
      all.messages[number] = std::move(json);
    }
    return true;
  });
  return all;
}

// One command to start leads to commands on all six levels of both vehicles, down to thrusters and fins; ten of these,
// at random, are followed back to it. Nothing but these commands goes down from level to level, least of all what a
// level plans with. ledger: S2-01 S2-02 S2-11 S2-20 S2-26 S2-40
TEST(Group, EachCommandToAnActuatorLeadsBackToTheOrderOfTheMission) {
  const auto folder = test::scratch_folder();
  std::string text = test::content_of(scene(folder));
  text.replace(text.find("start = "), 0, "dynamic = true\n");
  const auto file = test::write(folder / "dynamic.toml", text);
  const auto result = test::isobath({"run", file.string(), "--out", (folder / "out").string(), "--record",
                                     (folder / "run.mcap").string(), "--set", "simulation.duration_s=60"});
  ASSERT_EQ(result.exit_code, 1) << "the mission did not end";
  Random random(7);
  for (const char* name : {"alpha", "bravo"}) {
    const RecordedCommands all = commands_in(folder / fmt::format("run-{}.mcap", name));
    ASSERT_GE(all.servo.size(), 90u) << "one each 0.6 s";
    std::set<std::string> between_levels;
    for (const auto& [number, message] : all.messages) {
      if (message.contains("level")) between_levels.insert(message["type"].get<std::string>());
    }
    EXPECT_THAT(between_levels, testing::IsSubsetOf({"mission order", "visit order", "route request", "route planned",
                                                     "follow order", "helm order"}));
    for (int trial = 0; trial < 10; ++trial) {
      const nlohmann::json& command = all.servo[5 + random.index(all.servo.size() - 5)];
      EXPECT_GE(command["commands"].size(), 3u) << "a thruster and fins";
      std::vector<std::string> levels = {"servo"};
      std::uint64_t parent = command["parent"].get<std::uint64_t>();
      std::int64_t time_ns = command["time_ns"].get<std::int64_t>();
      while (parent > 0) {
        const nlohmann::json& above = all.messages.at(parent);
        EXPECT_LE(above["time_ns"].get<std::int64_t>(), time_ns) << "a cause comes first";
        time_ns = above["time_ns"].get<std::int64_t>();
        if (!above.contains("level")) {
          EXPECT_EQ(above["type"], "operator command");
          EXPECT_EQ(above["content"]["command"], "start");
          break;
        }
        if (above["level"] != levels.back()) levels.push_back(above["level"].get<std::string>());
        parent = above["parent"].get<std::uint64_t>();
      }
      EXPECT_THAT(levels, testing::ElementsAre("servo", "primitive", "move", "vehicle", "group", "mission"))
          << command.dump();
    }
    const auto mission = test::json_of(folder / "out" / name / "mission.json");
    ASSERT_EQ(mission["levels"].size(), 6u);
    for (const auto& level : mission["levels"]) {
      EXPECT_LE(level["longest_stale_s"].get<double>(), 0.6) << level.dump();
    }
  }
}

/// The cheap scene with a wall on the way of both, and a gap in it that is a passage.
std::filesystem::path scene_with_gap(const std::filesystem::path& folder, bool passage) {
  std::string text = test::content_of(cheap_scene(folder, 0));
  const std::string start = "start = [-60, 45, 12]", area = "[search_area]\n";
  text.replace(text.find(start), start.size(), "start = [-15, 45, 12]");
  text.replace(text.find(area), area.size(), area + "corner = [120, 0]\n");
  text += R"([geofence]
corners = [[-60, -60], [260, -60], [260, 120], [-60, 120]]
[[injected_map]]
at_s = 1
outline = [[50, -60], [54, -60], [54, 20], [50, 20]]
[[injected_map]]
at_s = 1
outline = [[50, 42], [54, 42], [54, 120], [50, 120]]
)";
  if (passage) text += "[[passage]]\nname = \"the gap\"\noutline = [[40, 20], [40, 42], [64, 42], [64, 20]]\n";
  return test::write(folder / (passage ? "passage.toml" : "open.toml"), text);
}

// Both vehicles come to the gap at one time. ledger: S2-17 S2-51
TEST(Group, GoesThroughAPassageOneAfterTheOther) {
  const auto folder = test::scratch_folder();
  for (const bool passage : {true, false}) {
    const auto out = folder / (passage ? "passage" : "open");
    test::isobath(
        {"run", scene_with_gap(folder, passage).string(), "--out", out.string(), "--set", "simulation.duration_s=150"});
    const auto json = test::json_of(out / "group.json");
    EXPECT_EQ(json["passage_shared_s"].is_null(), !passage);
    const double took = decided_s(out, "alpha", "take passage"), left = decided_s(out, "alpha", "leave passage");
    if (!passage) {
      EXPECT_EQ(took, -1);
      continue;
    }
    EXPECT_EQ(json["passage_shared_s"], 0);
    EXPECT_GT(took, 0);
    EXPECT_GT(left, took);
    EXPECT_GT(decided_s(out, "bravo", "wait for passage"), 0);
    EXPECT_GT(decided_s(out, "bravo", "take passage"), left);
    EXPECT_GT(decided_s(out, "bravo", "leave passage"), left);
    EXPECT_THAT(test::content_of(out / "report.html"), HasSubstr("no two vehicles were in one passage at a time"));
  }
}

// ledger: S2-12 S2-50 S6-31
TEST(Group, RunsLiveWithThreadsOfItsOwn) {
  const auto folder = test::scratch_folder();
  const auto result = test::isobath({"run", cheap_scene(folder, 0).string(), "--out", (folder / "out").string(),
                                     "--live", "--speed", "20", "--set", "simulation.duration_s=40"});
  EXPECT_EQ(result.exit_code, 1) << "the mission did not end";
  const auto group = test::json_of(folder / "out/group.json");
  ASSERT_EQ(group["vehicles"].size(), 2u);
  for (const auto& vehicle : group["vehicles"]) {  // a loaded machine may have made it hold: its phase is not looked at
    EXPECT_GT(vehicle["link"]["received"].get<int>(), 0);
  }
  EXPECT_TRUE(std::filesystem::is_regular_file(folder / "out/bravo/report.html"));
}

// ledger: S2-35 S2-50
TEST(Group, KeepsAMapForEachVehicle) {
  const auto folder = test::scratch_folder();
  const auto result = test::isobath({"run", cheap_scene(folder, 0).string(), "--out", (folder / "out").string(),
                                     "--map", (folder / "lake").string(), "--set", "simulation.duration_s=20"});
  EXPECT_EQ(result.exit_code, 1) << "the mission did not end";
  for (const char* vehicle : {"alpha", "bravo"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / fmt::format("lake-{}", vehicle))) << result.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "lake"));
}

// ledger: S2-50 S6-67
TEST(Group, IsScoredBySuites) {
  const auto folder = test::scratch_folder();
  scene(folder);
  const auto suite = test::write(folder / "small.toml", R"([suite]
scene = "group.toml"
runs = 2
seed = 1
duration_s = 60
[[group]]
name = "two"
[[group]]
name = "one-lost"
loses_vehicle = true
[vary]
lost_s = [5, 10]
[bars]
searched_share = 0.99
)");
  const auto result = test::isobath({"eval", suite.string(), "--out", (folder / "out").string(), "--json"});
  EXPECT_EQ(result.exit_code, 1) << "a minute is not enough";
  const auto json = nlohmann::json::parse(result.out);
  test::JsonPage().compare("eval", json);
  EXPECT_THAT(json["broken_bars"].dump(), HasSubstr("searched_share"));
  EXPECT_EQ(json["variants"]["two"]["group"]["overlap"]["count"], 1);
}

TEST(Group, IsRefusedWhereOneVehicleIsExpected) {
  const auto folder = test::scratch_folder();
  const std::string file = scene(folder).string();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"sim", file, "--out", (folder / "log.mcap").string()},
        {"run", file, "--out", (folder / "out").string(), "--mission", file}}) {
    EXPECT_THAT(test::isobath(words),
                test::ends_with_one_line(testing::AnyOf(HasSubstr("vehicles"), HasSubstr("group"))));
  }
  const auto alone = test::write(folder / "alone.toml", "[scene]\n[[group_vehicle]]\nstart = [5, 5, 1]\n");
  EXPECT_THAT(test::isobath({"run", alone.string(), "--out", (folder / "out").string()}),
              test::ends_with_one_line(HasSubstr("search_area")));
}

}  // namespace
}  // namespace isobath
