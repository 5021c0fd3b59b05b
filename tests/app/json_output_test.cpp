// What --json of each command prints is what docs/json-output.md says: no field more, no field less.
#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tests/app/json_page.hpp>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>
#include <tests/support/fan_folder.hpp>
#include <tests/support/pole_scene.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using nlohmann::json;
using testing::IsEmpty;

class JsonOutput : public testing::Test {
 protected:
  fs::path file(const std::string& name, const std::string& bytes) { return write(folder_ / name, bytes); }
  static std::string scenario(const std::string& name) {
    return (source_folder() / "scenarios" / (name + ".toml")).string();
  }
  /// What the command prints with --json, which must be an object.
  static json printed(std::vector<std::string> arguments, int exit_code = 0) {
    arguments.emplace_back("--json");
    const ProgramResult result = isobath::test::isobath(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments[0] << ": " << result.err;
    json object = json::parse(result.out, nullptr, false);
    EXPECT_FALSE(object.is_discarded()) << arguments[0] << ": " << result.out.substr(0, 200);
    return object;
  }
  void compare(const std::string& section, const std::vector<std::string>& arguments, int exit_code = 0) {
    page_.compare(section, printed(arguments, exit_code));
  }
  /// A fan past a pile: a minute, two pings a second.
  fs::path fan_scene() {
    return file("fan.toml",
                "[scene]\ntitle = \"a minute\"\nduration_s = 60\n[vehicle]\nstart = [0, 0, 5]\nspeed = 0.3\n"
                "[[waypoint]]\nnorth = 18\ndepth = 5\n[bottom]\nkind = \"terrain\"\nmaterial = \"sand\"\ndepth = 12\n"
                "extent_m = 80\ncell_m = 2\nrelief_m = 0.2\n[[cylinder]]\nname = \"pile\"\ncentre = [26, 6, 5]\n"
                "radius = 0.4\nlength = 14\n[[sonar]]\npreset = \"p450_horizontal\"\nrange_m = 20\nbins = 240\n"
                "interval_s = 0.5\n");
  }
  fs::path fan_log() {
    const fs::path log = folder_ / "fan.mcap";
    EXPECT_EQ(isobath::test::isobath({"sim", fan_scene(), "--out", log}).exit_code, 0);
    return log;
  }
  /// The soundings of a boat on a day.
  fs::path boat(int day) {
    std::string text = "T,Lat,Lon,D\n";
    for (int i = 0; i < 80; ++i) {
      text += fmt::format("{},{:.7f},13,{}\n", 86400 * day + i, 52.34 + 0.00003 * i, 5 + 0.05 * (i % 3));
    }
    return file(fmt::format("day{}.csv", day), text);
  }
  static std::vector<std::string> with_columns(std::vector<std::string> words) {
    words.insert(words.end(), {"--set", "input.csv_columns=time=T,latitude=Lat,longitude=Lon,depth=D", "--set",
                               "input.csv_time=seconds"});
    return words;
  }
  /// A depth map that was sailed over twice.
  void crossed_map() {
    for (const int day : {1, 2}) {
      printed(with_columns({"run", boat(day), "--map", folder_ / "crossed", "--out", folder_ / "crossed-run"}));
    }
  }
  /// A depth map of a lake.
  fs::path lake() {
    EXPECT_EQ(isobath::test::isobath({"run", scenario("winnipesaukee"), "--map", folder_ / "lake", "--out",
                                      folder_ / "lake-run", "--set", "simulation.duration_s=20"})
                  .exit_code,
              1)
        << "the mission is not finished";
    return folder_ / "lake";
  }

  JsonPage page_;
  fs::path folder_ = scratch_folder();
};

TEST_F(JsonOutput, UnitsAreThoseThatTheNamesEndIn) { EXPECT_THAT(page_.wrong_units(), IsEmpty()); }

TEST_F(JsonOutput, EveryErrorIsAnObjectToo) {
  const fs::path bad = file("bad.toml", "[echoes]\nfalse_alarn = 0.1\n"), text = file("notes.bin", "Dive 3.\n");
  const std::vector<std::vector<std::string>> wrong{{},
                                                    {"runn"},
                                                    {"run", "--no-such-option"},
                                                    {"run", "--config", bad},
                                                    {"serve", "--port", "-1"},
                                                    {"sim", "--seed", "x"},
                                                    {"eval", "nowhere"},
                                                    {"info", text},
                                                    {"convert", text, folder_ / "notes.mcap"},
                                                    {"compare", text, text},
                                                    {"crosscheck", text},
                                                    {"path", folder_, "1,1"},
                                                    {"calibrate", text},
                                                    {"helix", "--speed", "x"},
                                                    {"sphere", "--rule", "none"},
                                                    {"config", "--set", "echoes.alarm=1"},
                                                    {"help", "fly"}};
  for (std::vector<std::string> arguments : wrong) {
    arguments.emplace_back("--json");
    const ProgramResult result = isobath::test::isobath(arguments);
    EXPECT_THAT(result, ends_with_one_line(testing::_)) << arguments[0];
    const json object = json::parse(result.out, nullptr, false);
    page_.compare("errors", object);
    EXPECT_EQ("isobath: " + object["error"]["problem"].get<std::string>() + "\n", result.err);
  }
  compare("errors", {"run", file("cut.csv", "# t_s,head_deg,bin_m,nbins,i0,i1,...\n0,0,0.1,2147483648,1\n")}, 2);
  EXPECT_THAT(page_.never_came_out("errors"), testing::IsSubsetOf({std::string("error.byte")}));
}

TEST_F(JsonOutput, OfTheVersion) {
  compare("version", {"--version"});
  EXPECT_THAT(page_.never_came_out("version"), IsEmpty());
}

TEST_F(JsonOutput, OfRun) {
  auto lines = wall_csv_lines(200);
  std::swap(lines[100], lines[105]);
  compare("run", {"run", file("swapped.csv", joined(lines)), "--out", folder_ / "log"}, 2);
  // The missions end before their last point.
  const std::string pandan = scenario("pandan"), short_run = "simulation.duration_s=20";
  const fs::path recording = folder_ / "run.mcap";
  compare("run", {"run", "--out", folder_ / "mission", "--record", recording, "--set", short_run}, 1);
  compare("run", {"run", recording, "--mission", pandan, "--out", folder_ / "again"}, 1);
  compare("run", {"run", pandan, "--live", "--speed", "max", "--out", folder_ / "live", "--set", short_run}, 1);
  compare("run", {"run", scenario("operator_on_the_link"), "--out", folder_ / "link"});
  compare(
      "run",
      {"run", scenario("cameras/station_by_cameras"), "--out", folder_ / "station", "--set", "simulation.duration_s=4"},
      1);
  compare("run", {"run", scenario("charted_shoals"), "--out", folder_ / "shoals", "--map", folder_ / "map"});
  compare("run",
          {"run", scenario("crossing_traffic"), "--out", folder_ / "traffic", "--set", "simulation.duration_s=14"});
  compare("run", {"run", fan_scene(), "--out", folder_ / "fan", "--set", "simulation.duration_s=10"});
  compare("run",
          {"run", scenario("harbour_loop"), "--out", folder_ / "harbour", "--set", "corner_fix.on=true", "--set",
           "simulation.duration_s=40"},
          1);
  compare("run", {"run", scenario("machinery"), "--out", folder_ / "sounds", "--set", "simulation.duration_s=60"}, 1);
  compare("run",
          {"run", scenario("winnipesaukee"), "--out", folder_ / "lake", "--set", "depth_map.area_m=512", "--set",
           "simulation.duration_s=190"},
          1);
  FanRecording().write(folder_ / "basin");
  compare("run", {"run", folder_ / "basin", "--out", folder_ / "moved", "--set", "input.track=dead-reckoning"});
  // The rest needs damaged or very large maps, imminent collisions, or a fan model (the next test).
  for (const std::string& field : page_.never_came_out("run")) {
    EXPECT_THAT(field, testing::ContainsRegex("^(alarms|fan_model|voxels.(moved_with_jumps|spilled)|"
                                              "depth.(damages|prior_left_out|refused)|rejected)"));
  }
}

TEST_F(JsonOutput, OfCalibrateAndOfARunFromItsModel) {
  const fs::path log = fan_log(), sonar = folder_ / "sonar";
  compare("calibrate", {"calibrate", log, "--out", sonar});
  compare("run",
          {"run", log, "--out", folder_ / "run", "--model", sonar / "fan_model.json", "--set", "voxels.sonars=none"});
  for (const std::string& field : page_.never_came_out("run")) {
    EXPECT_THAT(field, testing::Not(testing::StartsWith("fan_model")));
  }
  for (const std::string& field : page_.never_came_out("calibrate")) {
    EXPECT_THAT(field,
                testing::ContainsRegex("^(groups\\[\\].(p|roc|theory)|cross_validation|histograms|fan.dead_beams)"))
        << "only these need marks, or dead beams";
  }
}

TEST_F(JsonOutput, OfCalibrateWithMarks) {
  ISOBATH_NEEDS_DATA(frames, "didson-hull");
  compare("calibrate", {"calibrate", frames, "--out", folder_ / "sonar"});
  for (const std::string& field : page_.never_came_out("calibrate")) {
    EXPECT_THAT(field, testing::StartsWith("fan.")) << "only these need frames without marks";
  }
}

TEST_F(JsonOutput, OfServe) {
  const ProgramResult result = in_bash(
      "\"$0\" serve --port 0 --speed max --json --out \"$1\" > \"$2\" & page=$!\n"
      "until (($(wc -l < \"$2\") >= 2)) || ! kill -0 $page 2> /dev/null; do sleep 0.05; done\n"
      "kill -TERM $page; wait $page",
      {folder_ / "out", folder_ / "lines"});
  if (result.err.find("without the live page") != std::string::npos) GTEST_SKIP() << "the program has no live page";
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::istringstream lines(content_of(folder_ / "lines"));
  for (const char* section : {"serve, when the page is up", "serve, after the run"}) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line)) << section;
    const json object = json::parse(line, nullptr, false);
    page_.compare(section, object);
    EXPECT_EQ(object["event"], section == std::string("serve, after the run") ? "finished" : "serving");
  }
}

