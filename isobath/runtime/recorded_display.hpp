// RecordedDisplay: what the live page showed at any time of a recording (RunRecorder), also while it is being made.
//
// A seek reads the last whole sample at or before the time and the changes after it; going on reads the changes alone.
// What is handed out are changes of the items: a page that shows them gets what differs and nothing else. A stretch of
// the file that is damaged is passed over: items may be older there than they should be, until the next whole sample.
// Times are those of samples: "moments". One thread at a time.
#pragma once

#include <filesystem>
#include <isobath/io/mcap_index.hpp>
#include <isobath/runtime/display_items.hpp>
#include <optional>

namespace isobath {

/// Whether a file is a recording that a page can show; false for any other input.
bool is_recording(const std::filesystem::path& file);

class RecordedDisplay {
 public:
  /// Throws Error where the file is no MCAP, or is complete and holds no display.
  explicit RecordedDisplay(const std::filesystem::path& file);

  /// Takes in what was recorded since; whether there was any.
  bool refresh();
  /// Whether nothing more will come.
  [[nodiscard]] bool complete() const { return index_.complete(); }

  struct Span {
    Time first, last;
  };
  /// The first and the last moment.
  [[nodiscard]] std::optional<Span> span();
  /// The moment that the items show; empty before the first seek, and before the first moment.
  [[nodiscard]] std::optional<Time> at() const { return at_; }

  /// The items become what they were at the last moment at or before a time; none before the first.
  void seek(Time time, DisplayItems& items);
  /// As seek; by the changes alone where the time lies ahead, and not far.
  void advance(Time time, DisplayItems& items);
  /// The moments beside a time, which is neither.
  [[nodiscard]] std::optional<Time> moment_after(Time time);
  [[nodiscard]] std::optional<Time> moment_before(Time time);

  [[nodiscard]] McapIndex::Counts counts() const { return index_.counts(); }
  [[nodiscard]] const SourceReport& report() const { return index_.report(); }

 private:
  void find_channels();
  /// The changes from a time to another are taken.
  void take_changes(std::uint64_t from, std::uint64_t to, DisplayItems& items);

  McapIndex index_;
  std::optional<std::uint16_t> changes_, wholes_;  ///< channels
  std::optional<Time> at_;
  bool grown_ = false;  ///< since at_
};

}  // namespace isobath
