#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/nearest_name.hpp>
#include <isobath/base/toml_text.hpp>
#include <optional>
#include <toml++/toml.h>

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

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += names[i];
  }
  return text;
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

/// A setting of the command line, which stands in `file`, has neither line nor column.
Place place_of(const toml::source_region& region, const std::string& file, const std::string& key) {
  if (file.starts_with("--")) return {.file = file, .key = key};
  return {file, {}, region.begin.line, region.begin.column, key};
}

std::optional<std::vector<double>> number_row(const toml::array& array) {
  std::vector<double> row;
  for (const toml::node& node : array) {
    const auto* whole = node.as_integer();
    const auto* real = node.as_floating_point();
    if (!whole && !real) return std::nullopt;
    row.push_back(whole ? static_cast<double>(whole->get()) : real->get());
  }
  return row;
}

std::optional<Field::Value> number_rows(const toml::array& array) {
  if (auto row = number_row(array)) return Field::Rows{std::move(*row)};
  Field::Rows rows;
  for (const toml::node& node : array) {
    const toml::array* inner = node.as_array();
    auto row = inner ? number_row(*inner) : std::nullopt;
    if (!row) return std::nullopt;
    rows.push_back(std::move(*row));
  }
  return rows;
}

std::optional<Field::Value> plain_value(const toml::node& node) {
  if (const auto* b = node.as_boolean()) return b->get();
  if (const auto* i = node.as_integer()) return i->get();
  if (const auto* d = node.as_floating_point()) return d->get();
  if (const auto* s = node.as_string()) return s->get();
  if (const auto* a = node.as_array()) return number_rows(*a);
  return std::nullopt;
}

/// The folder at which relative paths start: that of the file, and for an option ("--set ...") the current one.
std::filesystem::path folder_of(const std::string& file) {
  return file.starts_with("--") ? std::filesystem::path() : std::filesystem::path(file).parent_path();
}

void assign_node(Field& field, const toml::node& node, const std::string& file, const std::string& key) {
  auto value = plain_value(node);
  if (value && field.is_file() && std::holds_alternative<std::string>(*value)) {
    const std::filesystem::path path = std::get<std::string>(*value);
    if (!path.empty() && path.is_relative()) value = (folder_of(file) / path).string();
  }
  const std::string problem = value ? field.assign(*value) : std::string("neither a single value nor rows of numbers");
  if (!problem.empty()) {
    throw Error(problem, place_of(node.source(), file, key),
                field.allowed() + (field.unit().empty() ? "" : " " + field.unit()),
                value ? field.nearest_choice(*value) : "");
  }
}

toml::table parse(std::string_view text, const std::string& file) {
  check_toml_text(text, file);
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
  if (const auto* choice = std::get_if<Choice>(&target_)) return listed(choice->names);
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

namespace {

std::string former_name(const Field& field) { return field.former(); }
std::string former_name(const Section& section) { return section.former; }

/// Advice on an unknown name: how it is called now, or the nearest known one. `names`: those of `known`, and others.
template <class Known>
std::string advice_on(std::string_view name, const std::vector<Known>& known, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!name.empty() && former_name(known[i]) == name) return "it is called " + names[i] + " now";
  }
  return did_you_mean(name, names);
}

/// Assigns keys in the order of the fields, after it has refused unknown keys.
void assign_table(std::vector<Field>& fields, const toml::table& table, const std::string& file,
                  const std::string& section) {
  for (const auto& [key, value] : table) {
    const bool known =
        std::any_of(fields.begin(), fields.end(), [name = key.str()](const Field& f) { return f.name() == name; });
    if (!known) {
      throw Error("unknown key", place_of(key.source(), file, section + "." + std::string(key.str())), "",
                  advice_on(key.str(), fields, names_of(fields)));
    }
  }
  for (Field& field : fields) {
    if (const toml::node* value = table.get(field.name())) {
      assign_node(field, *value, file, section + "." + field.name());
    }
  }
}

