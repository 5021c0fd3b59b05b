#include <algorithm>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/version.hpp>
#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <new>
#include <nlohmann/json.hpp>

namespace {

using isobath::app::Action;
using Commands = std::vector<std::pair<CLI::App*, Action>>;

/// Prints a problem to standard error; with --json also as an object to standard output.
int complain(const std::string& problem, bool as_json, const isobath::Place& where = {}) {
  fmt::print(stderr, "isobath: {}\n", problem);
  if (as_json) {
    nlohmann::ordered_json json{{"error", {{"problem", problem}}}};
    if (!where.file.empty()) json["error"]["file"] = where.file;
    if (where.line) json["error"]["line"] = *where.line;
    if (where.byte) json["error"]["byte"] = *where.byte;
    if (!where.key.empty()) json["error"]["key"] = where.key;
    isobath::app::print_json(json);
  }
  return isobath::app::kBadInput;
}

int act(const Action& action, bool as_json) {
  try {
    return action();
  } catch (const isobath::Error& e) {
    return complain(e.what(), as_json, e.where());
  } catch (const std::bad_alloc&) {
    return complain("not enough memory for this input", as_json);
  } catch (const std::exception& e) {
    return complain(e.what(), as_json);
  }
}

/// If the first argument is not a command: a message that names the nearest command; else empty.
std::string no_such_command(const Commands& commands, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return "";
  std::vector<std::string> names{"help"};
  for (const auto& [command, action] : commands) names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), argv[1]) != names.end()) return "";
  return fmt::format("no command is called '{}'; {}", argv[1], isobath::did_you_mean(argv[1], names));
}

int run_program(int argc, char** argv) {
  CLI::App program{"Isobath: a map to trust and a path to follow, from sonar, in real time.", "isobath"};
  program.set_version_flag(
      "--version", fmt::format("isobath {} ({}, {})", ISOBATH_VERSION, isobath::app::kCommit, isobath::app::kCompiler));
  program.require_subcommand(1);
  Commands commands;
  const auto add = [&](Action (*make)(CLI::App&)) {
    Action action = make(program);
    commands.emplace_back(program.get_subcommands({}).back(), std::move(action));
  };
  for (auto* make : {isobath::app::add_run, isobath::app::add_serve, isobath::app::add_sim, isobath::app::add_info,
                     isobath::app::add_convert, isobath::app::add_calibrate, isobath::app::add_compare,
                     isobath::app::add_crosscheck, isobath::app::add_path, isobath::app::add_helix,
                     isobath::app::add_sphere, isobath::app::add_eval, isobath::app::add_config}) {
    add(make);
  }
  std::string about;
  CLI::App* help = program.add_subcommand("help", "Print the help of the program or of one command");
  help->add_option("COMMAND", about, "run, serve, ...");
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return program.exit(e);  // --help, --version
    const std::string unknown = no_such_command(commands, argc, argv);
    return complain(fmt::format("{}; see isobath --help", unknown.empty() ? e.what() : unknown), false);
  }
  for (auto& [command, action] : commands) {
    if (!command->parsed()) continue;
    const CLI::Option* json = command->get_option_no_throw("--json");
    return act(action, json && json->count() > 0);
  }
  const auto told = std::find_if(commands.begin(), commands.end(),
                                 [&](const auto& command) { return command.first->get_name() == about; });
  if (!about.empty() && told == commands.end()) return complain(fmt::format("no command is called '{}'", about), false);
  const CLI::App* told_of = about.empty() ? &program : told->first;
  fmt::print("{}", program.get_formatter()->make_help(told_of, "isobath" + (about.empty() ? "" : " " + about),
                                                      CLI::AppFormatMode::Normal));
  return isobath::app::kSuccess;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_program(argc, argv);
  } catch (const std::exception& e) {  // not complain(), which may throw
    std::fprintf(stderr, "isobath: %s\n", e.what());
  } catch (...) {
    std::fputs("isobath: an unknown error\n", stderr);
  }
  return isobath::app::kBadInput;
}
