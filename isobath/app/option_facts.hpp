// CommandFacts: the definitions of a command as CLI11 holds them, in the order and the words in which help, man page
// and completion present them. All three are made from these facts, so that an option is stated once: where it is
// added.
#pragma once

#include <isobath/app/values.hpp>
#include <string>
#include <utility>
#include <vector>

namespace isobath::app {

/// An option or an argument.
struct OptionFacts {
  std::vector<std::string> names;  ///< "-h", "--help"; the name of an argument has no dash
  std::string value;               ///< name of its value, "FILE"; empty: a flag
  std::string text;                ///< what it does
  std::string limits;              ///< "1 .. 64; default: 2"; may be empty
  bool repeats = false;
  ValueKind kind;

  [[nodiscard]] bool is_argument() const { return !names.front().starts_with("-"); }
};

struct OptionGroup {
  std::string name;
  std::vector<OptionFacts> options;
};

struct CommandFacts {
  std::string name;  ///< "run"; empty: the program itself
  std::string text, usage;
  std::vector<OptionGroup> groups;  ///< arguments first, options without a group of their own last
  std::vector<std::string> examples;
};

CommandFacts facts_of(const CLI::App& command);

/// The commands of a program by group, as they were added: name and text.
struct CommandGroup {
  std::string name;
  std::vector<const CLI::App*> commands;
};
std::vector<CommandGroup> commands_of(const CLI::App& program);

std::vector<std::string> command_names(const CLI::App& program);
/// What is wrong with a name that no command has, with the nearest name.
std::string no_such_command(const CLI::App& program, const std::string& name);

/// Adds a line to the examples of a command: what stands behind "isobath ".
void add_example(CLI::App& command, const std::string& line);

/// Meaning of each exit code of the program, for help and man page.
std::vector<std::pair<int, std::string>> exit_codes();

}  // namespace isobath::app
