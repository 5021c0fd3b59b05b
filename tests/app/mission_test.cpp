// isobath run with a mission, as a user meets it: what it says, what it leaves behind, and that it can be run again.
#include <fmt/format.h>
#include <gdal_priv.h>
#include <map>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>
#include <tests/support/sanitized.hpp>
#include <tuple>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

nlohmann::json printed(const ProgramResult& result) { return nlohmann::json::parse(result.out, nullptr, false); }

fs::path scenario(const std::string& name) { return source_folder() / "scenarios" / (name + ".toml"); }

/// Pixels of about this colour in the chart of mission.png, without its legend.
int pixels_in_chart(const fs::path& picture, const std::array<int, 3>& rgb) {
  GDALAllRegister();
  const GDALDatasetUniquePtr data(GDALDataset::Open(picture.c_str()));
  constexpr int kChart = 860, kNear = 24;  // pixels; of 255
  const int height = data->GetRasterYSize();
  std::vector<std::uint8_t> pixels(3 * static_cast<std::size_t>(kChart * height));
  EXPECT_EQ(data->RasterIO(GF_Read, 0, 0, kChart, height, pixels.data(), kChart, height, GDT_Byte, 3, nullptr, 3,
                           3 * kChart, 1, nullptr),
            CE_None);
  int found = 0;
  for (std::size_t i = 0; i < pixels.size(); i += 3) {
    bool near = true;
    for (std::size_t c = 0; c < 3; ++c) near = near && std::abs(pixels[i + c] - rgb[c]) <= kNear;
    found += near ? 1 : 0;
  }
  return found;
}

// The demo: the vehicle sees, decides, turns, and can say why.
// ledger: S6-32 S6-56 S6-57 S6-59
TEST(Mission, TheDemoReachesItsPointsClearOfTheBuoysAndSaysWhy) {
  const fs::path out = scratch_folder() / "out";
  const ProgramResult result = isobath_run({}, out);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto mission = printed(result)["mission"];
  EXPECT_EQ(mission["phase"], "finished");
  EXPECT_EQ(mission["reached"], 3);
  EXPECT_EQ(mission["dropped"], 0);
  EXPECT_EQ(mission["truth"]["contact"], false);
  EXPECT_GT(mission["truth"]["least_clearance_m"].get<double>(), 1);
  EXPECT_GT(mission["truth"]["path_m"].get<double>(), 100);
  EXPECT_GT(mission["timings"]["scan_to_decision"]["count"].get<int>(), 10);
  // Who sends what, by level.
  std::map<std::string, std::pair<std::string, std::set<std::string>>> crew;
  for (const auto& agent : mission["crew"]["agents"]) {
    auto& [level, sent] = crew[agent["name"]];
    level = agent["level"];
    for (const auto& message : agent["sent"]) sent.insert(message["message"].get<std::string>());
  }
  EXPECT_EQ(crew["captain"].first, "supervisory");
  EXPECT_EQ(crew["navigator"].first, "mission");
  EXPECT_EQ(crew["pilot"].first, "vehicle");
  EXPECT_EQ(crew["safety officer"].first, "supervisory");
  EXPECT_THAT(crew["fls detector"].second, testing::ElementsAre("obstacle scan"));
  EXPECT_THAT(crew["navigator"].second, testing::IsSupersetOf({"route planned", "decision"}));
  EXPECT_THAT(crew["pilot"].second, testing::IsSupersetOf({"helm order", "waypoint passed"}));
  EXPECT_TRUE(crew["captain"].second.contains("mission order"));
  EXPECT_FALSE(crew["navigator"].second.contains("helm order")) << "the pilot's word alone";
  auto without_timings = mission;
  without_timings.erase("timings");
  EXPECT_EQ(without_timings, json_of(out / "mission.json")) << "the file holds no measured time";
  const auto decisions = json_of(out / "decisions.json")["decisions"];
  EXPECT_EQ(decisions.size(), mission["decisions"]);
  int replans = 0;
  for (const auto& d : decisions) {
    EXPECT_FALSE(d["reason"].get<std::string>().empty());
    if (d["what"] != "replan" || !d.contains("obstacle_m")) continue;
    ++replans;
    EXPECT_TRUE(d.contains("leg") && d.contains("margin_m") && d.contains("way_m")) << d;
  }
  EXPECT_GT(replans, 0);
  EXPECT_THAT(content_of(out / "report.html"),
              AllOf(HasSubstr("<h2>Mission</h2>"), HasSubstr("<h2>Decisions</h2>"), HasSubstr("replan")));
  for (const char* picture : {"mission.png", "clearance.png"})
    EXPECT_THAT(content_of(out / picture), StartsWith("\x89PNG"));
  // fence, mission points, way-points, track, obstacles
  EXPECT_GT(pixels_in_chart(out / "mission.png", {166, 26, 115}), 1000) << "the fence is 220 m long";
  EXPECT_GT(pixels_in_chart(out / "mission.png", {0, 128, 92}), 800) << "three circles of 10 m";
  EXPECT_GT(pixels_in_chart(out / "mission.png", {89, 51, 153}), 200) << "the last route, from B to C";
  EXPECT_GT(pixels_in_chart(out / "mission.png", {0, 115, 179}), 2000) << "146 m travelled";
  EXPECT_GT(pixels_in_chart(out / "mission.png", {214, 94, 0}), 5000) << "the banks, as detected";
}