TEST_F(JsonOutput, OfSimAndOfInfoAndConvertOfItsLog) {
  const fs::path log = folder_ / "log.mcap";
  compare("sim", {"sim", "--out", log, "--picture", folder_ / "scene.png", "--duration", "10"});
  EXPECT_THAT(page_.never_came_out("sim"), IsEmpty());
  compare("info of a log", {"info", log});
  std::string cut = content_of(log);
  compare("info of a log", {"info", file("cut.mcap", cut.substr(0, cut.size() * 2 / 3))});
  compare("info of a log", {"info", file("depths.csv", "t_s,lat,lon,depth_m\n0,54,10,3\n1,54.0001,10,4\n"), "--set",
                            "input.csv_columns=time=t_s,latitude=lat,longitude=lon,depth=depth_m"});
  compare("convert to a log", {"convert", log, folder_ / "copy.mcap"});
}

TEST_F(JsonOutput, OfADepthMapAndOfWhatIsMadeOfIt) {
  const fs::path map = lake();
  compare("info of a depth map", {"info", map});
  compare("info of a depth map", {"info", map, "--changes"});
  compare("convert to a raster", {"convert", map, folder_ / "lake.tif"});
  compare("crosscheck", {"crosscheck", map, scenario("winnipesaukee"), "--out", folder_ / "check", "--set",
                         "simulation.duration_s=20"});
  crossed_map();
  compare("info of a depth map", {"info", folder_ / "crossed"});
  compare("crosscheck", with_columns({"crosscheck", folder_ / "crossed", boat(3)}));
  compare("path", {"path", map, "60,-80", "20,-80", "--metres", "--draught", "2"}, 1);
  compare("path", {"path", map, "43.6,-71.33", "43.60001,-71.33", "--objects-within", "500"});
  const fs::path threats = file("threats.geojson", R"({"type":"Feature","properties":{"detection":0.5},"geometry":)"
                                                   R"({"type":"Polygon","coordinates":[[[-71.34,43.59],[-71.32,43.59],)"
                                                   R"([-71.32,43.61],[-71.34,43.59]]]}})");
  compare("path", {"path", map, "43.6,-71.33", "43.60001,-71.33", "--vehicles", "2", "--threats", threats, "--find"});
  const fs::path chart = source_folder() / "scenarios" / "charted_shoals.asc";
  compare("convert to a map", {"convert", chart, folder_ / "chart", "--set", "prior.epsg=4326", "--set",
                               "prior.sign=down", "--set", "prior.datum_offset_m=[0]"});
}

