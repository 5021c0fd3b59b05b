// man_page: isobath(1) in the macros of man(7), made from the definitions of the program's commands and options.
#pragma once

#include <isobath/app/option_facts.hpp>
#include <string>

namespace isobath::app {

std::string man_page(const CLI::App& program, const std::string& version);

}  // namespace isobath::app
