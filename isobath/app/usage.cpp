#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/help_text.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/usage.hpp>
#include <isobath/app/version.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/nearest_name.hpp>
#include <isobath/base/printable_text.hpp>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <system_error>

namespace isobath::app {
namespace {

/// Prints a problem to standard error; with --json also as an object to standard output. Throws nothing.
int complain(const std::string& message, bool as_json, const Place& where = {}) {
  constexpr std::size_t kMax = 3000;  // Error bounds its parts
  const std::string problem = printable_text(message, kMax);
  std::fprintf(stderr, "isobath: %s\n", problem.c_str());
  if (!as_json) return kBadInput;
  nlohmann::ordered_json json{{"error", {{"problem", problem}}}};
  if (!where.file.empty()) json["error"]["file"] = where.file;
  if (where.line) json["error"]["line"] = *where.line;
  if (where.column) json["error"]["column"] = *where.column;
  if (where.byte) json["error"]["byte"] = *where.byte;
  if (!where.key.empty()) json["error"]["key"] = where.key;
  std::puts(json_text(json, -1).c_str());
  std::fflush(stdout);
  return kBadInput;
}

int output_failed(int number) {
  return complain(fmt::format("cannot write to standard output: {}", std::strerror(number)), false);
}

/// The exit code, unless standard output could not take all that was printed, such as on a full disk.
int unless_output_failed(int code) { return std::fflush(stdout) == 0 ? code : output_failed(errno); }

int act(const Action& action, bool as_json) {
  try {
    return unless_output_failed(action());
  } catch (const Error& e) {
    return complain(e.what(), as_json, e.where());
  } catch (const std::bad_alloc&) {
    return complain("not enough memory for this input", as_json);
  } catch (const std::system_error& e) {  // fmt::print throws it
    return std::ferror(stdout) != 0 ? output_failed(e.code().value()) : complain(e.what(), as_json);
  } catch (const std::exception& e) {
    return complain(e.what(), as_json);
  }
}

const CLI::Option* option_named(const CLI::App& command, const std::string& name) {
  const auto all = command.get_options();
  const auto found = std::find_if(all.begin(), all.end(), [&](const CLI::Option* o) { return o->check_name(name); });
  return found == all.end() ? nullptr : *found;
}

/// The first of the arguments that nothing took, with the nearest option; empty if there is none.
std::string not_taken(const CLI::App& program, const CLI::App& command) {
  const std::vector<std::string> left = command.remaining();
  if (left.empty()) return {};
  const bool no_command = &command == &program;
  auto word = std::find_if(left.begin(), left.end(), [](const auto& w) { return w.starts_with("-"); });
  if (no_command || word == left.end()) word = left.begin();
  if (!word->starts_with("-")) {
    return no_command ? no_such_command(program, *word)
                      : fmt::format("{} takes no further argument: '{}'", command.get_name(), *word);
  }
  std::vector<std::string> names;
  for (const CLI::Option* known : command.get_options()) {
    for (const std::string& name : known->get_lnames()) names.push_back("--" + name);
  }
  const std::string name = word->substr(0, word->find('='));
  const std::string near = did_you_mean(name, names);
  return fmt::format("{} has no option {}{}{}", no_command ? "isobath" : command.get_name(), name,
                     near.empty() ? "" : "; ", near);
}

/// What is wrong with a command line that CLI11 refused, without the way to the help.
std::string usage_problem(const CLI::ParseError& refusal, const CLI::App& program, const CLI::App& command) {
  if (const std::string problem = not_taken(program, command); !problem.empty()) return problem;
  const std::string text = refusal.what();
  if (dynamic_cast<const CLI::RequiredError*>(&refusal) != nullptr) {
    if (&command == &program) return "a command is missing";
    return fmt::format("{}: {}", command.get_name(), text);
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&refusal) == nullptr) return text;
  const std::string name = text.substr(0, text.find(':'));
  const CLI::Option* const option = option_named(command, name);
  if (option == nullptr) return text;
  if (option->results().size() > 1)
    return fmt::format("{} is given {} times, allowed: once", name, option->results().size());
  return fmt::format("{} needs a value", name);
}

std::string problem_of(const CLI::ParseError& refusal, const CLI::App& program, const CLI::App& command) {
  const std::string text = usage_problem(refusal, program, command);
  if (dynamic_cast<const CLI::ValidationError*>(&refusal) != nullptr) return text;  // it names what is allowed
  return fmt::format("{}; see isobath {}--help", text, &command == &program ? "" : command.get_name() + " ");
}

bool wants_json(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc, [](const char* word) { return std::strcmp(word, "--json") == 0; });
}

int print_version(bool as_json) {
  if (as_json) {
    const std::string commit = kCommit;
    print_json({{"version", ISOBATH_VERSION},
                {"commit", commit.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(commit)},
                {"compiler", kCompiler},
                {"build_type", kBuildType}});
  } else {
    fmt::print("isobath {} ({}, {}, {})\n", ISOBATH_VERSION,
               *kCommit == '\0' ? "no commit" : fmt::format("commit {}", kCommit), kCompiler, kBuildType);
  }
  return kSuccess;
}

/// The command that was given, else the program.
const CLI::App& given_command(const CLI::App& program) {
  const std::vector<CLI::App*> given = program.get_subcommands();
  return given.empty() ? program : *given.front();
}

}  // namespace

int run_program(int argc, char** argv) {
  CLI::App program{"A map to trust and a path to follow, from sonar, in real time", "isobath"};
  program.formatter(std::make_shared<CLI::FormatterLambda>(
      [](const CLI::App* about, const std::string&, CLI::AppFormatMode) { return help_text(*about); }));
  program.set_help_flag("-h,--help", "Print this help and exit");
  program.set_version_flag("--version", "")->description("Print version, commit, compiler and build type, and exit");
  program.add_flag("--json")->description("With --version: one JSON object on standard output");
  program.require_subcommand(1);
  const bool as_json = wants_json(argc, argv);
  const std::vector<Command> commands = add_commands(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::CallForVersion&) {
    return act([&] { return print_version(as_json); }, as_json);
  } catch (const CLI::ParseError& refusal) {
    const CLI::App& command = given_command(program);
    if (refusal.get_exit_code() == 0) {  // --help
      return act([&] { return fmt::print("{}", help_text(command)), kSuccess; }, as_json);
    }
    return complain(problem_of(refusal, program, command), as_json);
  }
  const auto given = std::find_if(commands.begin(), commands.end(), [](const Command& c) { return c.app->parsed(); });
  return act(
      [&] {
        check_paths(*given->app);
        return given->action();
      },
      as_json);
}

}  // namespace isobath::app
