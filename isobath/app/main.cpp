#include <cstdio>
#include <exception>
#include <isobath/app/commands.hpp>
#include <isobath/base/error.hpp>
#include <new>

namespace {

using isobath::app::Action;

int run_program(int argc, char** argv) {
  CLI::App program{"Isobath: a map to trust and a path to follow, from sonar, in real time.", "isobath"};
  program.set_version_flag("--version", std::string("isobath ") + ISOBATH_VERSION);
  program.require_subcommand(1);
  std::vector<std::pair<CLI::App*, Action>> commands;
  const auto add = [&](Action (*make)(CLI::App&)) {
    Action action = make(program);
    commands.emplace_back(program.get_subcommands({}).back(), std::move(action));
  };
  for (auto* make : {isobath::app::add_run, isobath::app::add_serve, isobath::app::add_sim, isobath::app::add_info,
                     isobath::app::add_convert, isobath::app::add_calibrate, isobath::app::add_compare,
                     isobath::app::add_crosscheck, isobath::app::add_path, isobath::app::add_helix,
                     isobath::app::add_sphere, isobath::app::add_eval, isobath::app::add_config}) {
    add(make);
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return program.exit(e);  // --help, --version
    std::fprintf(stderr, "isobath: %s; see isobath --help\n", e.what());
    return isobath::app::kBadInput;
  }
  for (auto& [command, action] : commands) {
    if (command->parsed()) return action();
  }
  return isobath::app::kBadInput;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_program(argc, argv);
  } catch (const isobath::Error& e) {
    std::fprintf(stderr, "isobath: %s\n", e.what());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "isobath: not enough memory for this input\n");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "isobath: %s\n", e.what());
  }
  return isobath::app::kBadInput;
}
