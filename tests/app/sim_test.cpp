// isobath sim, and isobath run on a scene, as a user meets them.
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kSmall =
    "[scene]\ntitle = \"small\"\nduration_s = 5\n[vehicle]\nstart = [0, 0, 5]\n"
    "[[sonar]]\npreset = \"didson\"\nbins = 200\n[[sphere]]\ncentre = [6, 0, 5]\n";

TEST(Sim, WritesALogThatInfoAndRunUnderstand) {
  const fs::path folder = scratch_folder();
  const ProgramResult made =
      test::isobath({"sim", write(folder / "small.toml", kSmall), "--out", folder / "small.mcap"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("small, seed 1: 26 pings"));
  const ProgramResult info = test::isobath({"info", folder / "small.mcap", "--json"});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  const ProgramResult run = isobath_run(folder / "small.mcap", folder / "out");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["counts"]["pings"], 26);
  EXPECT_TRUE(nlohmann::json::parse(run.out)["rejected"].empty()) << "truth is passed over in silence";
}

TEST(Sim, SameSceneAndSeedGiveTheSameBytesOnOneThreadAndOnTwo) {
  const fs::path folder = scratch_folder(), scene = write(folder / "small.toml", kSmall);
  const auto log_of = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"sim", scene, "--out", folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(test::isobath(arguments).exit_code, 0);
    return content_of(folder / name);
  };
  const std::string one = log_of("one.mcap", {"--threads", "1"});
  EXPECT_EQ(log_of("again.mcap", {"--threads", "1"}), one);
  EXPECT_EQ(log_of("two.mcap", {"--threads", "2"}), one);
  EXPECT_NE(log_of("other.mcap", {"--seed", "2"}), one);
}

// Without its velocity log a vehicle moves its map by dead reckoning, and all else stays as it is; a payload is one
// table more.
// ledger: S6-22 S6-73
TEST(Sim, ASectionOfTheVehicleIsATableOfItsFile) {
  const fs::path folder = scratch_folder();
  const std::string vehicle =
      kSmall +
      "[bottom]\nkind = \"terrain\"\nmaterial = \"sand\"\ndepth = 30\nextent_m = 100\ncell_m = 5\n"
      "relief_m = 0\n[navigation]\nkind = \"sensors\"\n";
  const auto counts_of = [&](const std::string& name, const std::string& more) {
    const ProgramResult run = isobath_run(write(folder / (name + ".toml"), vehicle + more), folder / name);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out)["counts"];
  };
  const auto whole = counts_of("whole", ""), no_log = counts_of("no_log", "[dvl]\non = false\n");
  const auto payload = counts_of("payload", "[[sonar]]\npreset = \"altimeter\"\n");
  EXPECT_EQ(whole["pings_dead_reckoned"], 0);
  EXPECT_GT(no_log["pings_dead_reckoned"], no_log["pings"].get<int>() / 2) << "all but the first second";
  for (const char* same : {"pings", "navigation", "scans", "ranges", "bins"}) EXPECT_EQ(no_log[same], whole[same]);
  EXPECT_EQ(whole["ranges"], 0);
  EXPECT_GT(payload["ranges"], 10);
  for (const char* same : {"pings", "navigation", "scans"}) EXPECT_EQ(payload[same], whole[same]);
}

// A heading that only a noisy gyro knows blurs the map along circles, farther off the more.
// ledger: S6-68
TEST(Sim, WithoutACompassWhatWasHeardFades) {
  const fs::path folder = scratch_folder();
  const std::string pandan = content_of(source_folder() / "scenarios/pandan.toml");
  const auto pieces = [&](const std::string& more, const std::string& kind) {
    const ProgramResult run = isobath_run(write(folder / "s.toml", pandan + more), folder / "out",
                                          {"--set", "simulation.duration_s=25", "--set", "motion.kind=" + kind});
    EXPECT_EQ(run.exit_code, 1) << "the mission is still under way: " << run.err;
    return nlohmann::json::parse(run.out)["truth"]["obstacles"]["all"].get<int>();
  };
  const std::string lost = "[compass]\non = false\n[gyro]\nnoise = 0.05\n";
  EXPECT_LT(pieces(lost, "auto"), pieces(lost, "deterministic") / 2);
}

// ledger: S6-D04
TEST(Sim, ARunOfASceneSaysWhatTheTruthIs) {
  const fs::path out = scratch_folder() / "out";
  const ProgramResult result = isobath_run({}, out);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto truth = json_of(out / "truth.json");
  EXPECT_EQ(nlohmann::json::parse(result.out)["truth"], truth);
  bool buoy = false;
  for (const auto& body : truth["bodies"]) {
    if (body["name"] != "buoy B" || body["scans_found"] == 0) continue;
    buoy = true;
    EXPECT_LT(std::abs(body["range_error_mean_m"].get<double>()), 1.2);
    EXPECT_GT(body["delay_pings"].get<int>(), 0);
  }
  EXPECT_TRUE(buoy);
  EXPECT_GE(truth["obstacles"]["false_alarms"].get<int>(), 0);
  const std::string report = content_of(out / "report.html");
  EXPECT_THAT(report, AllOf(HasSubstr("Comparison with ground truth"), HasSubstr("<td>buoy B</td>")));
}

