#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/field.hpp>
#include <isobath/base/nearest_name.hpp>

namespace isobath {
namespace {

std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

/// Shortest decimal that reads back as the same double, always recognisable as a float in TOML.
std::string real_text(double value) {
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".eEn") == std::string::npos) text += ".0";
  return text;
}

std::string row_text(const std::vector<double>& row) {
  std::string text = "[";
  for (std::size_t i = 0; i < row.size(); ++i) text += (i ? ", " : "") + real_text(row[i]);
  return text + "]";
}

std::string range_text(const Range& range) {
  if (std::isinf(range.low) && std::isinf(range.high)) return "any";
  if (std::isinf(range.high)) return fmt::format("from {}", range.low);
  if (std::isinf(range.low)) return fmt::format("up to {}", range.high);
  return fmt::format("{} .. {}", range.low, range.high);
}

/// Degrees carry rounding from radians: 90 must be written as 90.0, not 90.00000000000001.
double clean_degrees(Angle angle) {
  const double exact = angle.degrees();
  const double rounded = std::round(exact * 1e9) / 1e9;
  return Angle::degrees(rounded).radians() == angle.radians() || std::abs(rounded - exact) < 1e-12 * std::abs(exact)
             ? rounded
             : exact;
}

}  // namespace

Field::Field(std::string name, Target target, Range range, std::string unit, std::string sentence)
    : name_(std::move(name)),
      target_(std::move(target)),
      range_(range),
      unit_(std::move(unit)),
      sentence_(std::move(sentence)) {}

Field Field::real(std::string name, double* value, Range range, std::string unit, std::string sentence) {
  return {std::move(name), value, range, std::move(unit), std::move(sentence)};
}
Field Field::integer(std::string name, int* value, Range range, std::string unit, std::string sentence) {
  return {std::move(name), value, range, std::move(unit), std::move(sentence)};
}
Field Field::flag(std::string name, bool* value, std::string sentence) {
  return {std::move(name), value, {}, {}, std::move(sentence)};
}
Field Field::text(std::string name, std::string* value, std::string sentence) {
  return {std::move(name), value, {}, {}, std::move(sentence)};
}
Field Field::degrees(std::string name, Angle* value, Range range_deg, std::string sentence) {
  ISOBATH_ASSERT(name.ends_with("_deg"));
  return {std::move(name), value, range_deg, "deg", std::move(sentence)};
}

Field Field::file(std::string name, std::string* value, std::string sentence) {
  return {std::move(name), File{value}, {}, {}, std::move(sentence)};
}
Field Field::numbers(std::string name, double* first, int count, Range range, std::string unit, std::string sentence) {
  return {std::move(name), Numbers{first, count}, range, std::move(unit), std::move(sentence)};
}
Field Field::rows(std::string name, std::vector<double>* flat, int width, Range range, std::string unit,
                  std::string sentence) {
  return {std::move(name), Table{flat, width}, range, std::move(unit), std::move(sentence)};
}
Field Field::named(std::string name, std::string* value, std::vector<std::string> names, std::function<void()> then,
                   std::string sentence) {
  Choice choice;
  choice.names = std::move(names);
  choice.read = [value, all = choice.names] {
    return static_cast<std::size_t>(std::find(all.begin(), all.end(), *value) - all.begin()) % all.size();
  };
  choice.write = [value, all = choice.names, act = std::move(then)](std::size_t i) {
    *value = all[i];
    act();
  };
  return {std::move(name), std::move(choice), {}, {}, std::move(sentence)};
}

std::string Field::allowed() const {
  if (const auto* numbers = std::get_if<Numbers>(&target_)) {
    return fmt::format("{} numbers, {}", numbers->count, range_text(range_));
  }
  if (const auto* table = std::get_if<Table>(&target_)) {
    if (table->width == 1) return fmt::format("a list of numbers, {}", range_text(range_));
    return fmt::format("rows of {} numbers, {}", table->width, range_text(range_));
  }
  if (is_file()) return "a file";
  if (const auto* choice = std::get_if<Choice>(&target_)) return alternatives(choice->names);
  if (std::holds_alternative<bool*>(target_)) return "true or false";
  if (std::holds_alternative<std::string*>(target_)) return "a text";
  const std::string kind = std::holds_alternative<int*>(target_) ? "a whole number" : "a number";
  if (std::isinf(range_.low) && std::isinf(range_.high)) return kind;
  return std::isinf(range_.low) || std::isinf(range_.high) ? kind + " " + range_text(range_) : range_text(range_);
}

