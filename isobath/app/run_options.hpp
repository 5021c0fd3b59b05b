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
  /// The request, with its configuration. Throws Error.
  RunRequest& read();

 private:
  std::string model_, set_;
  int pass_ = 0;
};

/// Prints the problems of the input, the mission and the recording to standard error. Returns the exit code.
int conclude(const RunRequest& request, const RunOutcome& outcome);

}  // namespace isobath::app