TEST_F(JsonOutput, OfCompareAndOfTheStudies) {
  const fs::path log = file("wall.csv", wall_csv(200));
  compare("compare", {"compare", log, log, "--out", folder_ / "compare"});
  EXPECT_THAT(page_.never_came_out("compare"), IsEmpty());
  compare("helix", {"helix", "--out", folder_ / "helix", "--set", "approach.images=2"});
  EXPECT_THAT(page_.never_came_out("helix"), IsEmpty());
  compare("delay", {"delay", "--seeds", "1", "--readings", "50", "--out", folder_ / "delay"});
  EXPECT_THAT(page_.never_came_out("delay"), IsEmpty());
  compare("sphere", {"sphere", scenario("polygon_room"), "--scans", "3", "--drift", "1", "--closer", "2", "--out",
                     folder_ / "sphere"});
  EXPECT_THAT(page_.never_came_out("sphere"), IsEmpty());
  const fs::path cameras = source_folder() / "scenarios" / "cameras";
  for (const char* rig : {"pair_256.toml", "moving_camera.toml"}) {
    compare("stereo", {"stereo", "--scene", cameras / "reef_wall.toml", "--calibration", cameras / rig, "--out",
                       folder_ / "stereo", "--set", "motion_stereo.every=8"});
  }
  EXPECT_THAT(page_.never_came_out("stereo"), IsEmpty());
  std::string boat = "time,north,east,id,course_deg,speed_mps\nnever,0,0,a,0,1\n";
  for (int t = 0; t < 20; ++t) boat += std::to_string(t) + ',' + std::to_string(t) + ",0,a,0,1\n";
  compare("track", {"track", file("boat.csv", boat), "--out", folder_ / "track"});
  EXPECT_THAT(page_.never_came_out("track"), IsEmpty());
  compare("traffic", {"traffic", "--bodies", "20", "--speed", "1", "--runs", "8", "--planner", "straight", "--out",
                      folder_ / "traffic"});
  EXPECT_THAT(page_.never_came_out("traffic"), IsEmpty());
}