/// The scene of a leak that lasts a second, with more lines at its end.
fs::path short_leak(const fs::path& file, const std::string& more) {
  std::string scene = content_of(scenario("faults/leak"));
  const std::string fault = "at_s = 20";
  scene.replace(scene.find(fault), fault.size(), fault + "\nfor_s = 1");
  return write(file, scene + more);
}

// ledger: S1-43
TEST(Mission, AnAlarmStandsUntilItsCauseIsOverAndTheOperatorHasAcknowledgedIt) {
  const fs::path folder = scratch_folder();
  const auto alarm_of = [&](const std::string& name, const std::string& more) {
    const ProgramResult result = isobath_run(short_leak(folder / (name + ".toml"), more), folder / name);
    const auto alarms = printed(result)["alarms"];
    EXPECT_EQ(alarms.size(), 1u) << result.out << result.err;
    return alarms.at(0);
  };
  const auto unseen = alarm_of("unseen", "");
  EXPECT_EQ(unseen["what"], "leak");
  EXPECT_EQ(unseen["first_ns"], 20000000000) << "at once";
  EXPECT_EQ(unseen["lasting"], true) << "latched";
  EXPECT_EQ(unseen["acknowledged"], false);
  const auto seen = alarm_of("seen", "\n[[operator]]\nat_s = 21.5\ncommand = \"acknowledge\"\n");
  EXPECT_EQ(seen["lasting"], false);
  EXPECT_EQ(seen["acknowledged"], true);
  const auto decisions = json_of(folder / "seen" / "decisions.json")["decisions"];
  EXPECT_TRUE(std::any_of(decisions.begin(), decisions.end(), [](const auto& d) {
    return d["agent"] == "captain" && d["what"] == "acknowledge" && d["time_ns"] == 21500000000;
  }));
  const auto early = alarm_of("early", "\n[[operator]]\nat_s = 20.5\ncommand = \"acknowledge\"\n");
  EXPECT_EQ(early["lasting"], false) << "acknowledged while its cause lasted, it is over with its cause";
}

// The chart has a shoal that does not exist, and lacks a rock that the sonar finds.
// ledger: S1-D01 S1-D02
TEST(Mission, KnowsTheHazardsOfItsChartAndThoseThatItsSonarHasMeasured) {
  ISOBATH_NOT_SANITIZED();
  const ProgramResult lake = isobath_run(scenario("winnipesaukee"), scratch_folder() / "out");
  ASSERT_EQ(lake.exit_code, 0) << lake.err;
  EXPECT_GT(printed(lake)["mission"]["hazards"]["charted"], 0);
  EXPECT_GT(printed(lake)["mission"]["hazards"]["measured"], 0);
}

