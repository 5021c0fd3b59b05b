// Configuration: a plain struct with defaults stands beside the class that it configures, together with one function
// that lists its fields. Reading, writing, checking and the documentation all use that list; nothing is stated twice.
//
//   struct DetectorConfig {
//     double threshold = 0.8;
//     Angle sector = Angle::degrees(90);
//   };
//   std::vector<Field> fields(DetectorConfig& c) {
//     return {Field::real("threshold", &c.threshold, {0.01, 9}, "1", "Expected number that reports an obstacle."),
//             Field::degrees("sector_deg", &c.sector, {1, 360}, "Width of the ...")};
//   }
#pragma once

#include <functional>
#include <isobath/base/error.hpp>
#include <isobath/base/field.hpp>
#include <isobath/base/text_file.hpp>  // for every reader of a configuration
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// A TOML table: [name].
struct Section {
  std::string name;
  std::string sentence;
  std::vector<Field> fields;
  Place place = {};         ///< of its header in the file; empty if the file has no such header
  std::string former = {};  ///< its name before; a file with it gets an error that names the new one
};

/// An array of TOML tables: [[name]], any number of times.
struct SectionList {
  std::string name;
  std::string sentence;
  /// Makes a new element with its place in the file and returns its fields. The caller uses them before its next call.
  std::function<std::vector<Field>(const Place& place)> append;
};

/// Keys are assigned in the order of the list of fields, not in the order of the file.
struct Schema {
  std::vector<Section> sections;
  std::vector<SectionList> lists;
};

/// Reads TOML into the bound values; keys that are absent keep their defaults. Throws Error with line and column on a
/// syntax error, an unknown section or key (naming its new name, or the nearest known one), a wrong type, or a value
/// out of range.
void read_toml(std::string_view text, const std::string& file, std::vector<Section>& sections);

void read_toml(std::string_view text, const std::string& file, Schema& schema);
/// The same from a file. Also throws Error where the file cannot be read.
void read_toml_file(const std::string& file, Schema& schema);

/// Sets one value from "section.key=value" (the value as TOML, or a bare word for a text or a choice). `option`: the
/// option of the command line that it comes from, for messages. Throws Error.
void set_from_text(std::string_view assignment, std::vector<Section>& sections, const std::string& option = "--set");

/// The values in force as TOML; with sentence, unit and allowed values if `annotated`. `read_toml` reads it back.
std::string write_toml(const std::vector<Section>& sections, bool annotated);
/// A description of the format: every section, and one element with defaults of every list, annotated.
std::string write_template(const Schema& schema);

}  // namespace isobath
