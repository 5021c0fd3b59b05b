// --config FILE and --set section.key=value, shared by the subcommands that take a configuration.
#pragma once

#include <isobath/app/commands.hpp>
#include <isobath/configuration/configuration.hpp>
#include <string>
#include <vector>

namespace isobath::app {

struct ConfigOptions {
  std::string file;
  std::vector<std::string> settings;

  void add_to(CLI::App& command);
  /// Applies the file, then the settings in their order, to the defaults. Throws Error.
  [[nodiscard]] Configuration read() const;
};

}  // namespace isobath::app
