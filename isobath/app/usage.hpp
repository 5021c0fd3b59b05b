// run_program: from the command line to the exit code. Every problem ends in one line on standard error; with --json
// anywhere on the command line also in an object on standard output: {"error": {"problem": ...}}.
#pragma once

namespace isobath::app {

int run_program(int argc, char** argv);

}  // namespace isobath::app