void read_list(SectionList& list, const toml::node& node, const std::string& file) {
  const toml::array* array = node.as_array();
  if (!array || !array->is_homogeneous(toml::node_type::table)) {
    throw Error("not a list of tables", place_of(node.source(), file, list.name), "[[" + list.name + "]]");
  }
  for (const toml::node& element : *array) {
    std::vector<Field> fields = list.append(place_of(element.source(), file, list.name));
    assign_table(fields, *element.as_table(), file, list.name);
  }
}

}  // namespace

void read_toml(std::string_view text, const std::string& file, Schema& schema) {
  const toml::table root = parse(text, file);
  for (const auto& [key, node] : root) {
    const auto named = [name = key.str()](const auto& s) { return s.name == name; };
    const auto section = std::find_if(schema.sections.begin(), schema.sections.end(), named);
    const auto list = std::find_if(schema.lists.begin(), schema.lists.end(), named);
    if (list != schema.lists.end()) {
      read_list(*list, node, file);
      continue;
    }
    if (section == schema.sections.end()) {
      std::vector<std::string> names = names_of(schema.sections);
      for (const SectionList& l : schema.lists) names.push_back(l.name);
      throw Error("unknown section", place_of(key.source(), file, std::string(key.str())), listed(names),
                  advice_on(key.str(), schema.sections, names));
    }
    section->place = place_of(node.source(), file, section->name);
    const toml::table* table = node.as_table();
    if (!table) throw Error("not a table", section->place);
    assign_table(section->fields, *table, file, section->name);
  }
}

void read_toml(std::string_view text, const std::string& file, std::vector<Section>& sections) {
  Schema schema{std::move(sections), {}};
  try {
    read_toml(text, file, schema);
  } catch (...) {
    sections = std::move(schema.sections);
    throw;
  }
  sections = std::move(schema.sections);
}

void read_toml_file(const std::string& file, Schema& schema) { read_toml(text_of_file(file), file, schema); }

namespace {

/// "did you mean SECTION.KEY?" for a key without its section.
std::string section_of_key(std::string_view assignment, const std::vector<Section>& sections) {
  const std::string_view key = assignment.substr(0, assignment.find('='));
  for (const Section& section : sections) {
    for (const Field& field : section.fields) {
      if (field.name() == key) return fmt::format("did you mean {}.{}?", section.name, key);
    }
  }
  return {};
}

}  // namespace

void set_from_text(std::string_view assignment, std::vector<Section>& sections, const std::string& option) {
  const auto equals = assignment.find('=');
  const auto dot = assignment.find('.');
  const std::string source = option + " " + std::string(assignment.substr(0, 200));
  if (equals == std::string_view::npos || dot == std::string_view::npos || dot > equals) {
    throw Error("not of the form section.key=value", {source, {}, {}, {}, {}}, "",
                section_of_key(assignment, sections));
  }
  const std::string value(assignment.substr(equals + 1));
  const std::string head =
      fmt::format("[{}]\n{} = ", assignment.substr(0, dot), assignment.substr(dot + 1, equals - dot - 1));
  std::string text = head + value;
  try {
    (void)parse(text, source);
  } catch (const Error&) {
    text = head + in_quotes(value);
  }
  read_toml(text, source, sections);
}

namespace {

void write_table(std::string& out, const std::string& header, const std::string& sentence,
                 const std::vector<Field>& fields, bool annotated) {
  if (!out.empty()) out += "\n";
  if (annotated && !sentence.empty()) out += "# " + sentence + "\n";
  out += header + "\n";
  for (const Field& field : fields) {
    if (annotated) {
      out += fmt::format("# {} [{}{}]\n", field.sentence(), field.allowed(),
                         field.unit().empty() || field.unit() == "1" ? "" : " " + field.unit());
    }
    out += fmt::format("{} = {}\n", field.name(), field.value());
  }
}

}  // namespace

std::string write_toml(const std::vector<Section>& sections, bool annotated) {
  std::string out;
  for (const Section& s : sections) write_table(out, "[" + s.name + "]", s.sentence, s.fields, annotated);
  return out;
}

std::string write_template(const Schema& schema) {
  std::string out = write_toml(schema.sections, true);
  for (const SectionList& list : schema.lists) {
    write_table(out, "[[" + list.name + "]]", list.sentence, list.append({}), true);
  }
  return out;
}

}  // namespace isobath
