// DelimitedText: tables of comma-separated text with a line of column names, read line by line.
//
// Empty lines and lines that start with # are passed over; names and cells lose surrounding blanks and quotes. A line
// longer than 64 KiB ends the table (`overlong`). Errors about the line of names are thrown as Error with file and
// line.
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
  /// Reads the line of names. Throws Error: nothing there, or a name twice.
  DelimitedText(std::unique_ptr<std::istream> input, std::string file);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Place of a column, or -1 where there is none.
  [[nodiscard]] int column(std::string_view name) const;
  /// Throws Error where there is none.
  [[nodiscard]] int required(std::string_view name) const;
  [[noreturn]] void refuse_names(const std::string& problem, const std::string& allowed = {}) const;

  /// Moves to the next row; false at the end.
  bool next();
  /// The current row: its cell as text (empty where the row is short), as a finite number, as a whole number.
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

/// Opens a file for it. Throws Error.
DelimitedText open_delimited_text(const std::string& file);

}  // namespace isobath
