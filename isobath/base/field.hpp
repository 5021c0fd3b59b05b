// Field: one key of a configuration (config.hpp), bound to the value that it sets. It knows its unit, its allowed
// values and one sentence on it, checks what is assigned, and writes the value in force as TOML.
//
// A field is bound to one instance and must not outlive it.
#pragma once

#include <cstdint>
#include <functional>
#include <isobath/base/angle.hpp>
#include <limits>
#include <string>
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

}  // namespace isobath
