#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <isobath/base/file_access.hpp>
#include <isobath/io/bytes/delimited_text.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxLine = 64 << 10;

std::string_view unquoted(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

template <class Number>
std::optional<Number> parsed(std::string_view text) {
  Number value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

DelimitedText::DelimitedText(std::unique_ptr<std::istream> input, std::string file)
    : input_(std::move(input)), file_(std::move(file)), line_(kMaxLine) {
  if (!next()) throw Error("no line of column names", {file_, {}, {}, {}, {}});
  names_.assign(cells_.begin(), cells_.end());
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (!names_[i].empty() && column(names_[i]) != static_cast<int>(i)) {
      refuse_names("column \"" + names_[i] + "\" appears twice");
    }
  }
}

int DelimitedText::column(std::string_view name) const {
  const auto at = std::find(names_.begin(), names_.end(), name);
  return at == names_.end() ? -1 : static_cast<int>(at - names_.begin());
}

int DelimitedText::required(std::string_view name) const {
  const int at = column(name);
  if (at < 0) refuse_names("no column \"" + std::string(name) + "\"");
  return at;
}

void DelimitedText::refuse_names(const std::string& problem, const std::string& allowed) const {
  throw Error(problem, {file_, {}, line_number_, {}, {}}, allowed);
}

bool DelimitedText::next() {
  while (read_line()) {
    if (text_.empty() || text_.front() == '#') continue;
    split();
    return true;
  }
  return false;
}

bool DelimitedText::read_line() {
  if (overlong_) return false;
  input_->getline(line_.data(), static_cast<std::streamsize>(line_.size()));
  const auto count = input_->gcount();
  bytes_read_ += static_cast<std::uint64_t>(count);
  overlong_ = input_->fail() && static_cast<std::size_t>(count) + 1 == line_.size();
  if (input_->fail()) return false;
  ++line_number_;
  const bool newline = !input_->eof();
  text_ = {line_.data(), static_cast<std::size_t>(count) - (newline ? 1 : 0)};
  if (line_number_ == 1 && text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // byte order mark
  text_ = unquoted(text_);
  return true;
}

void DelimitedText::split() {
  cells_.clear();
  std::string_view rest = text_;
  for (;;) {
    const std::size_t comma = rest.find(',');
    cells_.push_back(unquoted(rest.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    rest.remove_prefix(comma + 1);
  }
}

std::string_view DelimitedText::cell(int column) const {
  return column >= 0 && static_cast<std::size_t>(column) < cells_.size() ? cells_[column] : std::string_view();
}

std::optional<double> DelimitedText::number(int column) const {
  const auto value = parsed<double>(cell(column));
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> DelimitedText::integer(int column) const { return parsed<std::int64_t>(cell(column)); }

DelimitedText open_delimited_text(const std::string& file) {
  check_is_file_or_folder(file);
  auto input = std::make_unique<std::ifstream>(file, std::ios::binary);
  if (!*input) throw Error("cannot be read", {file, {}, {}, {}, {}});
  return DelimitedText(std::move(input), file);
}

}  // namespace isobath
