// The value of --speed: the pace of a simulation.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace isobath::app {

/// The kind of the option's value (values.hpp).
CLI::Validator speed();
/// Simulated seconds per real second; 0 ("max"): no limit. Throws Error.
double speed_of(const std::string& speed);

}  // namespace isobath::app
