// The commands of the program, one file each. Exit codes: 0 success, 1 the command ran but failed its own checks, 2 bad
// usage or input, or output that cannot be written (exit_codes() in option_facts.hpp).
//
// The options that a file adds are stated there and nowhere else: help, man page and completion are made from them
// (option_facts.hpp). Text of an option: what it does, with the unit, without a full stop. Its default and its allowed
// values follow from default_str and from its kind (values.hpp).
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <functional>
#include <isobath/app/exit_codes.hpp>
#include <string>
#include <vector>

namespace isobath::app {

/// Runs a command after its options are parsed. Returns the exit code; throws isobath::Error for bad input.
using Action = std::function<int()>;

struct Command {
  const CLI::App* app;  ///< its options; part of the program
  Action action;
};

/// Adds every command to the program.
std::vector<Command> add_commands(CLI::App& program);

Action add_run(CLI::App& program);
Action add_serve(CLI::App& program);
Action add_aboard(CLI::App& program);
Action add_setup(CLI::App& program);
Action add_stand_in(CLI::App& program);
Action add_sim(CLI::App& program);
Action add_eval(CLI::App& program);
Action add_info(CLI::App& program);
Action add_convert(CLI::App& program);
Action add_compare(CLI::App& program);
Action add_crosscheck(CLI::App& program);
Action add_path(CLI::App& program);
Action add_calibrate(CLI::App& program);
Action add_delay(CLI::App& program);
Action add_helix(CLI::App& program);
Action add_control(CLI::App& program);
Action add_sphere(CLI::App& program);
Action add_stereo(CLI::App& program);
Action add_track(CLI::App& program);
Action add_traffic(CLI::App& program);
Action add_config(CLI::App& program);
Action add_help(CLI::App& program);

/// Parses "41.66,-82.82" into two numbers; throws Error for any other text.
Eigen::Vector2d pair_of(const std::string& text);

}  // namespace isobath::app
