#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/settings_json.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {

Action add_config(CLI::App& program) {
  struct Options {
    ConfigOptions config;
    bool plain = false, json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "config",
      "Print all settings: the defaults, with --config and --set applied, explained, as a configuration file");
  command->add_flag("--plain", options->plain, "Leave out the explanations")->group("Output");
  add_json_flag(*command, options->json);
  options->config.add_to(*command);
  add_example(*command, "config > settings.toml");
  add_example(*command, "config --set input.sound_speed=1480 --plain");
  add_example(*command, "config --json --plain");
  return [options] {
    Configuration configuration = options->config.read();
    if (options->json) {
      print_json(settings_json(schema(configuration), options->plain));
    } else {
      fmt::print("{}", to_toml(configuration, !options->plain));
    }
    return kSuccess;
  };
}

}  // namespace isobath::app
