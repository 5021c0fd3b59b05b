// DisplayItems: what a page knows of a run, as items that replace one another: each of a kind, with a number, a time
// and bytes that nobody here looks into (docs/live-page.md has the kinds and the form of a record).
//
// Who shows something asks for what has changed since it asked last, and gets the newest of each item: whoever is slow
// gets less, not later. The live page, the recorder and a recording that is played all hold one of these.
//
// Stamps count changes from 1. Any number of threads; a call holds the lock only for as long as it takes to copy
// pointers. Errors: take() refuses records that do not fit and says how many bytes were whole.
#pragma once

#include <cstdint>
#include <functional>
#include <isobath/base/time.hpp>
#include <limits>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace isobath {

enum class DisplayKind : std::uint8_t {
  kScene = 1,
  kVehicle,
  kTrack,
  kSonar,
  kEchoes,
  kGrid,
  kObstacles,
  kWay,
  kDecision,
  kDepth,
  kVoxels,
  kHealth,
  kClock,
  kRefusal,
  kTimes,
  kCubes,
};
inline constexpr DisplayKind kLastDisplayKind = DisplayKind::kCubes;

/// Voxels (kVoxels) weigh more than all else, and the cubes (kCubes) show the same at a glance: they go apart, to who
/// wants them, so that nothing waits for them.
enum class DisplayPart : std::uint8_t { kAll, kAllButVoxels, kVoxels };

/// Whether to show something again: it never was, time went back, or an interval has gone by since.
inline bool show_again(const std::optional<Time>& shown, Time now, Duration interval) {
  return !shown || now < *shown || now - *shown >= interval;
}

/// One record, as it is sent and recorded; `gone`: the item is no more.
void append_record(std::string& out, DisplayKind kind, std::uint64_t number, Time time, std::string_view payload,
                   bool gone = false);
/// One record, as it was read.
struct DisplayRecord {
  DisplayKind kind;
  bool gone, forget;  ///< forget: all items before it
  bool forget_kind;   ///< all items of this kind before it
  std::uint64_t number;
  Time time;
  std::string_view payload;
};
/// Returns how many bytes held whole records that fit.
std::size_t for_each_record(std::string_view records, const std::function<void(const DisplayRecord&)>& take);
/// Marks the first record of `records` so that a page forgets all before it takes it, or all that is of a part; does
/// nothing to nothing.
void mark_as_whole(std::string& records, DisplayPart part = DisplayPart::kAll);

class DisplayItems {
 public:
  /// An item that is as it was changes nothing, but for echoes: each ping is news. `time`: of what it tells.
  void set(DisplayKind kind, std::uint64_t number, Time time, std::string payload);
  void remove(DisplayKind kind, std::uint64_t number, Time time);
  /// Records, as append_record writes them. Returns how many bytes of them were taken: less than all where a record
  /// does not fit.
  std::size_t take(std::string_view records);
  /// These become those of another, which must not change meanwhile; what is the same in both stays untouched. `time`:
  /// of what is no more.
  void become(const DisplayItems& wanted, Time time);
  void clear();

  /// The stamp of the last change.
  [[nodiscard]] std::uint64_t stamp() const;
  struct Changes {
    std::string records;      ///< oldest change first
    std::uint64_t stamp = 0;  ///< up to which they go
    bool whole = false;       ///< what was there before is to be forgotten
    bool more = false;        ///< there are later ones: ask again after the stamp
  };
  /// What has changed of a part after a stamp. After 0: all there is of it, whole. No more than fits into `most_bytes`,
  /// but for one item that alone does not.
  [[nodiscard]] Changes changes_after(std::uint64_t stamp,
                                      std::size_t most_bytes = std::numeric_limits<std::size_t>::max(),
                                      DisplayPart part = DisplayPart::kAll) const;
  /// Of the first change and of the latest; both 0 without any.
  [[nodiscard]] std::pair<Time, Time> times() const;
  /// Bytes of all payloads.
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Item {
    DisplayKind kind;
    bool gone;
    std::uint64_t number, stamp;
    Time time;
    std::shared_ptr<const std::string> payload;
  };
  struct Key {
    DisplayKind kind;
    std::uint64_t number;
    bool operator==(const Key&) const = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };
  void put(Item item);
  void remove_all(DisplayKind kind, Time time);

  mutable std::mutex mutex_;
  std::list<Item> items_;  ///< the one changed last at the end
  std::unordered_map<Key, std::list<Item>::iterator, KeyHash> by_key_;
  std::uint64_t stamp_ = 0;
  std::uint64_t cleared_ = 0;  ///< stamp at which all was forgotten
  std::size_t bytes_ = 0;
  std::optional<Time> first_;
  Time last_;
};

}  // namespace isobath
