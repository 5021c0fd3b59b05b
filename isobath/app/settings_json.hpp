// Settings as JSON: what `isobath config`, `isobath helix --settings` and `isobath sim --format` print as TOML.
#pragma once

#include <isobath/base/config.hpp>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace isobath::app {

/// {section: {key: {"value": ..., "unit": ..., "allowed": ..., "text": ...}}}; plain: {section: {key: value}}. A list
/// of sections is an array with one element, which has the defaults. An infinite number is null.
nlohmann::ordered_json settings_json(const Schema& settings, bool plain);
/// Prints the settings of a study, explained: as JSON or as TOML.
void print_settings(const std::vector<Section>& sections, bool json);

}  // namespace isobath::app
