// JsonPage: the tables of docs/json-output.md, and how an object compares with them.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace isobath::test {

class JsonPage {
 public:
  /// Reads the page; a table that cannot be understood is a failure of the test.
  JsonPage();

  /// The sections with tables, by heading.
  [[nodiscard]] std::vector<std::string> sections() const;
  /// A failure for each field of the object that the section does not list, and for each that it lists without a "?"
  /// and the object lacks. Remembers which fields came out.
  void compare(const std::string& section, const nlohmann::json& object);
  /// The fields of a section that no object had.
  [[nodiscard]] std::vector<std::string> never_came_out(const std::string& section) const;
  /// The rows whose unit is not the one that ends the name of the field.
  [[nodiscard]] std::vector<std::string> wrong_units() const;

 private:
  /// A row: the field in parts, "[]" for the elements of an array, and the section that it refers to.
  struct Row {
    std::vector<std::string> parts;
    std::string unit, refers_to;
  };
  struct Field {
    std::map<std::string, std::unique_ptr<Field>> members;  ///< "*": every key; "[]": the elements
    bool leaf = false, optional = false, any = false;
    bool came_out = false;
  };

  void read_row(const std::string& line, std::vector<Row>& rows);
  void add(Field& to, const std::string& section);
  Field& field_of(const std::string& section);
  void compare(Field& field, const nlohmann::json& json, const std::string& path);

  std::map<std::string, std::vector<Row>> rows_;
  std::map<std::string, std::unique_ptr<Field>> fields_;
};

}  // namespace isobath::test
