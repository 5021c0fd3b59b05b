// help_text: the help of the program or of one command, for a terminal of 80 columns.
#pragma once

#include <isobath/app/option_facts.hpp>
#include <string>

namespace isobath::app {

std::string help_text(const CLI::App& command);

}  // namespace isobath::app
