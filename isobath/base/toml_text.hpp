// check_toml_text: refuses texts that the TOML parser cannot survive. On these texts the parser of toml++ 3.3 stops the
// program at an assertion, or its behaviour is undefined. Files are untrusted, so each such text is an Error here, with
// line and column:
//
// - a byte that is not ASCII outside quotes and comments, after a backslash, or at the start of a continued line of a
//   text (inside quotes and comments UTF-8 is accepted, as in TOML);
// - a table header without a name, a bracket that closes another kind or none, a quote inside a word, a quote that is
//   never closed;
// - a date and a time with a space between them, which no key takes;
// - brackets nested deeper than kDeepestBrackets, and keys of more than kMaxKeyParts parts: tables nested without a
//   limit would overflow the stack.
//
// The parser reports all other texts that are not TOML with its own message.
#pragma once

#include <string>
#include <string_view>

namespace isobath {

constexpr int kDeepestBrackets = 32;
constexpr int kMaxKeyParts = 16;

/// Throws Error with `file`, line and column (in characters, from 1) where `text` is one of the texts above.
void check_toml_text(std::string_view text, const std::string& file);

}  // namespace isobath
