#include <fmt/format.h>
#include <isobath/app/json_output.hpp>
#include <isobath/app/settings_json.hpp>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

using nlohmann::ordered_json;

/// Values are written in the part of TOML that is JSON too, except inf.
ordered_json value_json(const Field& field) {
  ordered_json value = ordered_json::parse(field.value(), nullptr, false);
  return value.is_discarded() ? ordered_json() : value;
}

ordered_json section_json(const std::vector<Field>& fields, bool plain) {
  ordered_json json = ordered_json::object();
  for (const Field& field : fields) {
    json[field.name()] = plain ? value_json(field)
                               : ordered_json{{"value", value_json(field)},
                                              {"unit", field.unit()},
                                              {"allowed", field.allowed()},
                                              {"text", field.sentence()}};
  }
  return json;
}

}  // namespace

ordered_json settings_json(const Schema& settings, bool plain) {
  ordered_json json = ordered_json::object();
  for (const Section& section : settings.sections) json[section.name] = section_json(section.fields, plain);
  for (const SectionList& list : settings.lists) {
    json[list.name] = ordered_json::array({section_json(list.append({}), plain)});
  }
  return json;
}

void print_settings(const std::vector<Section>& sections, bool json) {
  if (json) {
    print_json(settings_json({sections, {}}, false));
  } else {
    fmt::print("{}", write_toml(sections, true));
  }
}

}  // namespace isobath::app
