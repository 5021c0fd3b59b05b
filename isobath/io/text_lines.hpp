// Lines of text files, and the values in them. Numbers are read by std::from_chars: no locale, no allocation, and a
// value must fill its field.
#pragma once

#include <charconv>
#include <cmath>
#include <isobath/io/byte_window.hpp>
#include <isobath/io/event.hpp>
#include <string_view>

namespace isobath {

struct TextLine {
  std::string_view text;     ///< without line end; a view into the input, valid until the next line
  std::uint64_t offset = 0;  ///< in the input
  std::size_t bytes = 0;     ///< with line end

  void add_damage(SourceReport& report, const std::string& reason) const { report.add_damage(offset, bytes, reason); }
};

/// What ends a line: LF (a CR before it is dropped), or any of CR, LF and CR LF, which then gives an empty line
/// between.
enum class LineEnd : std::uint8_t { kNewline, kAny };

/// The next line of up to a megabyte; longer ones are skipped as damage. Empty at the end.
std::optional<TextLine> next_line(ByteWindow& input, SourceReport& report, LineEnd ending = LineEnd::kNewline);
/// The first line of some bytes, whole or cut.
std::string_view first_line(Bytes bytes);
/// Mostly printable: what a person would call a text file.
bool looks_like_text(Bytes head);

std::string_view trimmed(std::string_view text);

/// A whole field as a number, blanks around it allowed. Not finite is no number.
template <class T>
bool parse_number(std::string_view field, T& value) {
  field = trimmed(field);
  const auto [end, failed] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (failed != std::errc() || end != field.data() + field.size()) return false;
  if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
  return true;
}

/// The fields of one line, from left to right.
class TextRow {
 public:
  TextRow(std::string_view text, char separator) : rest_(text), separator_(separator) {}

  /// Empty fields count; false behind the last.
  bool next(std::string_view& field);
  template <class T>
  bool number(T& value) {
    std::string_view field;
    return next(field) && parse_number(field, value);
  }
  bool skip(int fields);
  /// All that is left as samples 0..255, at most `capacity`; -1 where something else stands, or more.
  int samples(std::byte* out, int capacity);
  /// An upper bound of the number of fields left.
  [[nodiscard]] std::size_t fields_left() const;

 private:
  std::string_view rest_;
  char separator_;
  bool at_end_ = false;
};

}  // namespace isobath
