#include <isobath/base/base64.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/report/html_report.hpp>

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
.inside { --wide: min(100vw - 2.5rem, 110rem); width: var(--wide); margin: 1rem calc(50% - var(--wide) / 2); }
.inside iframe { display: block; width: 100%; height: min(88vh, 60rem); border: 1px solid var(--line); }
.inside p { color: var(--faint); font-size: .9rem; margin: .5rem 0; }
@media (max-width: 50rem) { .inside { width: 100vw; margin-inline: calc(50% - 50vw); } .inside iframe { border-inline: 0; }
                            .inside p { padding-inline: 1.25rem; } }
@media print { body { max-width: none; } details, .inside { display: none; } }
)";

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

HtmlReport::HtmlReport(const std::string& title, const std::string& lead) : title_(title) {
  body_ = "<h1>" + escape_html(title) + "</h1>\n<p class=\"lead\">" + escape_html(lead) + "</p>\n";
}

void HtmlReport::heading(const std::string& title) { body_ += "<h2>" + escape_html(title) + "</h2>\n"; }
void HtmlReport::paragraph(const std::string& text) { body_ += "<p>" + escape_html(text) + "</p>\n"; }
void HtmlReport::links(const std::vector<std::pair<std::string, std::string>>& links) {
  body_ += "<p>";
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& [text, path] = links[i];
    body_ += (i > 0 ? " · " : "") + ("<a href=\"" + escape_html(path)) + "\">" + escape_html(text) + "</a>";
  }
  body_ += "</p>\n";
}

void HtmlReport::warning(const std::string& text) { body_ += "<p class=\"warning\">" + escape_html(text) + "</p>\n"; }

void HtmlReport::figure(const std::string& png, const std::string& caption) {
  const std::string words = escape_html(caption);
  body_ += "<figure><img alt=\"" + words + "\" src=\"data:image/png;base64," + to_base64(png) + "\"><figcaption>" +
           words + "</figcaption></figure>\n";
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

void HtmlReport::page_inside(const std::string& title, const std::string& html, const std::string& words) {
  body_ += "<section class=\"inside\"><iframe title=\"" + escape_html(title) +
           "\" sandbox=\"allow-scripts\" allow=\"fullscreen\" srcdoc=\"" + escape_html(html) + "\"></iframe>\n<p>" +
           escape_html(words) + "</p></section>\n";
}

void HtmlReport::folded(const std::string& title, const std::string& preformatted) {
  body_ +=
      "<details><summary>" + escape_html(title) + "</summary><pre>" + escape_html(preformatted) + "</pre></details>\n";
}

std::string HtmlReport::html() const {
  return "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escape_html(title_) + "</title>\n<style>" + std::string(kStyle) +
         "</style>\n<noscript><style>.inside { display: none; }</style></noscript></head>\n<body>\n" + body_ +
         "</body>\n</html>\n";
}

void HtmlReport::save(const std::filesystem::path& file) const { write_whole_file(file, html()); }

}  // namespace isobath
