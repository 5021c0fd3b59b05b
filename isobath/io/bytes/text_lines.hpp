// Lines of text files, and the values in them. Numbers are read by std::from_chars, without locale or allocation; a
// value must fill its field.
#pragma once

#include <charconv>
#include <cmath>
#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <string_view>

namespace isobath {

struct TextLine {
  std::string_view text;     ///< without line end; a view into the input, valid until the next line
  std::uint64_t offset = 0;  ///< in the input
  std::size_t bytes = 0;     ///< with line end

  void add_damage(SourceReport& report, const std::string& reason) const { report.add_damage(offset, bytes, reason); }
};

/// The line ends: LF only (a CR before it is dropped), or any of CR, LF and CR LF. With kAny, CR LF gives an empty line
/// in between.
enum class LineEnd : std::uint8_t { kNewline, kAny };

/// The next line of up to a megabyte; longer ones are skipped as damage. Empty at the end.
std::optional<TextLine> next_line(ByteWindow& input, SourceReport& report, LineEnd ending = LineEnd::kNewline);
/// The first line of some bytes, complete or truncated.
std::string_view first_line(Bytes bytes);
/// Whether the bytes are mostly printable characters.
bool looks_like_text(Bytes head);

std::string_view trimmed(std::string_view text);

/// Parses a complete field as a number; blanks around it are allowed. A value that is not finite fails.
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

  /// The next field, which may be empty; false after the last.
  bool next(std::string_view& field);
  template <class T>
  bool number(T& value) {
    std::string_view field;
    return next(field) && parse_number(field, value);
  }
  bool skip(int fields);
  /// Reads all remaining fields as samples 0..255. Returns their number, or -1 on other content or more than
  /// `capacity`.
  int samples(std::byte* out, int capacity);
  /// An upper bound of the number of remaining fields.
  [[nodiscard]] std::size_t fields_left() const;

 private:
  std::string_view rest_;
  char separator_;
  bool at_end_ = false;
};

}  // namespace isobath
