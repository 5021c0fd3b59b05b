#include <fstream>
#include <gtest/gtest.h>
#include <regex>
#include <tests/app/json_page.hpp>
#include <tests/support/data.hpp>

namespace isobath::test {
namespace {

/// "truth?.by_probability[].said" -> truth?, by_probability, [], said.
std::vector<std::string> parts_of_field(const std::string& field) {
  std::vector<std::string> parts;
  static const std::regex kPart("[^.\\[\\]]+|\\[\\]");
  for (std::sregex_iterator i(field.begin(), field.end(), kPart), end; i != end; ++i) parts.push_back(i->str());
  return parts;
}

std::string without_mark(const std::string& part) {
  return part.ends_with("?") ? part.substr(0, part.size() - 1) : part;
}

}  // namespace

JsonPage::JsonPage() {
  std::ifstream page(source_folder() / "docs" / "json-output.md");
  EXPECT_TRUE(page.good());
  std::string section;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("#")) section = line.substr(line.find(' ') + 1);
    if (line.starts_with("| `") || line.starts_with("| (all)")) read_row(line, rows_[section]);
  }
}

void JsonPage::read_row(const std::string& line, std::vector<Row>& rows) {
  static const std::regex kRow("\\| (?:`(.+)`|\\(all\\)) \\|(.*?)\\| (.*[^ ]) \\|");
  static const std::regex kReference("^the fields of ([a-z ]+)");
  std::smatch cells;
  if (!std::regex_match(line, cells, kRow)) {
    ADD_FAILURE() << "not a row: " << line;
    return;
  }
  const std::string unit = cells[2], meaning = cells[3];
  Row row{parts_of_field(cells[1]), unit == " " ? "" : unit.substr(1, unit.size() - 2), {}};
  std::smatch name;
  if (std::regex_search(meaning, name, kReference)) row.refers_to = name[1];
  rows.push_back(std::move(row));
}

std::vector<std::string> JsonPage::sections() const {
  std::vector<std::string> names;
  for (const auto& [name, rows] : rows_) names.push_back(name);
  return names;
}

void JsonPage::add(Field& to, const std::string& section) {
  const auto found = rows_.find(section);
  ASSERT_NE(found, rows_.end()) << "the page has no section \"" << section << '"';
  for (const Row& row : found->second) {
    Field* field = &to;
    for (const std::string& part : row.parts) {
      auto& member = field->members[without_mark(part)];
      if (!member) member = std::make_unique<Field>();
      field = member.get();
      field->optional = field->optional || part.ends_with("?");
    }
    field->any = row.unit == "any";
    if (row.refers_to.empty()) {
      field->leaf = true;
    } else {
      add(*field, row.refers_to);
    }
  }
}

JsonPage::Field& JsonPage::field_of(const std::string& section) {
  auto& field = fields_[section];
  if (!field) {
    field = std::make_unique<Field>();
    add(*field, section);
  }
  return *field;
}

void JsonPage::compare(const std::string& section, const nlohmann::json& object) {
  EXPECT_TRUE(object.is_object()) << section;
  compare(field_of(section), object, section + ": ");
}

void JsonPage::compare(Field& field, const nlohmann::json& json, const std::string& path) {
  field.came_out = true;
  if (json.is_null() || field.any) return;
  if (json.is_array()) {
    const auto elements = field.members.find("[]");
    if (elements == field.members.end()) {
      ADD_FAILURE() << path << " is an array, which the page does not say";
      return;
    }
    for (const auto& element : json) compare(*elements->second, element, path + "[]");
    return;
  }
  if (!json.is_object()) {
    EXPECT_TRUE(field.leaf) << path << " is a value, which the page does not say: " << json;
    return;
  }
  for (const auto& [key, value] : json.items()) {
    auto member = field.members.find(key);
    if (member == field.members.end()) member = field.members.find("*");
    if (member == field.members.end()) {
      ADD_FAILURE() << path << "." << key << " is not on the page";
      continue;
    }
    compare(*member->second, value, path + "." + key);
  }
  for (const auto& [name, member] : field.members) {
    if (name == "*" || name == "[]" || member->optional) continue;
    EXPECT_TRUE(json.contains(name)) << path << "." << name << " is on the page and did not come out";
  }
}

std::vector<std::string> JsonPage::never_came_out(const std::string& section) const {
  std::vector<std::string> names;
  const auto visit = [&](const auto& self, const Field& field, const std::string& path) -> void {
    if (field.leaf && !field.came_out) names.push_back(path);
    for (const auto& [name, member] : field.members) {
      self(self, *member, path + (path.empty() || name == "[]" ? "" : ".") + name);
    }
  };
  if (const auto found = fields_.find(section); found != fields_.end()) visit(visit, *found->second, "");
  return names;
}

std::vector<std::string> JsonPage::wrong_units() const {
  const std::pair<const char*, const char*> units[] = {
      {"_per_s", "1/s"}, {"_m", "m"},     {"_m2", "m²"}, {"_s", "s"},    {"_ms", "ms"},
      {"_ns", "ns"},     {"_deg", "deg"}, {"_db", "dB"}, {"_hz", "1/s"}, {"_counts", "counts"}};
  std::vector<std::string> wrong;
  for (const auto& [section, rows] : rows_) {
    for (const Row& row : rows) {
      if (row.parts.empty() || !row.refers_to.empty()) continue;
      std::string name;
      for (const std::string& part : row.parts) name = part == "[]" ? name : without_mark(part);
      for (const auto& [ending, unit] : units) {
        if (!name.ends_with(ending)) continue;
        if (row.unit != unit) wrong.push_back(section + ": " + name);
        break;
      }
    }
  }
  return wrong;
}

}  // namespace isobath::test
