#include <algorithm>
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
      throw Error("unknown section", place_of(key.source(), file, std::string(key.str())), alternatives(names),
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
  std::string value(assignment.substr(equals + 1));
  const std::string head =
      fmt::format("[{}]\n{} = ", assignment.substr(0, dot), assignment.substr(dot + 1, equals - dot - 1));
  std::string text = head + value;
  try {
    (void)parse(text, source);
  } catch (const Error&) {
    text = head + Field::text("", &value, "").value();  // in quotes
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
