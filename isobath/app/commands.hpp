// The subcommands of the program, one file each. Exit codes: 0 success, 1 the run failed its own checks, 2 bad usage or
// input.
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace isobath::app {

inline constexpr int kSuccess = 0, kFailedChecks = 1, kBadInput = 2;

/// Runs a subcommand after its options are parsed. Returns the exit code; throws isobath::Error for bad input.
using Action = std::function<int()>;

Action add_run(CLI::App& program);
Action add_serve(CLI::App& program);
Action add_sim(CLI::App& program);
Action add_info(CLI::App& program);
Action add_convert(CLI::App& program);
Action add_calibrate(CLI::App& program);
Action add_compare(CLI::App& program);
Action add_crosscheck(CLI::App& program);
Action add_path(CLI::App& program);
Action add_eval(CLI::App& program);
Action add_helix(CLI::App& program);
Action add_sphere(CLI::App& program);

Action add_config(CLI::App& program);

/// Parses "41.66,-82.82" into two numbers; throws Error for any other text.
Eigen::Vector2d pair_of(const std::string& text);

}  // namespace isobath::app
