// RunOptions: the options of every command that runs a pipeline, and the exit code of a run.
#pragma once

#include <CLI/CLI.hpp>
#include <isobath/app/config_options.hpp>
#include <isobath/run/run.hpp>
#include <string>

namespace isobath::app {

struct RunOptions {
  ConfigOptions config;
  RunRequest request;

  /// `out`: the default folder of the results.
  void add_to(CLI::App& command, const std::string& out);
  /// The options for a run of a suite. `command` has the option INPUT.
  void add_suite_to(CLI::App& command);
  /// The request, with its configuration. Throws Error.
  RunRequest& read();
  /// What the run of a suite drew; empty: it is none.
  [[nodiscard]] const std::string& conditions() const { return conditions_; }

 private:
  void take_suite_run();

  std::string model_, set_, suite_, variant_, replay_, conditions_;
  int pass_ = 0;
};

/// Prints the problems of the input, the mission and the recording to standard error. Returns the exit code.
int conclude(const RunRequest& request, const RunOutcome& outcome);

}  // namespace isobath::app
