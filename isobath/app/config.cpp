#include <cstdio>
#include <isobath/app/config_options.hpp>
#include <memory>

namespace isobath::app {

Action add_config(CLI::App& program) {
  struct Options {
    ConfigOptions config;
    bool plain = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("config", "Print the annotated configuration: defaults, with --config and --set applied");
  options->config.add_to(*command);
  command->add_flag("--plain", options->plain, "Leave out the explanations");
  return [options] {
    std::fputs(to_toml(options->config.read(), !options->plain).c_str(), stdout);
    return kSuccess;
  };
}

}  // namespace isobath::app
