#include <algorithm>
#include <cstring>
#include <isobath/io/bytes/text_lines.hpp>

namespace isobath {
namespace {

constexpr std::size_t kTextAtHand = 1 << 16;
constexpr std::size_t kMaxLine = 1 << 20;

bool is_white_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

}  // namespace

std::optional<TextLine> next_line(ByteWindow& input, SourceReport& report, LineEnd ending) {
  std::size_t wanted = kTextAtHand;
  for (;;) {
    const Bytes view = input.want(wanted);
    if (view.empty()) return {};
    const std::string_view text = text_of(view);
    const std::size_t end = ending == LineEnd::kAny ? text.find_first_of("\r\n") : text.find('\n');
    if (end == std::string_view::npos && view.size() >= wanted) {
      if (wanted < kMaxLine) {
        wanted *= 4;
      } else {
        report.add_damage(input.position(), view.size(), "line too long");
        input.advance(view.size());
      }
      continue;
    }
    TextLine line{text.substr(0, end), input.position(), std::min(end, text.size() - 1) + 1};
    while (!line.text.empty() && line.text.back() == '\r') line.text.remove_suffix(1);
    input.advance(line.bytes);
    return line;
  }
}

std::string_view first_line(Bytes bytes) {
  std::string_view text = text_of(bytes);
  return trimmed(text.substr(0, text.find('\n')));
}

bool looks_like_text(Bytes head) {
  const auto odd = [](std::byte b) { return b < std::byte{0x20} && (b < std::byte{9} || b > std::byte{13}); };
  return std::ranges::count_if(head, odd) * 100 < std::ptrdiff_t(head.size());
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_white_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_white_space(text.back())) text.remove_suffix(1);
  return text;
}

bool TextRow::next(std::string_view& field) {
  if (at_end_) return false;
  const void* found = rest_.empty() ? nullptr : std::memchr(rest_.data(), separator_, rest_.size());
  at_end_ = found == nullptr;
  const std::size_t size =
      at_end_ ? rest_.size() : static_cast<std::size_t>(static_cast<const char*>(found) - rest_.data());
  field = rest_.substr(0, size);
  rest_.remove_prefix(at_end_ ? size : size + 1);
  return true;
}

bool TextRow::skip(int fields) {
  std::string_view field;
  while (fields-- > 0) {
    if (!next(field)) return false;
  }
  return true;
}

std::size_t TextRow::fields_left() const {
  return at_end_ ? 0 : static_cast<std::size_t>(std::ranges::count(rest_, separator_)) + 1;
}

int TextRow::samples(std::byte* out, int capacity) {
  const char* at = rest_.data();
  const char* const end = at + rest_.size();
  int count = 0;
  if (at_end_) return 0;
  for (;; ++at) {  // after a separator
    while (at < end && is_white_space(*at)) ++at;
    std::uint8_t value = 0;
    const auto [after, failed] = std::from_chars(at, end, value);
    if (failed != std::errc() || count == capacity) return -1;
    out[count++] = std::byte{value};
    at = after;
    while (at < end && is_white_space(*at)) ++at;
    if (at == end) break;
    if (*at != separator_) return -1;
  }
  at_end_ = true;
  return count;
}

}  // namespace isobath
