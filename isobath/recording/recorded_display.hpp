// RecordedDisplay: the items that the live page showed at any time of a recording (RunRecorder). The recording may
// still be growing.
//
// A seek reads the last complete sample at or before the time and the changes after it; going forward reads only the
// changes. The items are changed in place, so a page that shows them gets only what differs. A damaged part of the file
// is skipped: items may be too old there, until the next complete sample. The times of samples are called moments. One
// thread at a time.
#pragma once

#include <filesystem>
#include <isobath/display/display_state.hpp>
#include <isobath/io/mcap/mcap_index.hpp>
#include <optional>

namespace isobath {

/// Whether a file is a recording that a page can show.
bool is_recording(const std::filesystem::path& file);

class RecordedDisplay {
 public:
  /// Throws Error if the file is not MCAP, or if it is complete and holds no display.
  explicit RecordedDisplay(const std::filesystem::path& file);

  /// Reads what was recorded since the last call. Returns whether there was anything.
  bool refresh();
  /// Whether the recording is finished.
  [[nodiscard]] bool complete() const { return index_.complete(); }

  struct Span {
    Time first, last;
  };
  /// The first and the last moment.
  [[nodiscard]] std::optional<Span> span();
  /// The moment that the items show; empty before the first seek, and before the first moment.
  [[nodiscard]] std::optional<Time> at() const { return at_; }

  /// Sets the items to their state at the last moment at or before `time`; before the first moment there are none.
  void seek(Time time, DisplayState& items);
  /// The same as seek. Reads only the changes if `time` is a few seconds ahead.
  void advance(Time time, DisplayState& items);
  /// The next moment after, and the last one before a time.
  [[nodiscard]] std::optional<Time> moment_after(Time time);
  [[nodiscard]] std::optional<Time> moment_before(Time time);

  [[nodiscard]] McapIndex::Counts counts() const { return index_.counts(); }
  [[nodiscard]] const SourceReport& report() const { return index_.report(); }

 private:
  void find_channels();
  /// Applies the changes from one time to another.
  void take_changes(std::uint64_t from, std::uint64_t to, DisplayState& items);

  McapIndex index_;
  std::optional<std::uint16_t> changes_, wholes_;  ///< channels
  std::optional<Time> at_;
  bool grown_ = false;  ///< the recording has grown since at_
};

}  // namespace isobath
