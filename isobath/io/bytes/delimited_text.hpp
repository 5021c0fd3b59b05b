// DelimitedText: tables of comma-separated text with a line of column names, read line by line.
//
// Empty lines and lines that start with # are skipped. Surrounding blanks and quotes are stripped from names and cells.
// A line longer than 64 KiB ends the table (`overlong`). Errors: a bad line of names throws Error with file and line.
#pragma once

#include <cstdint>
#include <isobath/base/error.hpp>
#include <istream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

class DelimitedText {
 public:
  /// Reads the line of names. Throws Error if it is missing or repeats a name.
  DelimitedText(std::unique_ptr<std::istream> input, std::string file);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Index of a column, or -1 if there is none.
  [[nodiscard]] int column(std::string_view name) const;
  /// Index of a column. Throws Error if there is none.
  [[nodiscard]] int required(std::string_view name) const;
  [[noreturn]] void refuse_names(const std::string& problem, const std::string& allowed = {}) const;

  /// Moves to the next row; false at the end.
  bool next();
  /// A cell of the current row as text (empty where the row is short), as a finite number, or as a whole number.
  [[nodiscard]] std::string_view cell(int column) const;
  [[nodiscard]] std::optional<double> number(int column) const;
  [[nodiscard]] std::optional<std::int64_t> integer(int column) const;

  [[nodiscard]] std::uint64_t bytes_read() const { return bytes_read_; }
  [[nodiscard]] bool overlong() const { return overlong_; }

 private:
  bool read_line();
  void split();

  std::unique_ptr<std::istream> input_;
  std::string file_;
  std::vector<std::string> names_;
  std::vector<char> line_;
  std::string_view text_;
  std::vector<std::string_view> cells_;
  std::uint64_t line_number_ = 0;
  std::uint64_t bytes_read_ = 0;
  bool overlong_ = false;
};

/// Opens a file as a table. Throws Error.
DelimitedText open_delimited_text(const std::string& file);

}  // namespace isobath
