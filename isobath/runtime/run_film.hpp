// RunFilm: a run as its report carries it, so that the page in the report shows it again (web/README.md, "A run in a
// page"): samples of the display at moments of the run's own clock.
//
//   RunFilm film(configuration.report);
//   film.sample(time, items);                          // after each event: takes one every `film_s`
//   const std::string recording = film.finish(last, items);
//   page_with_recording(live_page(), recording);       // what HtmlReport shows
//
// Bounded: an item as it is now is there in any case, as in the display itself. Where what newer records have replaced
// grows beyond the bound, the kind of item that weighs most there is thinned: each of its items is kept as it was at
// the end of every stretch of time, stretches twice as long each time. So echoes become rare long before a place of the
// vehicle is left out. Whatever the bound:
//   - the first moment and the last are whole, and no decision and no place of the track is missing at the end, as each
//     is an item of its own or part of one that only grows;
//   - at any moment an item is shown as it was then, or as it was before the stretch of its kind began: never as it
//     was later.
// A film whose bare first and last moment are too much for the report is none.
//
// Going back: a block of all there is stands wherever the changes since the last one are kWholeAfter times as many
// bytes, so that a jump reads at most that much more than what it shows, and the film grows by a quarter at most.
//
// The same calls give the same bytes: what real clocks measured (kTimes) and what one page alone is told (kClock,
// kRefusal) is left out.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/runtime/display_items.hpp>
#include <isobath/runtime/report_config.hpp>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isobath {

class RunFilm {
 public:
  static constexpr std::size_t kWholeAfter = 4;

  explicit RunFilm(const ReportConfig& config);
  /// Whether a report is to carry its run, and the program has the page that shows it.
  static bool wanted(const ReportConfig& config);

  /// Takes a sample, if one is due.
  void sample(Time time, const DisplayItems& items);
  /// Takes what came last, and gives all of it: gzip in base64. Empty where nothing was ever shown, or too much for the
  /// report.
  [[nodiscard]] std::string finish(Time last, const DisplayItems& items);

  /// s between two moments of a kind of item: film_s times a power of two.
  [[nodiscard]] double interval_s(DisplayKind kind) const { return interval_s_[index_of(kind)]; }
  /// Bytes of records that are neither of the first moment nor the last of their item; after any call no more than
  /// `most_replaced`.
  [[nodiscard]] std::size_t replaced() const { return bytes_ - first_bytes_ - newest_bytes_; }
  [[nodiscard]] std::size_t most_replaced() const { return most_replaced_; }

 private:
  using Key = std::pair<DisplayKind, std::uint64_t>;
  struct Block {
    Time time;
    std::vector<std::string> records;
  };
  struct Newest {
    std::size_t bytes;  ///< 0: it stands in the first block
    bool gone;
  };
  static constexpr std::size_t kKinds = static_cast<std::size_t>(kLastDisplayKind) + 1;
  static std::size_t index_of(DisplayKind kind) { return static_cast<std::size_t>(kind); }

  void take(Time time, const DisplayItems& items);
  void put(Block& block, const DisplayRecord& record);
  void thin(DisplayKind kind);
  void thin_to(std::size_t most_replaced);
  [[nodiscard]] DisplayKind heaviest() const;
  [[nodiscard]] std::string blocks() const;

  ReportConfig config_;
  std::size_t most_replaced_;
  std::vector<Block> blocks_;
  std::map<Key, Newest> newest_;
  std::array<double, kKinds> interval_s_;
  std::size_t bytes_ = 0;         ///< of all records
  std::size_t first_bytes_ = 0;   ///< of those of the first block
  std::size_t newest_bytes_ = 0;  ///< of those later ones that nothing has replaced
  std::uint64_t stamp_ = 0;       ///< of the display, up to which it was taken
};

/// The page with a run in it, which it plays in place of what a program says. Throws std::logic_error where the page
/// has no place for one.
std::string page_with_recording(std::string_view page, std::string_view recording);

}  // namespace isobath
