#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/app/completion.hpp>
#include <isobath/base/error.hpp>
#include <map>

namespace isobath::app {
namespace {

using Path = ValueKind::Path;

std::vector<CommandFacts> all_commands(const CLI::App& program) {
  std::vector<CommandFacts> all;
  for (const CommandGroup& group : commands_of(program)) {
    for (const CLI::App* command : group.commands) all.push_back(facts_of(*command));
  }
  return all;
}

std::vector<OptionFacts> options_of(const CommandFacts& command, bool arguments) {
  std::vector<OptionFacts> options;
  for (const OptionGroup& group : command.groups) {
    for (const OptionFacts& option : group.options) {
      if (option.is_argument() == arguments) options.push_back(option);
    }
  }
  return options;
}

std::string completion_words(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

/// Long lists of words stand once in a script, as a variable: the settings of a configuration are those of most
/// commands.
class WordLists {
 public:
  /// `use`: how the shell uses a variable as words, with {} for its name.
  explicit WordLists(const char* use) : use_(use) {}

  /// The words, or the use of their variable.
  std::string refer(const std::vector<std::string>& words) {
    constexpr std::size_t kLong = 20;
    if (words.size() < kLong) return completion_words(words);
    const auto [found, added] = numbers_.try_emplace(completion_words(words), numbers_.size() + 1);
    return fmt::format(fmt::runtime(use_), name_of(found->second));
  }
  /// `definition`: how the shell sets a variable, with {0} for its name and {1} for the words.
  [[nodiscard]] std::string definitions(const char* definition) const {
    std::string out;
    for (const auto& [words, number] : numbers_) out += fmt::format(fmt::runtime(definition), name_of(number), words);
    return out;
  }

 private:
  static std::string name_of(std::size_t number) { return fmt::format("_isobath_names_{}", number); }
  const char* use_;
  std::map<std::string, std::size_t> numbers_;
};

bool is_folder(const ValueKind& kind) { return kind.path == Path::kReadsFolder || kind.path == Path::kWritesFolder; }

/// In single quotes; `quote` is what a single quote within becomes.
std::string in_single_quotes(const std::string& text, const char* quote) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += quote;
    } else {
      out += c;
    }
  }
  return out + "'";
}

// --- bash

/// What completes a value; ":" where nothing can be offered.
std::string bash_action(const ValueKind& kind, WordLists& lists) {
  std::string action;
  if (!kind.choices.empty()) {
    const bool goes_on = kind.choices.front().ends_with("=");
    action = fmt::format("_isobath_words \"{}\"{}", lists.refer(kind.choices), goes_on ? "; _isobath_goes_on" : "");
  }
  if (kind.path == Path::kNone) return action.empty() ? ":" : action;
  return action + (action.empty() ? "" : "; ") + (is_folder(kind) ? "_isobath_paths -d" : "_isobath_paths -f");
}

std::string bash_case(const CommandFacts& command, WordLists& lists) {
  std::map<std::string, std::vector<std::string>> values;  // action -> options
  std::vector<std::string> names;
  for (const OptionFacts& option : options_of(command, false)) {
    names.insert(names.end(), option.names.begin(), option.names.end());
    if (option.value.empty()) continue;
    auto& with_action = values[bash_action(option.kind, lists)];
    with_action.insert(with_action.end(), option.names.begin(), option.names.end());
  }
  std::string out = fmt::format("    {})\n      case $before in\n", command.name);
  for (const auto& [action, options] : values) {
    out += fmt::format("        {}) {}; return ;;\n", fmt::join(options, " | "), action);
  }
  out += "      esac\n";
  std::map<std::string, int> arguments;
  for (const OptionFacts& argument : options_of(command, true)) ++arguments[bash_action(argument.kind, lists)];
  out += fmt::format("      if [[ $current == -* ]]; then\n        _isobath_words \"{}\"\n", completion_words(names));
  if (!arguments.empty()) {
    out += "      else\n";
    for (const auto& [action, count] : arguments) out += fmt::format("        {}\n", action);
  }
  return out + "      fi\n      ;;\n";
}

std::string bash_script(const CommandFacts& program, const std::vector<CommandFacts>& commands) {
  std::vector<std::string> first;
  for (const CommandFacts& command : commands) first.push_back(command.name);
  for (const OptionFacts& option : options_of(program, false)) {
    first.insert(first.end(), option.names.begin(), option.names.end());
  }
  std::string out = R"(# bash completion of isobath; made by: isobath help --completion bash
_isobath_words() { mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -W "$1" -- "$current"); }
_isobath_paths() {
  compopt -o filenames 2> /dev/null
  mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen "$1" -- "$current")
}
_isobath_goes_on() { compopt -o nospace 2> /dev/null; }
_isobath() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  COMPREPLY=()
  if [[ $current == = ]]; then
    current=
  elif [[ $before == = ]]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  if ((COMP_CWORD == 1)); then
)";
  out += fmt::format("    _isobath_words \"{}\"\n    return\n  fi\n  case ${{COMP_WORDS[1]}} in\n",
                     completion_words(first));
  WordLists lists("${}");
  for (const CommandFacts& command : commands) out += bash_case(command, lists);
  return out + "  esac\n}\n" + lists.definitions("{0}=\"{1}\"\n") + "complete -F _isobath isobath\n";
}

// --- zsh

