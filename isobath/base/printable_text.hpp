// Text from inputs (titles, names, reasons, file names) on its way to a terminal. Such text may hold anything: escape
// sequences that clear the screen or set its title, marks that reverse the order of letters, bytes that are no UTF-8,
// a hundred thousand characters.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace isobath {

constexpr std::size_t kMaxForeignText = 200;  ///< characters of one text of an input that a terminal shows

/// One character of UTF-8 at the start of `text`, which is not empty.
struct Utf8Character {
  char32_t code = 0;
  std::size_t bytes = 1;  ///< 1 also where the byte begins no character
  bool valid = false;
  bool cut = false;  ///< the text ends within what can still become a character
};
Utf8Character first_character(std::string_view text);

/// Whether a terminal takes the character for a command or for a mark of direction: C0, DEL, C1, separators of lines
/// and paragraphs, marks of direction.
bool is_terminal_control(char32_t code);

/// The text as one line: a space for every control character, U+FFFD for every byte that is no UTF-8. Of a longer text
/// the beginning and the end, with " ... " between them: `most` characters together.
std::string printable_text(std::string_view text, std::size_t most = kMaxForeignText);

/// The same without a bound, line feeds and tabs kept: for the output of a program as a whole.
std::string printable_lines(std::string_view text);

}  // namespace isobath
