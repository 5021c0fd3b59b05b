// What the program says about itself: help, version, and a configuration that explains every key.
#include <nlohmann/json.hpp>
#include <sstream>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
using test::write;
using testing::HasSubstr, testing::StartsWith;

TEST(Usage, HelpAndVersion) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{{"--help"},
                                                                                         {"run", "--help"},
                                                                                         {"info", "--help"},
                                                                                         {"convert", "--help"},
                                                                                         {"calibrate", "--help"},
                                                                                         {"compare", "--help"},
                                                                                         {"helix", "--help"},
                                                                                         {"config", "--help"}}) {
    const auto result = test::isobath(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments[0];
    EXPECT_EQ(result.err, "");
    EXPECT_THAT(result.out, HasSubstr("--help"));
  }
  for (const char* command : {"run", "info", "convert", "calibrate", "compare", "helix", "config"}) {
    EXPECT_THAT(test::isobath({"--help"}).out, HasSubstr(command));
  }
  const auto version = test::isobath({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out,
              testing::MatchesRegex("isobath [0-9]+\\.[0-9]+\\.[0-9]+ \\(.*commit.*, .* [0-9]+\\..*\\)\n"));
}

TEST(Usage, HelpIsACommandToo) {
  EXPECT_EQ(test::isobath({"help", "run"}).out, test::isobath({"run", "--help"}).out);
  EXPECT_EQ(test::isobath({"help"}).out, test::isobath({"--help"}).out);
  EXPECT_EQ(test::isobath({"help", "fly"}).exit_code, 2);
}

TEST(Usage, AMistypedCommandNamesTheNearest) {
  const auto result = test::isobath({"sevre"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("no command is called 'sevre'; did you mean serve?"));
  EXPECT_THAT(test::isobath({"run", "--no-such-option"}).err, testing::Not(HasSubstr("did you mean")));
}

TEST(Usage, WithJsonAnErrorIsAnObjectToo) {
  const auto folder = test::scratch_folder();
  const auto file = write(folder / "bad.toml", "[echoes]\nfalse_alarn = 0.1\n");
  const auto result = test::isobath({"run", "--json", "--config", file, "--out", folder / "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("did you mean false_alarm?"));
  const auto error = nlohmann::json::parse(result.out)["error"];
  EXPECT_THAT(error["problem"].get<std::string>(), HasSubstr("false_alarm"));
  EXPECT_EQ(error["key"], "echoes.false_alarn");
  EXPECT_EQ(error["line"], 2);
}

TEST(Usage, ConfigurationThatIsPrintedIsAValidConfiguration) {
  const auto folder = test::scratch_folder();
  const auto printed = test::isobath({"config"});
  EXPECT_EQ(printed.exit_code, 0);
  const auto again = test::isobath({"config", "--config", write(folder / "all.toml", printed.out)});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, printed.out);
  const auto plain = test::isobath({"config", "--plain"});
  EXPECT_EQ(plain.out.find('#'), std::string::npos);
  EXPECT_EQ(test::isobath({"config", "--config", write(folder / "plain.toml", plain.out)}).out, printed.out);
}

TEST(Usage, EverySectionAndKeyHasASentence) {
  std::istringstream lines(test::isobath({"config"}).out);
  std::string before;
  int keys = 0, sections = 0;
  for (std::string line; std::getline(lines, line); before = line) {
    if (line.empty() || line.front() == '#') continue;
    EXPECT_THAT(before, StartsWith("# ")) << line;
    EXPECT_THAT(before, testing::MatchesRegex("# .*[.].*")) << line;
    EXPECT_GT(before.size(), 15u) << line;
    ++(line.front() == '[' ? sections : keys);
  }
  EXPECT_GE(sections, 10);
  EXPECT_GE(keys, 40);
}

TEST(Usage, SettingsOverrideTheFileAndTheFileTheDefaults) {
  const auto folder = test::scratch_folder();
  const auto file = write(folder / "sea.toml", "[input]\nsound_speed = 1480\n[gate]\nmax_age_s = 3\n");
  const auto result = test::isobath({"config", "--config", file, "--set", "input.sound_speed=1475"});
  EXPECT_THAT(result.out, HasSubstr("\nsound_speed = 1475"));
  EXPECT_THAT(result.out, HasSubstr("\nmax_age_s = 3"));
  const auto empty = test::isobath({"config", "--config", write(folder / "empty.toml", "")});
  EXPECT_EQ(empty.exit_code, 0) << empty.err;
  EXPECT_EQ(empty.out, test::isobath({"config"}).out) << "an empty file changes nothing";
}

}  // namespace
}  // namespace isobath
