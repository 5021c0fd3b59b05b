// What is refused of a TOML text before the parser sees it. The parser of toml++ 3.3 takes some texts for impossible:
// it stops the program at an assertion, or its behaviour is undefined. A file is untrusted, so that each of them is an
// Error here, with line and column:
//
// - a byte that is not ASCII outside quotes and comments, after a backslash, or first on a continued line of a text
//   (in quotes and comments UTF-8 is as welcome as TOML has it);
// - a table header without a name, a bracket that closes another kind or none, a quote inside a word or never closed;
// - a date with a time behind a space, which no key of ours takes;
// - brackets nested deeper than kDeepestBrackets and keys of more than kMostKeyParts parts: tables in tables without
//   end would use up the stack.
//
// All other texts that are not TOML are left to the parser and its own message.
#pragma once

#include <string>
#include <string_view>

namespace isobath {

constexpr int kDeepestBrackets = 32;
constexpr int kMostKeyParts = 16;

/// Throws Error with `file`, line and column (in characters, from 1) where `text` is one of the texts above.
void check_toml_text(std::string_view text, const std::string& file);

}  // namespace isobath
