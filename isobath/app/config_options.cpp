#include <fstream>
#include <isobath/app/config_options.hpp>
#include <isobath/base/error.hpp>
#include <sstream>

namespace isobath::app {

void ConfigOptions::add_to(CLI::App& command) {
  command.add_option("--config", file, "TOML file with settings; isobath config prints the defaults")
      ->type_name("FILE");
  command.add_option("--set", settings, "One setting, e.g. --set echoes.false_alarm=0.01; may be repeated")
      ->type_name("SECTION.KEY=VALUE")
      ->allow_extra_args(false);
}

Configuration ConfigOptions::read() const {
  Configuration configuration;
  Schema all = schema(configuration);
  if (!file.empty()) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    const bool empty = in && in.peek() == std::ifstream::traits_type::eof() && !in.bad();
    if (!empty && !(text << in.rdbuf())) throw Error("cannot read the configuration", {file, {}, {}, {}, {}});
    read_toml(text.str(), file, all);
  }
  for (const std::string& setting : settings) set_from_text(setting, all.sections);
  return configuration;
}

}  // namespace isobath::app
