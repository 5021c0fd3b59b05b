// completion_script: the completion of commands, options and their values for a shell, made from the definitions of the
// program's commands and options. The script asks the program for nothing while the user types.
#pragma once

#include <isobath/app/option_facts.hpp>
#include <string>
#include <vector>

namespace isobath::app {

/// "bash", "zsh", "fish".
const std::vector<std::string>& completion_shells();

/// `shell`: one of completion_shells().
std::string completion_script(const CLI::App& program, const std::string& shell);

}  // namespace isobath::app
