#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/toml_text.hpp>

namespace isobath {
namespace {

bool ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }
bool digit(char c) { return c >= '0' && c <= '9'; }
bool quote(char c) { return c == '"' || c == '\''; }
bool blank(char c) { return c == ' ' || c == '\t'; }
bool white(char c) { return blank(c) || (c >= '\n' && c <= '\r'); }
bool one_of(std::string_view set, char c) { return set.find(c) != std::string_view::npos; }
bool begins_name(char c) {
  return quote(c) || digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
}

/// Follows the text through quotes, comments and brackets as the parser does.
class TomlText {
 public:
  TomlText(std::string_view text, const std::string& file) : text_(text), file_(file) {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") begin_ = at_ = 3;
  }

  void check() {
    while (more()) {
      const char c = text_[at_];
      if (!ascii(c)) fail("a character that is not ASCII outside quotes and comments");
      if (header_) header_name(c);
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (quote(c)) {
        quoted(c);
      } else {
        plain(c);
        ++at_;
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    const std::string_view before = text_.substr(begin_, at_ - begin_);
    const std::string_view row = before.substr(before.rfind('\n') + 1);  // npos + 1 is 0
    Place place{file_};
    place.line = 1 + std::count(before.begin(), before.end(), '\n');
    place.column = 1 + std::count_if(row.begin(), row.end(),
                                     [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
    throw Error(problem, std::move(place));
  }

  [[nodiscard]] bool more() const { return at_ < text_.size(); }
  [[nodiscard]] char before() const { return at_ == begin_ ? '\n' : text_[at_ - 1]; }

  /// Checks the first character after the [ or [[ of a table header.
  void header_name(char c) {
    if (blank(c)) return;
    const bool second = c == '[' && before() == '[' && brackets_.size() == 1;
    if (!second && c != ']' && !begins_name(c)) fail("no name after the [ of a table");
    header_ = second;
  }

  void plain(char c) {
    if (c == ' ' && ends_in_date()) fail("a date and a time; write them as a text in quotes");
    if (white(c) || one_of(",]}", c)) {
      word_.clear();
    } else if (c != '_') {  // the parser ignores it
      word_ += c;
    }
    if (one_of("\n=,[{", c)) key_parts_ = 1;
    if (c == '.' && ++key_parts_ > kMaxKeyParts) fail(fmt::format("a key of more than {} parts", kMaxKeyParts));
    if (one_of("[{", c)) open(c);
    if (one_of("]}", c)) close(c == ']' ? '[' : '{', c);
    line_begins_ = c == '\n' || (line_begins_ && white(c));
  }

  void open(char c) {
    if (brackets_.size() == kDeepestBrackets) fail(fmt::format("brackets nested deeper than {}", kDeepestBrackets));
    header_ = header_ || (line_begins_ && brackets_.empty() && c == '[');
    brackets_ += c;
  }

  void close(char opened, char c) {
    if (brackets_.empty()) fail(fmt::format("a {} without an opening bracket", c));
    if (brackets_.back() != opened) fail(fmt::format("a {} cannot close a {}", c, brackets_.back()));
    brackets_.pop_back();
  }

  [[nodiscard]] bool ends_in_date() const {
    if (word_.size() < 10) return false;
    const char* date = word_.data() + word_.size() - 10;
    return digit(date[0]) && date[4] == '-' && date[7] == '-';
  }

  void quoted(char mark) {
    if (!white(before()) && !one_of("=[{,.", before())) fail("a quote inside a word");
    line_begins_ = false;
    word_.clear();
    const std::string three(3, mark);
    const bool lines = text_.substr(at_, 3) == three;
    const std::size_t opening = at_;
    at_ += lines ? 3 : 1;
    for (; more(); ++at_) {
      const char c = text_[at_];
      if (c == '\\' && mark == '"') {
        escape(lines);
      } else if (lines && text_.substr(at_, 3) == three) {
        at_ += 3;
        for (int extra = 0; extra < 2 && more() && text_[at_] == mark; ++extra) ++at_;  // they belong to the text
        return;
      } else if (!lines && c == mark) {
        ++at_;
        return;
      } else if (!lines && c == '\n') {
        break;
      }
    }
    at_ = opening;
    fail("a text without a closing quote");
  }

  /// From the backslash to the last byte that belongs to it.
  void escape(bool lines) {
    if (++at_ >= text_.size()) return;
    if (!ascii(text_[at_])) fail("a character that is not ASCII after a backslash");
    if (!lines || !white(text_[at_])) return;
    while (at_ + 1 < text_.size() && white(text_[at_ + 1])) ++at_;
    if (at_ + 1 == text_.size() || ascii(text_[at_ + 1])) return;
    ++at_;
    fail("a character that is not ASCII at the start of a continued line; write \\u and four digits");
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t begin_ = 0;  ///< after the byte order mark
  std::size_t at_ = 0;
  std::string brackets_;     ///< opened and not yet closed, outermost first
  std::string word_;         ///< since the last space, comma or closing bracket
  int key_parts_ = 1;        ///< of the current key, if there is one
  bool line_begins_ = true;  ///< only white space so far
  bool header_ = false;      ///< a table's name must follow
};

}  // namespace

void check_toml_text(std::string_view text, const std::string& file) { TomlText(text, file).check(); }

}  // namespace isobath
