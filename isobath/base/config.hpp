// Configuration: a plain struct with defaults stands beside the class that it configures, together with one function
// that lists its fields. Reading, writing, checking and the documentation all come from that list; nothing is stated
// twice.
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

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& unit() const { return unit_; }
  [[nodiscard]] const std::string& sentence() const { return sentence_; }
  /// "0.01 .. 9", "true or false", "bin, printed or any_target".
  [[nodiscard]] std::string allowed() const;
  /// The value in force, as TOML.
  [[nodiscard]] std::string value() const;

  using Value = std::variant<bool, std::int64_t, double, std::string>;
  /// Checks and stores; returns what is wrong, or an empty string.
  std::string assign(const Value& value);

 private:
  struct Choice {
    std::vector<std::string> names;
    std::function<std::size_t()> read;
    std::function<void(std::size_t)> write;
  };
  using Target = std::variant<double*, int*, bool*, std::string*, Angle*, Choice>;
  Field(std::string name, Target target, Range range, std::string unit, std::string sentence);

  std::string name_;
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
};

/// Reads TOML into the bound values; keys that are absent keep their defaults. Throws Error with line and column on a
/// syntax error, an unknown section or key (naming the nearest known one), a wrong type, or a value out of range.
void read_toml(std::string_view text, const std::string& file, std::vector<Section>& sections);

/// Sets one value from "section.key=value" (the value as TOML, or a bare word for a text or a choice). Throws Error.
void set_from_text(std::string_view assignment, std::vector<Section>& sections);

/// The values in force as TOML; annotated with sentence, unit and allowed values if wanted. `read_toml` reads it back.
std::string write_toml(const std::vector<Section>& sections, bool annotated);

}  // namespace isobath
