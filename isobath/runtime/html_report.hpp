// HtmlReport: one self-contained page (pictures inside, nothing fetched) that opens offline and prints well. It has no
// scripts; a page that it shows inside may have, and stays by itself.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

class HtmlReport {
 public:
  HtmlReport(const std::string& title, const std::string& lead);

  void heading(const std::string& title);
  void paragraph(const std::string& text);
  /// A sentence that must not be overlooked.
  void warning(const std::string& text);
  void figure(const std::string& png, const std::string& caption);
  /// Figures that follow stand side by side where the screen is wide enough.
  void begin_row();
  void end_row();
  using Row = std::vector<std::string>;
  void table(const Row& header, const std::vector<Row>& rows);
  /// Another page, with scripts, shown inside where they run; else, and in print, neither it nor the words are there.
  void page_inside(const std::string& title, const std::string& html, const std::string& words);
  /// Folded away until it is asked for.
  void folded(const std::string& title, const std::string& preformatted);

  [[nodiscard]] std::string html() const;
  void save(const std::filesystem::path& file) const;

 private:
  std::string title_;
  std::string body_;
};

/// Untrusted text (file names, device strings) made safe to stand in a page.
std::string escape_html(std::string_view text);

/// Makes a folder for results, if it is not there; throws Error if it cannot.
void make_folder(const std::filesystem::path& folder);

/// Writes a whole file; throws Error if it cannot.
void write_file(const std::filesystem::path& file, std::string_view bytes);

}  // namespace isobath
