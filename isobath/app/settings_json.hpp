// Settings as JSON: what `isobath config`, `isobath helix --settings` and `isobath sim --format` print as TOML.
#pragma once

#include <isobath/base/config.hpp>
#include <nlohmann/json_fwd.hpp>

namespace isobath::app {

/// {section: {key: {"value": ..., "unit": ..., "allowed": ..., "text": ...}}}; plain: {section: {key: value}}. A list
/// of sections is an array with one element, which has the defaults. An infinite number is null.
nlohmann::ordered_json settings_json(const Schema& settings, bool plain);

}  // namespace isobath::app
