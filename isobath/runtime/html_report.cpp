#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/runtime/html_report.hpp>

namespace isobath {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --ink: #1d2023; --paper: #fff; --faint: #6a7076; --line: #d7dadd; --warn: #b34700; --note: #fff4e5; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e8ea; --paper: #16191c; --faint: #9aa1a8; --line: #353b41; --warn: #ffb066; --note: #33260f; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.5rem 1.25rem 4rem; max-width: 76rem; background: var(--paper); color: var(--ink);
       font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.6rem; margin: 0 0 .25rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .5rem; }
.lead { color: var(--faint); margin: 0 0 1rem; }
.warning { border-left: 4px solid var(--warn); background: var(--note); padding: .5rem .75rem; }
.row { display: grid; grid-template-columns: repeat(auto-fit, minmax(22rem, 1fr)); gap: 1rem; align-items: start; }
figure { margin: .5rem 0; } figure img { max-width: 100%; height: auto; background: #fff; border: 1px solid var(--line); }
figcaption { color: var(--faint); font-size: .9rem; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { border-bottom: 1px solid var(--line); padding: .25rem .8rem .25rem 0; text-align: left; vertical-align: top; }
th { font-weight: 600; } pre { overflow-x: auto; font-size: .85rem; } summary { cursor: pointer; }
@media print { body { max-width: none; } details { display: none; } }
)";

std::string base64(std::string_view bytes) {
  static constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    for (std::size_t j = 0; j < 3; ++j)
      word = word << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) out += i + j > bytes.size() ? '=' : kAlphabet[word >> (18 - 6 * j) & 63];
  }
  return out;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed || !std::filesystem::is_directory(folder)) {
    throw Error("cannot make the output folder", {folder.string(), {}, {}, {}, {}}, "", "choose another with --out");
  }
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw Error("cannot write", {file.string(), {}, {}, {}, {}}, "", "check space and permissions");
}

HtmlReport::HtmlReport(const std::string& title, const std::string& lead) : title_(title) {
  body_ = "<h1>" + escape_html(title) + "</h1>\n<p class=\"lead\">" + escape_html(lead) + "</p>\n";
}

void HtmlReport::heading(const std::string& title) { body_ += "<h2>" + escape_html(title) + "</h2>\n"; }
void HtmlReport::paragraph(const std::string& text) { body_ += "<p>" + escape_html(text) + "</p>\n"; }
void HtmlReport::warning(const std::string& text) { body_ += "<p class=\"warning\">" + escape_html(text) + "</p>\n"; }

void HtmlReport::figure(const std::string& png, const std::string& caption) {
  const std::string words = escape_html(caption);
  body_ += "<figure><img alt=\"" + words + "\" src=\"data:image/png;base64," + base64(png) + "\"><figcaption>" + words +
           "</figcaption></figure>\n";
}

void HtmlReport::begin_row() { body_ += "<div class=\"row\">\n"; }
void HtmlReport::end_row() { body_ += "</div>\n"; }

void HtmlReport::table(const Row& header, const std::vector<Row>& rows) {
  const auto line = [this](const Row& row, const std::string& cell) {
    body_ += "<tr>";
    for (const std::string& text : row) body_ += "<" + cell + ">" + escape_html(text) + "</" + cell + ">";
    body_ += "</tr>\n";
  };
  body_ += "<div class=\"wide\"><table>\n";
  line(header, "th");
  for (const Row& row : rows) line(row, "td");
  body_ += "</table></div>\n";
}

void HtmlReport::folded(const std::string& title, const std::string& preformatted) {
  body_ +=
      "<details><summary>" + escape_html(title) + "</summary><pre>" + escape_html(preformatted) + "</pre></details>\n";
}

std::string HtmlReport::html() const {
  return "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escape_html(title_) + "</title>\n<style>" + std::string(kStyle) + "</style></head>\n<body>\n" + body_ +
         "</body>\n</html>\n";
}

void HtmlReport::save(const std::filesystem::path& file) const { write_file(file, html()); }

}  // namespace isobath
