#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/completion.hpp>
#include <isobath/app/help_text.hpp>
#include <isobath/app/man_page.hpp>
#include <isobath/base/error.hpp>
#include <memory>

namespace isobath::app {
namespace {

std::string help_of(const CLI::App& program, const std::string& name) {
  if (name.empty()) return help_text(program);
  for (const CommandGroup& group : commands_of(program)) {
    for (const CLI::App* command : group.commands) {
      if (command->get_name() == name) return help_text(*command);
    }
  }
  throw Error(no_such_command(program, name), {}, "", "see isobath help");
}

}  // namespace

Action add_help(CLI::App& program) {
  struct HelpOptions {
    std::string command, shell;
    bool man = false;
  };
  auto options = std::make_shared<HelpOptions>();
  CLI::App* help = program.add_subcommand("help", "Print the help of the program or of one command");
  CLI::Option* about =
      help->add_option("COMMAND", options->command, "The command to explain")->check(such_as([&program] {
        return command_names(program);
      }));
  CLI::Option* man = help->add_flag("--man", options->man, "Print the manual page isobath(1), for man");
  help->add_option("--completion", options->shell, "Print the script that completes commands and options in a shell")
      ->check(one_of(completion_shells()))
      ->type_name("SHELL")
      ->excludes(about)
      ->excludes(man);
  man->excludes(about);
  add_example(*help, "help run");
  add_example(*help, "help --man | man -l -");
  add_example(*help, "help --completion bash > ~/.local/share/bash-completion/completions/isobath");
  return [options, &program] {
    const std::string text = options->man             ? man_page(program, ISOBATH_VERSION)
                             : options->shell.empty() ? help_of(program, options->command)
                                                      : completion_script(program, options->shell);
    fmt::print("{}", text);
    return kSuccess;
  };
}

}  // namespace isobath::app
