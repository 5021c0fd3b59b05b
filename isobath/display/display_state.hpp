// DisplayState: what a page knows of a run, as items that replace one another. An item has a kind, a number, a time and
// opaque bytes (docs/live-page.md has the kinds and the form of a record).
//
// A reader asks for what has changed since its last request and gets the newest of each item: a slow reader gets fewer
// versions of an item, never older ones. The live page, the recorder and the player of a recording each hold one
// DisplayState.
//
// Stamps count changes from 1. Any number of threads; a call holds the lock only while it copies pointers. Errors:
// update() rejects records that do not fit and returns how many bytes were whole.
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
  kSphere,
  kSounds,
  kLevels,
  kPartner,
  kPacked,   ///< on the way to a page only, no item: records that are packed (docs/live-page.md)
  kPreview,  ///< to one page only, no item: the answer to its preview of a mission
  kSignals,
};
inline constexpr DisplayKind kLastDisplayKind = DisplayKind::kSignals;

/// Voxels (kVoxels) are most of the bytes, and cubes (kCubes) show the same more coarsely. So voxels are sent apart, to
/// readers that ask for them, and nothing waits for them. On a slow link kBulky (samples of the sonars, maps) waits for
/// kUrgent (what an operator acts on); together they are kAllButVoxels.
enum class DisplayPart : std::uint8_t { kAll, kAllButVoxels, kVoxels, kUrgent, kBulky };

/// Whether something is due: it was never shown, time went back, or `interval` has passed since.
inline bool show_again(const std::optional<Time>& shown, Time now, Duration interval) {
  return !shown || now < *shown || now - *shown >= interval;
}

/// Appends one record in the form that is sent and recorded. `gone`: the item was removed.
void append_record(std::string& out, DisplayKind kind, std::uint64_t number, Time time, std::string_view payload,
                   bool gone = false);
/// One record, as read.
struct DisplayRecord {
  DisplayKind kind;
  bool gone, forget;  ///< forget: first forget all items
  bool forget_kind;   ///< first forget all items of this kind
  std::uint64_t number;
  Time time;
  std::string_view payload;
};
/// Returns how many bytes held whole, valid records.
std::size_t for_each_record(std::string_view records, const std::function<void(const DisplayRecord&)>& take);
/// Marks the first record of `records` so that a page first forgets all items, or the voxels alone. Does nothing
/// without a record, and for kBulky, which follows on kUrgent.
void mark_as_whole(std::string& records, DisplayPart part = DisplayPart::kAll);

class DisplayState {
 public:
  /// The same payload again is no change, except for echoes: each ping is one. `time`: of the content.
  void set(DisplayKind kind, std::uint64_t number, Time time, std::string payload);
  void remove(DisplayKind kind, std::uint64_t number, Time time);
  /// Applies records as append_record writes them. Returns how many bytes were applied: fewer than all if a record does
  /// not fit.
  std::size_t update(std::string_view records);
  /// Makes these items equal to those of `wanted`; items that are the same stay untouched. `time`: of the removals.
  void become(const DisplayState& wanted, Time time);
  void clear();

  /// The stamp of the last change.
  [[nodiscard]] std::uint64_t stamp() const;
  struct Changes {
    std::string records;      ///< oldest change first
    std::uint64_t stamp = 0;  ///< of the last change included
    bool whole = false;       ///< the reader must forget what it has
    bool more = false;        ///< there are later changes: ask again after the stamp
  };
  /// The changes of a part after a stamp; after 0, the whole part. At most `max_bytes`, unless the first item alone is
  /// larger.
  [[nodiscard]] Changes changes_after(std::uint64_t stamp,
                                      std::size_t max_bytes = std::numeric_limits<std::size_t>::max(),
                                      DisplayPart part = DisplayPart::kAll) const;
  /// Times of the first and of the latest change; both 0 without any.
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
  std::list<Item> items_;  ///< the last changed at the end
  std::unordered_map<Key, std::list<Item>::iterator, KeyHash> by_key_;
  std::uint64_t stamp_ = 0;
  std::uint64_t cleared_ = 0;  ///< stamp of the last clear()
  std::size_t bytes_ = 0;
  std::optional<Time> first_;
  Time last_;
};

}  // namespace isobath
