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
//
// A field is bound to one instance and must not outlive it.
#pragma once

#include <functional>
#include <isobath/base/angle.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/text_file.hpp>  // for whoever reads a configuration
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace isobath {

struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// One configuration key: name, unit, allowed values, one sentence, and the value that it is bound to.
class Field {
 public:
  static Field real(std::string name, double* value, Range range, std::string unit, std::string sentence);
  static Field integer(std::string name, int* value, Range range, std::string unit, std::string sentence);
  static Field flag(std::string name, bool* value, std::string sentence);
  static Field text(std::string name, std::string* value, std::string sentence);
  /// The path of a file; a relative path starts at the folder of the configuration file that contains it, and in an
  /// option of the command line at the current folder.
  static Field file(std::string name, std::string* value, std::string sentence);
  /// An array of `count` numbers, such as a vector: [1.0, 2.0, 3.0].
  static Field numbers(std::string name, double* first, int count, Range range, std::string unit, std::string sentence);
  /// Any number of rows of `width` numbers each, kept flat: [[0.0, 1.0], [5.0, 2.0]]; width 1: [0.0, 5.0].
  static Field rows(std::string name, std::vector<double>* flat, int width, Range range, std::string unit,
                    std::string sentence);
  /// One of a list of names; `then` acts on the choice before the fields later in the list are assigned.
  static Field named(std::string name, std::string* value, std::vector<std::string> names, std::function<void()> then,
                     std::string sentence);
  /// The name must end in "_deg".
  static Field degrees(std::string name, Angle* value, Range range_deg, std::string sentence);
  /// One of a closed set of names.
  template <class Enum>
  static Field choice(std::string name, Enum* value, std::vector<std::pair<std::string, Enum>> names,
                      std::string sentence) {
    Choice choice;
    for (const auto& n : names) choice.names.push_back(n.first);
    choice.read = [value, names] {
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i].second == *value) return i;
      }
      return std::size_t{0};
    };
    choice.write = [value, names](std::size_t i) { *value = names[i].second; };
    return Field(std::move(name), std::move(choice), {}, {}, std::move(sentence));
  }

  /// Field::real("max_bins", ...).was("most_bins"): a file with the old key gets an error that names the new one.
  Field was(std::string former) && {
    former_ = std::move(former);
    return std::move(*this);
  }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& former() const { return former_; }
  [[nodiscard]] const std::string& unit() const { return unit_; }
  [[nodiscard]] const std::string& sentence() const { return sentence_; }
  /// "0.01 .. 9", "true or false", "bin, printed or any_target".
  [[nodiscard]] std::string allowed() const;
  /// The value in force, as TOML.
  [[nodiscard]] std::string value() const;

  using Rows = std::vector<std::vector<double>>;  ///< a list of numbers is one row
  using Value = std::variant<bool, std::int64_t, double, std::string, Rows>;
  /// Checks and stores; returns what is wrong, or an empty string.
  std::string assign(const Value& value);
  /// "did you mean NAME?" for a value that is close to one of the choices; else empty.
  [[nodiscard]] std::string nearest_choice(const Value& value) const;
  [[nodiscard]] bool is_file() const { return std::holds_alternative<File>(target_); }

 private:
  struct Choice {
    std::vector<std::string> names;
    std::function<std::size_t()> read;
    std::function<void(std::size_t)> write;
  };
  struct File {
    std::string* path;
  };
  struct Numbers {
    double* first;
    int count;
  };
  struct Table {
    std::vector<double>* flat;
    int width;
  };
  using Target = std::variant<double*, int*, bool*, std::string*, Angle*, Choice, File, Numbers, Table>;
  std::string assign_rows(const Rows& rows);
  [[nodiscard]] std::string check(double number) const;
  Field(std::string name, Target target, Range range, std::string unit, std::string sentence);

  std::string name_, former_;
  Target target_;
  Range range_;
  std::string unit_;
  std::string sentence_;
};

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
