// The options that every command with a run has, and how a run ends for the shell.
#pragma once

#include <CLI/CLI.hpp>
#include <isobath/app/config_options.hpp>
#include <isobath/runtime/run.hpp>
#include <string>

namespace isobath::app {

struct RunOptions {
  ConfigOptions config;
  RunRequest request;

  /// `out`: the folder of the results, where none is named.
  void add_to(CLI::App& command, const std::string& out);
  /// The request, with its configuration. Throws Error.
  RunRequest& read();

 private:
  std::string model_, set_;
  int pass_ = 0;
};

/// Prints to the standard error what was wrong, and returns the exit code: the input, the mission, the recording.
int conclude(const RunRequest& request, const RunOutcome& outcome);

}  // namespace isobath::app