TEST_F(JsonOutput, OfEval) {
  file("pole.toml", kPoleScene);
  const fs::path suite = file("small.toml",
                              "[suite]\nscene = \"pole.toml\"\nduration_s = 20\nruns = 1\n"
                              "altimeter = \"without\"\n[bars]\npath_ratio_median = 0.1\n"
                              "[[baseline]]\nhelm = \"no avoidance\"\n");
  compare("eval", {"eval", suite, "--out", folder_ / "out"}, 1);
  const fs::path told = file("story.toml",
                             "[suite]\nscene = \"pole.toml\"\nduration_s = 20\nruns = 1\n"
                             "[[stage]]\nname = \"seen\"\nat = [26, 0.3]\n"
                             "[[stage]]\nname = \"elsewhere\"\nat = [0, 90]\n");
  compare("eval", {"eval", told, "--out", folder_ / "story"});
  for (const std::string& field : page_.never_came_out("eval")) {
    EXPECT_THAT(field,
                testing::ContainsRegex(
                    "^(faults|story.clearance_of_injected_m|(baselines.\\*.|variants.\\*.)?(reasons|spreads|group))"))
        << "only these need faults, refusals, reached goals and groups (group_test.cpp)";
  }
}

TEST_F(JsonOutput, OfSettings) {
  compare("settings", {"config"});
  compare("settings", {"helix", "--settings"});
  compare("settings", {"stereo", "--settings"});
  compare("settings", {"track", "--settings"});
  compare("settings", {"sim", "--format"});
  const json plain = printed({"config", "--plain", "--set", "input.sound_speed=1475"});
  EXPECT_EQ(plain["input"]["sound_speed"], 1475);
  EXPECT_EQ(plain["echoes"]["method"], "auto");
  const json all = printed({"config"});
  EXPECT_EQ(all["input"]["sound_speed"]["unit"], "m/s");
  EXPECT_EQ(all.size(), plain.size());
}

}  // namespace
}  // namespace isobath
