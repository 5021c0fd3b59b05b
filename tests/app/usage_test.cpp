// What the program says about itself: help, version, and a configuration that explains every key.
#include <nlohmann/json.hpp>
#include <sstream>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
using test::ends_with_one_line, test::write;
using testing::HasSubstr, testing::StartsWith;

const std::vector<std::string> kCommands{
    "run",        "serve", "setup",     "aboard",  "stand-in", "sim",    "eval",   "info",   "convert", "compare",
    "crosscheck", "path",  "calibrate", "control", "helix",    "sphere", "stereo", "config", "help"};

TEST(Usage, HelpAndVersion) {
  const std::string overview = test::isobath({"--help"}).out;
  for (const std::string& command : kCommands) {
    const auto result = test::isobath({command, "--help"});
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_EQ(result.err, "");
    EXPECT_THAT(result.out, HasSubstr("Usage: isobath " + command + " [OPTIONS]"));
    EXPECT_THAT(result.out, HasSubstr("-h, --help"));
    EXPECT_THAT(overview, HasSubstr("\n  " + command + " "));
  }
  for (const char* code : {"0    ", "1    ", "2    "}) EXPECT_THAT(overview, HasSubstr(std::string("\n  ") + code));
  const auto version = test::isobath({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out,
              testing::MatchesRegex("isobath [0-9]+\\.[0-9]+\\.[0-9]+ \\(.*commit.*, .* [0-9]+\\..*, .+\\)\n"));
}

TEST(Usage, HelpIsACommandToo) {
  EXPECT_EQ(test::isobath({"help", "run"}).out, test::isobath({"run", "--help"}).out);
  EXPECT_EQ(test::isobath({"help"}).out, test::isobath({"--help"}).out);
  EXPECT_THAT(test::isobath({"help", "fly"}), ends_with_one_line(HasSubstr("'fly'; see isobath help")));
  EXPECT_THAT(test::isobath({"help", "rnu"}), ends_with_one_line(HasSubstr("did you mean run?")));
}

TEST(Usage, EachHelpFitsATerminalAndHasExamplesOfOptionsThatExist) {
  for (const std::string& command : kCommands) {
    const std::string help = test::isobath({"help", command}).out;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_TRUE(line.size() <= 80 || line.starts_with("  isobath ")) << line;
    }
    const std::size_t at = help.find("\nExamples:\n");
    ASSERT_NE(at, std::string::npos) << command;
    std::istringstream examples(help.substr(at + 11));
    int count = 0;
    for (std::string line; std::getline(examples, line); ++count) {
      EXPECT_THAT(line, StartsWith("  isobath " + command));
      std::istringstream words(line);
      for (std::string word; words >> word;) {
        EXPECT_TRUE(!word.starts_with("--") || help.substr(0, at).find(word) != std::string::npos) << line;
      }
    }
    EXPECT_GE(count, 2) << command;
  }
}

TEST(Usage, DefaultsAreStatedOnce) {
  for (const std::string& command : kCommands) {
    std::string help = test::isobath({"help", command}).out;
    while (help.find('[') != std::string::npos) help.erase(help.find('['), help.find(']') - help.find('[') + 1);
    EXPECT_THAT(help, testing::Not(HasSubstr("default:"))) << command;
  }
}

struct Mistyped {
  std::vector<std::string> arguments;
  std::string meant;
};