std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_action(const ValueKind& kind, WordLists& lists) {
  const std::string words = lists.refer(kind.choices);
  if (!kind.choices.empty() && kind.choices.front().ends_with("=")) return " compadd -S \"\" -- " + words;
  if (!kind.choices.empty() && kind.path != Path::kNone) return " _isobath_names_or_files " + words;
  if (!kind.choices.empty()) return "(" + words + ")";
  if (kind.path == Path::kNone) return " ";
  return is_folder(kind) ? "_files -/" : "_files";
}

std::string zsh_spec(const OptionFacts& option, WordLists& lists) {
  const std::string value =
      option.value.empty() ? "" : ":" + zsh_text(option.value) + ":" + zsh_action(option.kind, lists);
  if (option.is_argument()) {
    return in_single_quotes((option.repeats ? "*:" : ":") + option.names.front() + ":" + zsh_action(option.kind, lists),
                            "'\\''");
  }
  std::string out;
  const std::string rest = "[" + zsh_text(option.text) + "]" + value;
  for (const std::string& name : option.names) {
    const char* const joint = value.empty() ? "" : name.starts_with("--") ? "=" : "+";
    const std::string others = option.repeats            ? "*"
                               : option.names.size() > 1 ? "(" + completion_words(option.names) + ")"
                                                         : std::string();
    out += (out.empty() ? "" : " ") + in_single_quotes(others + name + joint + rest, "'\\''");
  }
  return out;
}

std::string zsh_script(const CommandFacts& program, const std::vector<CommandFacts>& commands) {
  std::string out = R"(#compdef isobath
# zsh completion of isobath; made by: isobath help --completion zsh
_isobath_names_or_files() { compadd -- "$@"; _files }
_isobath() {
  local context state state_descr line
  typeset -A opt_args
  _arguments -C )";
  WordLists lists("${{={}}}");
  for (const OptionFacts& option : options_of(program, false)) out += zsh_spec(option, lists) + " ";
  out += "':command:->command' '*::argument:->argument'\n  case $state in\n    command)\n      local -a commands=(\n";
  for (const CommandFacts& command : commands) {
    out += "        " + in_single_quotes(command.name + ":" + command.text, "'\\''") + "\n";
  }
  out += "      )\n      _describe command commands ;;\n    argument)\n      case $words[1] in\n";
  for (const CommandFacts& command : commands) {
    out += fmt::format("        {})\n          _arguments", command.name);
    for (const bool arguments : {false, true}) {
      for (const OptionFacts& option : options_of(command, arguments))
        out += " \\\n            " + zsh_spec(option, lists);
    }
    out += " ;;\n";
  }
  return out + "      esac ;;\n  esac\n}\n" + lists.definitions("typeset -g {0}='{1}'\n") +
         "if [[ ${funcstack[1]} == _isobath ]]; then\n  _isobath \"$@\"\nelse  # sourced\n  compdef _isobath "
         "isobath\nfi\n";
}

// --- fish

std::string fish_value(const ValueKind& kind, WordLists& lists) {
  std::string out;
  if (!kind.choices.empty()) out += " -a " + in_single_quotes(lists.refer(kind.choices), "\\'");
  if (is_folder(kind)) return out + " -a '(__fish_complete_directories)'";
  return out + (kind.path == Path::kNone ? "" : " -F");
}

std::string fish_option(const OptionFacts& option, const std::string& where, WordLists& lists) {
  std::string out = "complete -c isobath" + where;
  for (const std::string& name : option.names) {
    out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  const bool files = option.kind.path != Path::kNone && !is_folder(option.kind);
  if (!option.value.empty()) out += (files ? " -r" : " -x") + fish_value(option.kind, lists);
  return out + " -d " + in_single_quotes(option.text, "\\'") + "\n";
}

std::string fish_script(const CommandFacts& program, const std::vector<CommandFacts>& commands) {
  std::string out = "# fish completion of isobath; made by: isobath help --completion fish\ncomplete -c isobath -f\n";
  WordLists lists("${}");
  for (const OptionFacts& option : options_of(program, false))
    out += fish_option(option, " -n __fish_use_subcommand", lists);
  for (const CommandFacts& command : commands) {
    out += fmt::format("complete -c isobath -n __fish_use_subcommand -a {} -d {}\n", command.name,
                       in_single_quotes(command.text, "\\'"));
  }
  for (const CommandFacts& command : commands) {
    const std::string where = fmt::format(" -n '__fish_seen_subcommand_from {}'", command.name);
    for (const OptionFacts& option : options_of(command, false)) out += fish_option(option, where, lists);
    for (const OptionFacts& argument : options_of(command, true)) {
      const std::string value = fish_value(argument.kind, lists);
      if (!value.empty()) out += "complete -c isobath" + where + value + "\n";
    }
  }
  return out + lists.definitions("set -g {0} {1}\n");
}

}  // namespace

const std::vector<std::string>& completion_shells() {
  static const std::vector<std::string> kShells{"bash", "zsh", "fish"};
  return kShells;
}

std::string completion_script(const CLI::App& program, const std::string& shell) {
  const CommandFacts whole = facts_of(program);
  const std::vector<CommandFacts> commands = all_commands(program);
  if (shell == "bash") return bash_script(whole, commands);
  if (shell == "zsh") return zsh_script(whole, commands);
  ISOBATH_ASSERT(shell == "fish");
  return fish_script(whole, commands);
}

}  // namespace isobath::app
