// The manual page and the completion of the shells, which the program makes from its own options.
#include <iostream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
using test::in_bash;
using testing::Contains, testing::ElementsAre, testing::HasSubstr, testing::IsEmpty, testing::Not;

/// Command -> its options, from the help.
std::map<std::string, std::set<std::string>> options_in_help() {
  std::map<std::string, std::set<std::string>> all;
  const std::string overview = test::isobath({"help"}).out;
  const std::regex command("\n  ([a-z-]+)  +[A-Z]"), option("\n  (?:-[a-z], )?(--[a-z0-9-]+)");
  for (std::sregex_iterator i(overview.begin(), overview.end(), command), end; i != end; ++i) {
    const std::string name = (*i)[1], help = test::isobath({"help", name}).out;
    for (std::sregex_iterator o(help.begin(), help.end(), option); o != end; ++o) all[name].insert((*o)[1]);
  }
  EXPECT_EQ(all.size(), 22u);
  return all;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

TEST(ManualPage, NamesEveryCommandAndOption) {
  const auto page = test::isobath({"help", "--man"});
  EXPECT_EQ(page.exit_code, 0);
  EXPECT_THAT(page.out, testing::StartsWith(".TH ISOBATH 1 "));
  const std::string text = replaced(page.out, "\\-", "-");
  for (const auto& [command, options] : options_in_help()) {
    EXPECT_THAT(text, HasSubstr("\n\\fB" + command + "\\fR\n")) << "among the commands";
    const std::size_t at = text.find(".SS isobath " + command + " ");
    ASSERT_NE(at, std::string::npos) << command;
    const std::string section = text.substr(at, text.find("\n.S", at + 1) - at);
    for (const std::string& option : options) EXPECT_THAT(section, HasSubstr("\\fB" + option + "\\fR"));
  }
  for (const char* code : {"0", "1", "2"}) EXPECT_THAT(text, HasSubstr(std::string("\n\\fB") + code + "\\fR\n"));
}

TEST(ManualPage, HasNoWarningOfGroff) {
  if (!test::has_program("groff")) GTEST_SKIP() << "groff is not installed";
  const auto result = in_bash("\"$0\" help --man | groff -man -Tutf8 -ww -rLL=78n");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, HasSubstr("isobath - A map to trust"));
}

TEST(Completion, OfEveryShellKnowsEveryCommandAndOption) {
  const auto all = options_in_help();
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    const auto script = test::isobath({"help", "--completion", shell});
    EXPECT_EQ(script.exit_code, 0);
    for (const auto& [command, options] : all) {
      EXPECT_THAT(script.out, HasSubstr(command)) << shell;
      for (const std::string& option : options) {
        EXPECT_THAT(script.out, HasSubstr(shell == "fish" ? "-l " + option.substr(2) : option));
      }
    }
  }
}

TEST(Completion, IsAScriptThatTheShellUnderstands) {
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    if (!test::has_program(shell)) {
      std::cout << "NOTICE: " << shell << " is not installed; its script is not checked\n";
      continue;
    }
    const auto folder = test::scratch_folder();
    const auto script = test::write(folder / shell, test::isobath({"help", "--completion", shell}).out);
    const auto result = test::run_program({shell, "-n", script});
    EXPECT_EQ(result.exit_code, 0) << shell;
    EXPECT_THAT(result.err, IsEmpty()) << shell;
  }
}

/// What bash offers for the last of the words.
std::vector<std::string> offered(const std::vector<std::string>& words) {
  const auto result = in_bash(
      "source <(\"$0\" help --completion bash)\n"
      "COMP_WORDS=(isobath \"$@\"); COMP_CWORD=$#\n"
      "$(complete -p isobath | sed 's/.*-F \\([^ ]*\\) .*/\\1/')\n"
      "printf '%s\\n' \"${COMPREPLY[@]}\"",
      words);
  EXPECT_THAT(result.err, IsEmpty());
  std::vector<std::string> offers;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) offers.push_back(line);
  }
  return offers;
}

TEST(Completion, OfBashOffersCommandsOptionsAndValues) {
  EXPECT_THAT(offered({"ru"}), ElementsAre("run"));
  EXPECT_THAT(offered({"c"}),
              testing::UnorderedElementsAre("convert", "compare", "crosscheck", "calibrate", "config", "control"));
  EXPECT_THAT(offered({"run", "--thr"}), ElementsAre("--threads"));
  EXPECT_THAT(offered({"path", "--thre"}), ElementsAre("--threats", "--threat-weight")) << "path has no --threads";
  EXPECT_THAT(offered({"sphere", "room.toml", "--rule", ""}), ElementsAre("log_odds", "maximum_response"));
  EXPECT_THAT(offered({"sphere", "room.toml", "--rule", "=", "m"}), ElementsAre("maximum_response"));
  EXPECT_THAT(offered({"run", "--set", "input.sound_s"}), ElementsAre("input.sound_speed="));
  EXPECT_THAT(offered({"helix", "--set", "helix.adv"}), ElementsAre("helix.advance="));
  EXPECT_THAT(offered({"help", "he"}), ElementsAre("helix", "help"));
  EXPECT_THAT(offered({"eval", "clutter-l"}), ElementsAre("clutter-low"));
  EXPECT_THAT(offered({"run", "--threads", ""}), IsEmpty()) << "a number is the user's";
}

TEST(Completion, OfBashOffersFilesAndFoldersWhereTheyAreMeant) {
  const std::string folder = test::scratch_folder();
  test::write(folder + "/settings.toml", "");
  std::filesystem::create_directories(folder + "/results");
  for (const char* option : {"--config", "--mission", "--record"}) {
    EXPECT_THAT(offered({"run", option, folder + "/s"}), ElementsAre(folder + "/settings.toml")) << option;
  }
  EXPECT_THAT(offered({"run", folder + "/s"}), ElementsAre(folder + "/settings.toml"));
  EXPECT_THAT(offered({"run", "--out", folder + "/"}), ElementsAre(folder + "/results"));
  EXPECT_THAT(offered({"path", folder + "/"}), Contains(folder + "/results"));
  EXPECT_THAT(offered({"path", folder + "/"}), Not(Contains(folder + "/settings.toml"))) << "a map is a folder";
}

}  // namespace
}  // namespace isobath