TEST(Usage, AMistypedNameNamesTheNearest) {
  const auto folder = test::scratch_folder();
  const std::string out = folder / "out", scenarios = (test::source_folder() / "scenarios").string();
  const auto scene = [&](const std::string& name, const std::string& text) {
    return write(folder / name, "[scene]\nduration_s = 1\n[vehicle]\nstart = [0, 0, 5]\n" + text).string();
  };
  const Mistyped all[] = {
      {{"sevre"}, "no command is called 'sevre'; did you mean serve?"},
      {{"rnu", "--jsn"}, "no command is called 'rnu'; did you mean run?"},
      {{"--verison"}, "isobath has no option --verison; did you mean --version?"},
      {{"run", "--thread", "1"}, "run has no option --thread; did you mean --threads?"},
      {{"run", "--set", "sonar.rnage=3"}, "did you mean sensor?"},
      {{"run", "--set", "sensor.modle=x"}, "did you mean model?"},
      {{"run", "--set", "sound_speed=1400"}, "did you mean input.sound_speed?"},
      {{"run", "--set", "echoes.method=cell"}, "did you mean cells?"},
      {{"helix", "--set", "helix.advnce=3"}, "did you mean advance?"},
      {{"serve", "--limit", "max_client=3"}, "did you mean max_clients?"},
      {{"sim", "--speed", "mx"}, "did you mean max?"},
      {{"sphere", scenarios + "/polygon_room.toml", "--rule", "log_ods"}, "did you mean log_odds?"},
      {{"help", "--completion", "bsh"}, "did you mean bash?"},
      {{"eval", "cluter-low", "--out", out}, "did you mean clutter-low?"},
      {{"eval", "imaging-low", "--out", out, "--variant", "remus10/altimeter"}, "did you mean remus100/altimeter?"},
      {{"run", scenarios + "/pandna.toml"}, "did you mean " + scenarios + "/pandan.toml?"},
      {{"helix", "--vehicle", scenarios + "/../vehicles/remus.toml"}, "vehicles/remus100.toml?"},
      {{"sim", scene("a.toml", "[[sonar]]\npreset = \"oculus_m750\"\n")}, "did you mean oculus_m750d?"},
      {{"sim", scene("b.toml", "[[sonar]]\nprest = \"micron\"\n")}, "did you mean preset?"},
      {{"sim", scene("c.toml", "file = \"a.tom\"\n")}, "a.toml?"},
      {{"sim", scene("d.toml", "[[cylinder]]\nmaterial = \"stel\"\n")}, "did you mean steel?"},
      {{"sim", scene("e.toml", "[[fault]]\nsource = \"compas\"\nkind = \"off\"\n")}, "did you mean compass?"},
      {{"run", scene("f.toml", "[[sonar]]\nname = \"bow\"\n"), "--out", out, "--set", "simulation.without=bows"},
       "did you mean bow?"}};
  for (const Mistyped& one : all) {
    EXPECT_THAT(test::isobath(one.arguments), ends_with_one_line(HasSubstr(one.meant))) << one.arguments.back();
  }
  EXPECT_THAT(test::isobath({"run", "--no-such-option"}).err, testing::Not(HasSubstr("did you mean")));
}

TEST(Usage, OptionsThatCannotBeUsedSayWhatIsAllowed) {
  EXPECT_THAT(test::isobath({"run", "--threads", "many"}),
              ends_with_one_line(HasSubstr("--threads: many is not a whole number; allowed: 1 .. 64")));
  EXPECT_THAT(test::isobath({"run", "--out"}), ends_with_one_line(HasSubstr("--out needs a value")));
  EXPECT_THAT(test::isobath({"run", "--out", "a", "--out", "b"}), ends_with_one_line(HasSubstr("given 2 times")));
  EXPECT_THAT(test::isobath({"run", "--speed", "3"}), ends_with_one_line(HasSubstr("--speed requires --live")));
  EXPECT_THAT(test::isobath({"info"}), ends_with_one_line(HasSubstr("FILE is required; see isobath info --help")));
  EXPECT_THAT(test::isobath({"config", "more"}), ends_with_one_line(HasSubstr("no further argument: 'more'")));
}

TEST(Usage, OutputThatCannotBeWrittenIsAnError) {
  for (const char* command : {"config", "config --json", "--version", "--help", "help --man", "help run"}) {
    EXPECT_THAT(test::in_bash(std::string("\"$0\" ") + command + " > /dev/full"),
                ends_with_one_line(HasSubstr("cannot write to standard output: No space left on device")))
        << command;
  }
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