// In the noise of the sea and half a minute: the three heads of the reef, the coral and the marker are heard and found;
// the last scan, the grid and the detections are pictures. ledger: S6-D04
TEST(Sim, ARunAlongTheReefMapsIt) {
  const fs::path out = scratch_folder() / "out";
  const ProgramResult run =
      isobath_run(source_folder() / "scenarios/coral_reef.toml", out,
                  {"--set", "simulation.duration_s=35", "--set", "sphere.keep=false", "--set", "report.replay=false"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto truth = json_of(out / "truth.json");
  std::vector<std::string> found;
  for (const auto& body : truth["bodies"]) {
    if (body["scans_found"] > 0) found.push_back(body["name"]);
  }
  EXPECT_THAT(found,
              testing::UnorderedElementsAre("reef north", "reef east", "reef south", "coral head", "reef marker"));
  const auto& obstacles = truth["obstacles"];
  EXPECT_GT(obstacles["of_bodies"].get<int>(), 2 * obstacles["false_alarms"].get<int>());
  for (const char* picture : {"sonar.png", "occupancy.png", "detections.png"}) {
    EXPECT_THAT(content_of(out / picture), StartsWith("\x89PNG")) << picture;
  }
}

TEST(Sim, TheFormatThatItPrintsIsASceneButForItsFiles) {
  const ProgramResult page = test::isobath({"sim", "--format"});
  EXPECT_EQ(page.exit_code, 0);
  EXPECT_THAT(page.out, AllOf(StartsWith("# The scene.\n[scene]\n"), HasSubstr("[[sonar]]"), HasSubstr("[[fault]]"),
                              HasSubstr("dB re 1 uPa")));
}

TEST(Sim, DrawsTheSceneFromAbove) {
  const fs::path folder = scratch_folder();
  EXPECT_EQ(test::isobath({"sim", write(folder / "s.toml", kSmall), "--picture", folder / "s.png"}).exit_code, 0);
  EXPECT_THAT(content_of(folder / "s.png"), StartsWith("\x89PNG"));
}

struct Wrong {
  const char *toml, *words;
  friend std::ostream& operator<<(std::ostream& out, const Wrong& wrong) { return out << wrong.words; }
};
class WrongScene : public testing::TestWithParam<Wrong> {};
INSTANTIATE_TEST_SUITE_P(
    All, WrongScene,
    testing::Values(Wrong{"[scene]\ntitel = \"x\"\n", "s.toml:2:1: scene.titel: unknown key; did you mean title?"},
                    Wrong{"[scene]\n[[mesh]]\nfile = \"none.stl\"\n", "s.toml:2:1: mesh.file: no such file"},
                    Wrong{"[scene]\n[vehicle]\nstart = [0, 0, 3]\n[[sphere]]\ncentre = [0, 0, 3]\n",
                          "s.toml:4:1: sphere: sphere 1 is inside the vehicle"},
                    Wrong{"[scene]\n[[sonar]]\nbeams = 0\n",
                          "s.toml:3:9: sonar.beams: 0 is out of range; allowed: 1 .. 4096"},
                    Wrong{"[scene\n", "s.toml:1:"}));

TEST_P(WrongScene, IsRefusedInOneLineWithFileLineAndColumn) {
  const fs::path folder = scratch_folder(), scene = write(folder / "s.toml", GetParam().toml);
  for (const char* command : {"sim", "run"}) {
    std::vector<std::string> arguments{command, scene};
    if (std::string(command) == "run") arguments.insert(arguments.end(), {"--out", folder / "out"});
    EXPECT_THAT(test::isobath(arguments), ends_with_one_line(HasSubstr(GetParam().words)));
  }
}

TEST(Sim, ABottomWithHolesIsRefused) {
  const fs::path folder = scratch_folder();
  // A net of 4 x 4 squares without the one in the middle.
  std::string obj;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) obj += "v " + std::to_string(10 * i) + " " + std::to_string(10 * j) + " -10\n";
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (i == 2 && j == 1) continue;
      const int a = 5 * i + j + 1;
      obj += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(a + 6) + " " +
             std::to_string(a + 5) + "\n";
    }
  }
  write(folder / "bed.obj", obj);
  const fs::path scene = write(folder / "s.toml", "[scene]\n[bottom]\nkind = \"mesh\"\nfile = \"bed.obj\"\n");
  EXPECT_THAT(test::isobath({"sim", scene}),
              ends_with_one_line(HasSubstr("s.toml:2:1: bottom.file: the bottom has holes")));
}

TEST(Sim, WrongUseIsRefusedInOneLine) {
  EXPECT_THAT(test::isobath({"sim", "--speed", "fast"}), ends_with_one_line(HasSubstr("not a speed: fast")));
  EXPECT_THAT(test::isobath({"sim", "--out", "log.bag"}), ends_with_one_line(HasSubstr(".mcap")));
  EXPECT_THAT(test::isobath({"sim", "no/such.toml"}), ends_with_one_line(HasSubstr("no/such.toml: no such file")));
}

}  // namespace
}  // namespace isobath