std::string Field::value() const {
  struct Writer {
    std::string operator()(const double* v) const { return real_text(*v); }
    std::string operator()(const int* v) const { return fmt::format("{}", *v); }
    std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
    std::string operator()(const std::string* v) const { return in_quotes(*v); }
    std::string operator()(const Angle* v) const { return real_text(clean_degrees(*v)); }
    std::string operator()(const Choice& c) const { return in_quotes(c.names[c.read()]); }
    std::string operator()(const File& f) const { return in_quotes(*f.path); }
    std::string operator()(const Numbers& n) const { return row_text({n.first, n.first + n.count}); }
    std::string operator()(const Table& t) const {
      if (t.width == 1) return row_text(*t.flat);
      std::string text = "[";
      for (std::size_t i = 0; i + t.width <= t.flat->size(); i += t.width) {
        const auto row = t.flat->begin() + static_cast<std::ptrdiff_t>(i);
        text += (i ? ", " : "") + row_text({row, row + t.width});
      }
      return text + "]";
    }
  };
  return std::visit(Writer{}, target_);
}

std::string Field::check(double number) const {
  if (std::isnan(number)) return "not a number (nan)";
  if (number < range_.low || number > range_.high) return fmt::format("{} is out of range", number);
  return {};
}

std::string Field::assign_rows(const Rows& rows) {
  for (const auto& row : rows) {
    for (const double number : row) {
      if (std::string problem = check(number); !problem.empty()) return problem;
    }
  }
  if (auto* numbers = std::get_if<Numbers>(&target_)) {
    if (rows.size() != 1 || rows[0].size() != static_cast<std::size_t>(numbers->count)) {
      return fmt::format("not {} numbers", numbers->count);
    }
    std::copy(rows[0].begin(), rows[0].end(), numbers->first);
    return {};
  }
  const Table& table = std::get<Table>(target_);
  std::vector<double> flat;
  for (const auto& row : rows) {
    const bool empty = rows.size() == 1 && row.empty();
    if (table.width > 1 && !empty && row.size() != static_cast<std::size_t>(table.width)) {
      return fmt::format("a row of {} numbers instead of {}", row.size(), table.width);
    }
    flat.insert(flat.end(), row.begin(), row.end());
  }
  if (table.width == 1 && rows.size() != 1) return "not a list of numbers";
  *table.flat = std::move(flat);
  return {};
}

std::string Field::assign(const Value& value) {
  if (auto* choice = std::get_if<Choice>(&target_)) {
    const auto* name = std::get_if<std::string>(&value);
    const auto at = name ? std::find(choice->names.begin(), choice->names.end(), *name) : choice->names.end();
    if (at == choice->names.end()) {
      return name ? fmt::format("\"{}\" is not one of the choices", *name) : "not a text in quotes";
    }
    choice->write(static_cast<std::size_t>(at - choice->names.begin()));
    return {};
  }
  if (auto* flag = std::get_if<bool*>(&target_)) {
    if (!std::holds_alternative<bool>(value)) return "not true or false";
    **flag = std::get<bool>(value);
    return {};
  }
  auto* text = std::get_if<std::string*>(&target_);
  auto* path = std::get_if<File>(&target_);
  if (text || path) {
    if (!std::holds_alternative<std::string>(value)) return "not a text in quotes";
    *(text ? *text : path->path) = std::get<std::string>(value);
    return {};
  }
  if (std::holds_alternative<Numbers>(target_) || std::holds_alternative<Table>(target_)) {
    if (!std::holds_alternative<Rows>(value)) return "not a list of numbers";
    return assign_rows(std::get<Rows>(value));
  }
  const auto* whole = std::get_if<std::int64_t>(&value);
  const auto* real = std::get_if<double>(&value);
  if (!whole && !real) return "not a number";
  const double number = whole ? static_cast<double>(*whole) : *real;
  if (std::string problem = check(number); !problem.empty()) return problem;
  if (auto* integer = std::get_if<int*>(&target_)) {
    if (!whole) return "not a whole number";
    if (*whole < std::numeric_limits<int>::min() || *whole > std::numeric_limits<int>::max()) return "too large";
    **integer = static_cast<int>(*whole);
  } else if (auto* angle = std::get_if<Angle*>(&target_)) {
    **angle = Angle::degrees(number);
  } else {
    *std::get<double*>(target_) = number;
  }
  return {};
}

std::string Field::nearest_choice(const Value& value) const {
  const auto* choice = std::get_if<Choice>(&target_);
  const auto* name = std::get_if<std::string>(&value);
  return choice && name ? did_you_mean(*name, choice->names) : "";
}

}  // namespace isobath
