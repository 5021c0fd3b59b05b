#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <numeric>
#include <optional>
#include <toml++/toml.h>

namespace isobath {
namespace {

std::string quoted(const std::string& text) {
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

/// Degrees carry rounding from radians: 90 must be written as 90.0, not 90.00000000000001.
double clean_degrees(Angle angle) {
  const double exact = angle.degrees();
  const double rounded = std::round(exact * 1e9) / 1e9;
  return Angle::degrees(rounded).radians() == angle.radians() || std::abs(rounded - exact) < 1e-12 * std::abs(exact)
             ? rounded
             : exact;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += names[i];
  }
  return text;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1] ? 1 : 0)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

template <class Items>
std::string nearest_name(std::string_view wanted, const Items& items) {
  std::string best;
  std::size_t distance = std::numeric_limits<std::size_t>::max();
  for (const auto& item : items) {
    const std::size_t d = edit_distance(wanted.substr(0, 64), item);
    if (d < distance) std::tie(distance, best) = std::pair(d, std::string(item));
  }
  return best.empty() ? "" : "did you mean " + best + "?";
}

std::vector<std::string> names_of(const std::vector<Section>& sections) {
  std::vector<std::string> names;
  for (const Section& s : sections) names.push_back(s.name);
  return names;
}
std::vector<std::string> names_of(const std::vector<Field>& fields) {
  std::vector<std::string> names;
  for (const Field& f : fields) names.push_back(f.name());
  return names;
}

Place place_of(const toml::source_region& region, const std::string& file, const std::string& key) {
  return {file, {}, region.begin.line, region.begin.column, key};
}

std::optional<Field::Value> plain_value(const toml::node& node) {
  if (const auto* b = node.as_boolean()) return b->get();
  if (const auto* i = node.as_integer()) return i->get();
  if (const auto* d = node.as_floating_point()) return d->get();
  if (const auto* s = node.as_string()) return s->get();
  return std::nullopt;
}

void assign_node(Field& field, const toml::node& node, const std::string& file, const std::string& key) {
  const auto value = plain_value(node);
  const std::string problem = value ? field.assign(*value) : std::string("not a single value");
  if (!problem.empty()) {
    throw Error(problem, place_of(node.source(), file, key),
                field.allowed() + (field.unit().empty() ? "" : " " + field.unit()));
  }
}

toml::table parse(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& e) {
    throw Error(std::string(e.description()), place_of(e.source(), file, ""));
  }
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

std::string Field::allowed() const {
  if (const auto* choice = std::get_if<Choice>(&target_)) return listed(choice->names);
  if (std::holds_alternative<bool*>(target_)) return "true or false";
  if (std::holds_alternative<std::string*>(target_)) return "a text";
  const std::string kind = std::holds_alternative<int*>(target_) ? "a whole number" : "a number";
  if (std::isinf(range_.low) && std::isinf(range_.high)) return kind;
  if (std::isinf(range_.high)) return fmt::format("{} from {}", kind, range_.low);
  if (std::isinf(range_.low)) return fmt::format("{} up to {}", kind, range_.high);
  return fmt::format("{} .. {}", range_.low, range_.high);
}

std::string Field::value() const {
  struct Writer {
    std::string operator()(const double* v) const { return real_text(*v); }
    std::string operator()(const int* v) const { return fmt::format("{}", *v); }
    std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
    std::string operator()(const std::string* v) const { return quoted(*v); }
    std::string operator()(const Angle* v) const { return real_text(clean_degrees(*v)); }
    std::string operator()(const Choice& c) const { return quoted(c.names[c.read()]); }
  };
  return std::visit(Writer{}, target_);
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
  if (auto* text = std::get_if<std::string*>(&target_)) {
    if (!std::holds_alternative<std::string>(value)) return "not a text in quotes";
    **text = std::get<std::string>(value);
    return {};
  }
  const auto* whole = std::get_if<std::int64_t>(&value);
  const auto* real = std::get_if<double>(&value);
  if (!whole && !real) return "not a number";
  const double number = whole ? static_cast<double>(*whole) : *real;
  if (std::isnan(number)) return "not a number (nan)";
  if (number < range_.low || number > range_.high) return fmt::format("{} is out of range", number);
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

void read_toml(std::string_view text, const std::string& file, std::vector<Section>& sections) {
  const toml::table root = parse(text, file);
  for (const auto& [section_key, node] : root) {
    const auto section = std::find_if(sections.begin(), sections.end(),
                                      [&, name = section_key.str()](const Section& s) { return s.name == name; });
    if (section == sections.end()) {
      throw Error("unknown section", place_of(section_key.source(), file, std::string(section_key.str())),
                  listed(names_of(sections)), nearest_name(section_key.str(), names_of(sections)));
    }
    const toml::table* table = node.as_table();
    if (!table) throw Error("not a table", place_of(node.source(), file, section->name));
    for (const auto& [key, value] : *table) {
      const std::string full = section->name + "." + std::string(key.str());
      const auto field = std::find_if(section->fields.begin(), section->fields.end(),
                                      [name = key.str()](const Field& f) { return f.name() == name; });
      if (field == section->fields.end()) {
        throw Error("unknown key", place_of(key.source(), file, full), "",
                    nearest_name(key.str(), names_of(section->fields)));
      }
      assign_node(*field, value, file, full);
    }
  }
}

void set_from_text(std::string_view assignment, std::vector<Section>& sections) {
  const auto equals = assignment.find('=');
  const auto dot = assignment.find('.');
  const std::string source = "--set " + std::string(assignment.substr(0, 200));
  if (equals == std::string_view::npos || dot == std::string_view::npos || dot > equals) {
    throw Error("not of the form section.key=value", {source, {}, {}, {}, {}});
  }
  const std::string value(assignment.substr(equals + 1));
  const std::string head =
      fmt::format("[{}]\n{} = ", assignment.substr(0, dot), assignment.substr(dot + 1, equals - dot - 1));
  std::string text = head + value;
  try {
    (void)toml::parse(text);
  } catch (const toml::parse_error&) {
    text = head + quoted(value);
  }
  read_toml(text, source, sections);
}

std::string write_toml(const std::vector<Section>& sections, bool annotated) {
  std::string out;
  for (const Section& section : sections) {
    if (!out.empty()) out += "\n";
    if (annotated && !section.sentence.empty()) out += "# " + section.sentence + "\n";
    out += "[" + section.name + "]\n";
    for (const Field& field : section.fields) {
      if (annotated) {
        out += fmt::format("# {} [{}{}]\n", field.sentence(), field.allowed(),
                           field.unit().empty() || field.unit() == "1" ? "" : " " + field.unit());
      }
      out += fmt::format("{} = {}\n", field.name(), field.value());
    }
  }
  return out;
}

}  // namespace isobath
