#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/config.hpp>

namespace isobath::app {

void SettingOptions::add_to(CLI::App& command, std::function<std::vector<std::string>()> names,
                            const std::string& example) {
  const auto assignments = [names = std::move(names)] {
    std::vector<std::string> all = names();
    for (std::string& name : all) name += "=";
    return all;
  };
  command.add_option("--config", file, "TOML file with settings")->type_name("FILE")->check(reads())->group("Settings");
  command.add_option("--set", settings, "One setting, such as " + example)
      ->type_name("SECTION.KEY=VALUE")
      ->check(such_as(assignments))
      ->allow_extra_args(false)
      ->group("Settings");
}

void SettingOptions::read_into(std::vector<Section>& sections) const {
  if (!file.empty()) read_toml(text_of_file(file), file, sections);
  for (const std::string& setting : settings) set_from_text(setting, sections);
}

std::vector<std::string> setting_names(const std::vector<Section>& sections) {
  std::vector<std::string> names;
  for (const Section& section : sections) {
    for (const Field& field : section.fields) names.push_back(fmt::format("{}.{}", section.name, field.name()));
  }
  return names;
}

void ConfigOptions::add_to(CLI::App& command) {
  const auto names = [] {
    Configuration defaults;
    return setting_names(schema(defaults).sections);
  };
  SettingOptions::add_to(command, names, "echoes.false_alarm=0.01; isobath config lists all");
}

Configuration ConfigOptions::read() const {
  Configuration configuration;
  Schema all = schema(configuration);
  if (!file.empty()) read_toml(text_of_file(file), file, all);
  for (const std::string& setting : settings) set_from_text(setting, all.sections);
  return configuration;
}

}  // namespace isobath::app
