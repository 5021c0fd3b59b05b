// HtmlReport: one self-contained page (pictures inside, nothing fetched) that opens offline and prints well. It has no
// scripts; an embedded page may have some, and runs in a sandbox.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isobath {

class HtmlReport {
 public:
  HtmlReport(const std::string& title, const std::string& lead);

  void heading(const std::string& title);
  void paragraph(const std::string& text);
  /// Links side by side: text and the path of a file beside the report.
  void links(const std::vector<std::pair<std::string, std::string>>& links);
  /// A highlighted sentence.
  void warning(const std::string& text);
  void figure(const std::string& png, const std::string& caption);
  /// The following figures stand side by side if the screen is wide enough.
  void begin_row();
  void end_row();
  using Row = std::vector<std::string>;
  void table(const Row& header, const std::vector<Row>& rows);
  /// Embeds a page with scripts, and `words` below it. Both are hidden in print and where scripts do not run.
  void page_inside(const std::string& title, const std::string& html, const std::string& words);
  /// A section that is folded until the reader opens it.
  void folded(const std::string& title, const std::string& preformatted);

  [[nodiscard]] std::string html() const;
  void save(const std::filesystem::path& file) const;

 private:
  std::string title_;
  std::string body_;
};

/// Escapes untrusted text (file names, device strings) for a page.
std::string escape_html(std::string_view text);

/// Makes a folder for results if it does not exist; throws Error if it cannot.
void make_folder(const std::filesystem::path& folder);

}  // namespace isobath
