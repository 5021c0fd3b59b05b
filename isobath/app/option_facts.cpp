#include <algorithm>
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <isobath/app/exit_codes.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/base/nearest_name.hpp>

namespace isobath::app {
namespace {

constexpr const char *kArguments = "Arguments", *kOptions = "Options";

OptionFacts facts_of_option(const CLI::Option& option) {
  OptionFacts facts;
  for (const std::string& name : option.get_snames()) facts.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) facts.names.push_back("--" + name);
  if (facts.names.empty()) facts.names.push_back(option.get_name(true));
  const bool flag = option.get_items_expected_max() == 0 || option.get_type_size() == 0;
  if (!flag) {
    const std::string type = option.get_type_name();
    facts.value = type.substr(0, type.find(':'));
    if (facts.value == "INT" || facts.value == "FLOAT") facts.value = "NUMBER";
    facts.repeats = option.get_items_expected_max() > 1;
    facts.kind = kind_of(option);
  }
  facts.text = option.get_description();
  std::vector<std::string> limits;
  if (!facts.kind.range.empty()) limits.push_back(facts.kind.range);
  if (!facts.kind.choices.empty() && !facts.kind.others) {
    limits.push_back(fmt::format("{}", fmt::join(facts.kind.choices, ", ")));
  }
  if (!flag && !option.get_default_str().empty()) limits.push_back("default: " + option.get_default_str());
  for (const CLI::Option* needed : option.get_needs()) limits.push_back("only with " + needed->get_name());
  if (facts.repeats && !facts.is_argument()) limits.emplace_back("may be repeated");
  facts.limits = fmt::format("{}", fmt::join(limits, "; "));
  return facts;
}

std::string usage_of(const CLI::App& command, const CommandFacts& facts) {
  std::string usage = "isobath " + (facts.name.empty() ? "COMMAND" : facts.name) + " [OPTIONS]";
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) continue;
    const std::string name = option->get_name(true) + (option->get_items_expected_max() > 1 ? "..." : "");
    usage += " " + (option->get_required() ? name : "[" + name + "]");
  }
  return usage;
}

OptionGroup& group_of(std::vector<OptionGroup>& groups, const std::string& name) {
  const auto found = std::find_if(groups.begin(), groups.end(), [&](const OptionGroup& g) { return g.name == name; });
  return found != groups.end() ? *found : groups.emplace_back(OptionGroup{name, {}});
}

}  // namespace

CommandFacts facts_of(const CLI::App& command) {
  CommandFacts facts;
  facts.name = command.get_parent() != nullptr ? command.get_name() : "";
  facts.text = command.get_description();
  facts.usage = usage_of(command, facts);
  OptionGroup last{kOptions, {}};
  for (const CLI::Option* option : command.get_options()) {
    const bool argument = option->get_positional();
    if (!argument && option->get_group() == kOptions) {
      last.options.push_back(facts_of_option(*option));
    } else {
      group_of(facts.groups, argument ? kArguments : option->get_group()).options.push_back(facts_of_option(*option));
    }
  }
  std::stable_partition(facts.groups.begin(), facts.groups.end(),
                        [](const OptionGroup& g) { return g.name == kArguments; });
  std::rotate(last.options.begin(), last.options.begin() + 1, last.options.end());  // --help, the first, goes last
  facts.groups.push_back(std::move(last));
  if (!command.get_footer().empty()) facts.examples = CLI::detail::split(command.get_footer(), '\n');
  return facts;
}

std::vector<CommandGroup> commands_of(const CLI::App& program) {
  std::vector<CommandGroup> groups;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    const auto found = std::find_if(groups.begin(), groups.end(),
                                    [&](const CommandGroup& g) { return g.name == command->get_group(); });
    CommandGroup& group = found != groups.end() ? *found : groups.emplace_back(CommandGroup{command->get_group(), {}});
    group.commands.push_back(command);
  }
  return groups;
}

std::vector<std::string> command_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CommandGroup& group : commands_of(program)) {
    for (const CLI::App* command : group.commands) names.push_back(command->get_name());
  }
  return names;
}

std::string no_such_command(const CLI::App& program, const std::string& name) {
  const std::string near = did_you_mean(name, command_names(program));
  return fmt::format("no command is called '{}'{}{}", name, near.empty() ? "" : "; ", near);
}

void add_example(CLI::App& command, const std::string& line) {
  const std::string before = command.get_footer();
  command.footer(before + (before.empty() ? "" : "\n") + "isobath " + line);
}

std::vector<std::pair<int, std::string>> exit_codes() {
  return {{kSuccess, "success"},
          {kFailedChecks,
           "the command ran, but failed its own checks: a collision, a missed goal, a bar of a suite, a path "
           "without enough water, a log that is cut off"},
          {kBadInput, "wrong usage or input, or output that cannot be written; one line on standard error says why"}};
}

}  // namespace isobath::app
