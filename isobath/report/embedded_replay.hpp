// EmbeddedReplay: the replay of a run that its report embeds (web/README.md, "A run in a page"): samples of the display
// at moments of the run's own clock.
//
//   EmbeddedReplay replay(configuration.report);
//   replay.sample(time, items);                        // after each event: takes one every `replay_s`
//   const std::string recording = replay.finish(last, items);
//   page_with_recording(live_page(), recording);       // the page that HtmlReport shows
//
// Size: the newest version of each item is always kept. When the replaced versions exceed the bound, the kind of item
// that takes most bytes is thinned: of each of its items only the last version in every interval is kept, and the
// interval doubles each time. Echoes thus become rare long before a position of the vehicle is left out. Whatever the
// bound:
//   - the first and the last moment are complete, and no decision and no point of the track is missing at the end,
//     because each is an item of its own or part of one that only grows;
//   - at any moment an item is shown as it was then, or as it was before the current interval of its kind began; it is
//     never shown as it was later.
// If the first and the last moment alone are too large for the report, there is no replay.
//
// Going back: a complete block is written when the changes since the last one take kWholeAfter times its bytes. A jump
// thus reads at most that much more than it shows, and the replay grows by a quarter at most.
//
// The same calls give the same bytes: times of real clocks (kTimes) and items of a single page (kClock, kRefusal) are
// left out.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/configuration/report_config.hpp>
#include <isobath/display/display_state.hpp>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isobath {

class EmbeddedReplay {
 public:
  static constexpr std::size_t kWholeAfter = 4;

  explicit EmbeddedReplay(const ReportConfig& config);
  /// Whether the report is to embed a replay, and the program contains the page that shows it.
  static bool wanted(const ReportConfig& config);

  /// Takes a sample, if one is due.
  void sample(Time time, const DisplayState& items);
  /// Takes the last sample and returns the replay: gzip in base64. Empty if nothing was ever shown, or if the replay is
  /// too large for the report.
  [[nodiscard]] std::string finish(Time last, const DisplayState& items);

  /// Time between two moments of a kind of item, s: replay_s times a power of two.
  [[nodiscard]] double interval_s(DisplayKind kind) const { return interval_s_[index_of(kind)]; }
  /// Bytes of the records that belong neither to the first moment nor are the newest of their item. After any call they
  /// are at most `max_replaced`.
  [[nodiscard]] std::size_t replaced() const { return bytes_ - first_bytes_ - newest_bytes_; }
  [[nodiscard]] std::size_t max_replaced() const { return max_replaced_; }

 private:
  using Key = std::pair<DisplayKind, std::uint64_t>;
  struct Block {
    Time time;
    std::vector<std::string> records;
  };
  struct Newest {
    std::size_t bytes;  ///< 0: the record is in the first block
    bool gone;
  };
  static constexpr std::size_t kKinds = static_cast<std::size_t>(kLastDisplayKind) + 1;
  static std::size_t index_of(DisplayKind kind) { return static_cast<std::size_t>(kind); }

  void take(Time time, const DisplayState& items);
  void put(Block& block, const DisplayRecord& record);
  void thin(DisplayKind kind);
  void thin_to(std::size_t max_replaced);
  [[nodiscard]] DisplayKind heaviest() const;
  [[nodiscard]] std::string blocks() const;

  ReportConfig config_;
  std::size_t max_replaced_;
  std::vector<Block> blocks_;
  std::map<Key, Newest> newest_;
  std::array<double, kKinds> interval_s_;
  std::size_t bytes_ = 0;         ///< of all records
  std::size_t first_bytes_ = 0;   ///< of the records of the first block
  std::size_t newest_bytes_ = 0;  ///< of the later records that are the newest of their item
  std::uint64_t stamp_ = 0;       ///< stamp of the display at the last sample
};

/// The page with an embedded run, which it plays instead of connecting to a program. Throws std::logic_error if the
/// page has no placeholder for a run.
std::string page_with_recording(std::string_view page, std::string_view recording);

}  // namespace isobath