TEST(Mission, TheSummaryNamesEachReplanWithItsReason) {
  const ProgramResult result =
      test::isobath({"run", scenario("simulated_mission_1"), "--out", scratch_folder() / "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("Mission finished: 3 of 3 points reached."), HasSubstr("navigator: replan: leg ")));
}

// A recorded run, heard again by the same agents, decides the same, bit for bit, on any number of threads: they plan by
// what they are told of the world alone. ledger: S2-05 S6-57 S6-D09
TEST(MissionReplay, ReproducesEveryDecision) {
  const fs::path folder = scratch_folder(), log = folder / "run.mcap";
  const fs::path file = scenario("field_mission_2");
  ASSERT_EQ(isobath_run(file, folder / "live", {"--record", log}).exit_code, 0);
  const std::string decisions = content_of(folder / "live" / "decisions.json");
  EXPECT_GT(json_of(folder / "live" / "decisions.json")["decisions"].size(), 5u);
  const ProgramResult replay = isobath_run(log, folder / "replay", {"--mission", file, "--threads", "2"});
  EXPECT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_TRUE(content_of(folder / "replay" / "decisions.json") == decisions);
  const auto recorded = printed(replay)["mission"]["recorded"];
  EXPECT_EQ(recorded["the_same"], recorded["decisions"]);
  ASSERT_EQ(isobath_run(file, folder / "alone", {"--threads", "1"}).exit_code, 0);
  EXPECT_TRUE(content_of(folder / "alone" / "decisions.json") == decisions) << "live on one thread";
  // Somebody who decides otherwise is told so.
  const ProgramResult other = isobath_run(log, folder / "other", {"--mission", file, "--set", "route.clearance_m=6"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("differs from the recorded run"));
}

// What the vehicle was led by is in the scenario, and so the same for the replay: its chart, its operator.
// ledger: S6-32 S6-40 S6-57
TEST(MissionReplay, GoesByTheChartAndHearsTheOperator) {
  const fs::path folder = scratch_folder();
  // The first mission is cut short: its end is no matter here.
  for (const auto& [name, seconds, exit_code] :
       {std::tuple{"charted_shoals", 100, 1}, std::tuple{"operator_on_the_link", 200, 0}}) {
    const fs::path file = scenario(name), log = folder / (std::string(name) + ".mcap");
    const std::vector<std::string> place = {"--set", "depth_map.area_m=512", "--set",
                                            fmt::format("simulation.duration_s={}", seconds)};
    std::vector<std::string> options = place;
    options.insert(options.end(), {"--record", log});
    const ProgramResult first = isobath_run(file, folder / name, options);
    ASSERT_EQ(first.exit_code, exit_code) << first.err;
    options = place;
    options.insert(options.end(), {"--mission", file});
    const ProgramResult replay = isobath_run(log, folder / (std::string(name) + "-replay"), options);
    EXPECT_EQ(replay.exit_code, exit_code) << replay.err;
    const auto recorded = printed(replay)["mission"]["recorded"];
    EXPECT_GT(recorded["decisions"], 5) << name;
    EXPECT_EQ(recorded["the_same"], recorded["decisions"]) << name;
  }
  EXPECT_FALSE(json_of(folder / "operator_on_the_link" / "mission.json")["operator"].empty());
}

// Real threads: not the same decisions every time, but the same end; and how long each stage took.
// ledger: S6-31 S2-12
TEST(Mission, LiveItEndsTheSameAndEveryStageIsMeasured) {
  const fs::path folder = scratch_folder();
  const ProgramResult live =
      isobath_run(scenario("simulated_mission_1"), folder / "live", {"--live", "--speed", "max"});
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const auto mission = printed(live)["mission"];
  EXPECT_EQ(mission["phase"], "finished");
  EXPECT_EQ(mission["crew"]["agents_lost"], 0);
  EXPECT_EQ(printed(live)["live"]["lost_pings"], 0);
  for (const char* stage : {"event_to_crew", "ping_to_grid", "detection", "planning", "scan_to_decision"}) {
    EXPECT_GT(mission["timings"][stage]["count"].get<int>(), 10) << stage;
    EXPECT_GE(mission["timings"][stage]["p99_ms"], mission["timings"][stage]["median_ms"]) << stage;
  }
  EXPECT_THAT(test::isobath({"run", scenario("tank"), "--live", "--out", folder / "out"}),
              ends_with_one_line(HasSubstr("only a scene with a mission can run live")));
}

TEST(Mission, OneThatDoesNotEndFailsTheRun) {
  const ProgramResult result = isobath_run({}, scratch_folder() / "out", {"--set", "simulation.duration_s=30"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(StartsWith("isobath: "), HasSubstr("the mission did not end")));
  EXPECT_EQ(printed(result)["mission"]["phase"], "under way");
}

TEST(Mission, WrongUseIsRefusedInOneLine) {
  const fs::path folder = scratch_folder();
  EXPECT_THAT(test::isobath({"run", "--record", folder / "run.bag", "--out", folder / "out"}),
              ends_with_one_line(HasSubstr(".mcap")));
  EXPECT_THAT(test::isobath({"run", "--mission", "no/such.toml", "--out", folder / "out"}),
              ends_with_one_line(HasSubstr("no/such.toml: no such file")));
  const fs::path file = write(folder / "m.toml", "[mission]\nspeed = 1\n[[mission_point]]\nnorth = -1e9\n");
  EXPECT_THAT(test::isobath({"run", "--mission", file, "--out", folder / "out"}),
              ends_with_one_line(HasSubstr("m.toml:4:")));
}

// The same water, the same point: what the mission weighs decides on the way, and its decision states the parts of the
// cost. ledger: S2-14 S2-E09
TEST(Mission, WeighsStealthAgainstTime) {
  const auto folder = test::scratch_folder();
  const std::string text = test::content_of(test::source_folder() / "scenarios/watched_water.toml");
  const std::string vehicles = (test::source_folder() / "vehicles").string();
  std::map<double, std::string> reasons;
  for (const double stealth : {0.0, 200.0}) {
    std::string own = text;
    own.replace(own.find("../vehicles"), 11, vehicles);
    own.replace(own.find("stealth = 200"), 13, fmt::format("stealth = {}", stealth));
    const auto file = test::write(folder / "watched.toml", own);
    test::isobath({"run", file.string(), "--out", (folder / "out").string(), "--set", "simulation.duration_s=6"});
    const auto decisions = test::json_of(folder / "out/decisions.json");
    for (const auto& decision : decisions["decisions"]) {
      if (decision["agent"] == "navigator" && decision["what"] == "plan") reasons[stealth] = decision["reason"];
    }
  }
  EXPECT_THAT(reasons[0], testing::HasSubstr("straight to far side"));
  EXPECT_THAT(reasons[0], testing::ContainsRegex("cost 13[0-9] s: 13[0-9] s, detected with [5-7][0-9] %"));
  EXPECT_THAT(reasons[200], testing::HasSubstr("going round"));
  EXPECT_THAT(reasons[200], testing::ContainsRegex("detected with [0-9] %"));
}

}  // namespace
}  // namespace isobath
