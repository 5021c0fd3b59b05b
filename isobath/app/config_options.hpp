// --config FILE and --set section.key=value, shared by the commands that take settings.
#pragma once

#include <isobath/app/commands.hpp>
#include <isobath/configuration/configuration.hpp>
#include <string>
#include <vector>

namespace isobath::app {

/// The settings of one command, as its options name them.
struct SettingOptions {
  std::string file;
  std::vector<std::string> settings;

  /// `names` gives the settings that --set knows, "section.key"; the completion asks for them.
  void add_to(CLI::App& command, std::function<std::vector<std::string>()> names, const std::string& example);
  /// Applies the file, then the settings in their order. Throws Error.
  void read_into(std::vector<Section>& sections) const;
};
/// "section.key" of every field.
std::vector<std::string> setting_names(const std::vector<Section>& sections);

/// The settings of the commands that run the library: a Configuration.
struct ConfigOptions : SettingOptions {
  void add_to(CLI::App& command);
  /// The defaults with file and settings applied. Throws Error.
  [[nodiscard]] Configuration read() const;
};

}  // namespace isobath::app
