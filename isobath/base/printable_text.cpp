#include <isobath/base/printable_text.hpp>
#include <vector>

namespace isobath {
namespace {

constexpr std::string_view kNoCharacter = "\xEF\xBF\xBD";  // U+FFFD

std::string_view shown(std::string_view text, const Utf8Character& c, bool keep_lines) {
  if (!c.valid) return kNoCharacter;
  if (keep_lines && (c.code == '\n' || c.code == '\t')) return text.substr(0, 1);
  return is_terminal_control(c.code) ? std::string_view(" ") : text.substr(0, c.bytes);
}

}  // namespace

Utf8Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return {.code = lead, .bytes = 1, .valid = true};
  const std::size_t length = lead >= 0xf0 && lead <= 0xf4 ? 4 : lead >= 0xe0 && lead < 0xf0 ? 3 : lead >= 0xc2 ? 2 : 0;
  if (length == 0 || lead > 0xf4) return {};
  char32_t code = lead & (0xffu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if (i == text.size()) return {.cut = true};
    if ((byte(i) & 0xc0u) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3fu);
  }
  constexpr char32_t kMin[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < kMin[length] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
  return {.code = code, .bytes = length, .valid = true};
}

bool is_terminal_control(char32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x061c || code == 0x200e || code == 0x200f ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

std::string printable_text(std::string_view text, std::size_t most) {
  std::string all;
  std::vector<std::size_t> starts;  // of the characters of `all`
  while (!text.empty()) {
    const Utf8Character c = first_character(text);
    starts.push_back(all.size());
    all += shown(text, c, false);
    text.remove_prefix(c.bytes);
  }
  if (starts.size() <= most) return all;
  const std::size_t end = most / 4, beginning = most - end;
  return all.substr(0, starts[beginning]) + " ... " + (end == 0 ? "" : all.substr(starts[starts.size() - end]));
}

std::string printable_lines(std::string_view text) {
  std::string all;
  all.reserve(text.size());
  while (!text.empty()) {
    const Utf8Character c = first_character(text);
    all += shown(text, c, true);
    text.remove_prefix(c.bytes);
  }
  return all;
}

}  // namespace isobath
