#include <algorithm>
#include <cstring>
#include <isobath/display/display_state.hpp>
#include <utility>
#include <vector>

namespace isobath {
namespace {

constexpr std::size_t kHead = 24;
constexpr std::size_t kAlign = 8;
constexpr std::uint8_t kGone = 1, kForget = 2, kForgetKind = 4;

struct RecordHead {
  std::uint8_t kind;
  std::uint8_t flags;
  std::uint16_t zero;
  std::uint32_t bytes;
  std::uint64_t number;
  std::int64_t time;
};
static_assert(sizeof(RecordHead) == kHead);

std::size_t padded(std::size_t bytes) { return (bytes + kAlign - 1) / kAlign * kAlign; }

/// Whether there are items of this kind.
bool is_kind(std::uint8_t kind) {
  const auto within = [kind](DisplayKind first, DisplayKind last) {
    return kind >= static_cast<std::uint8_t>(first) && kind <= static_cast<std::uint8_t>(last);
  };
  return within(DisplayKind::kScene, DisplayKind::kPartner) || within(DisplayKind::kSignals, DisplayKind::kSignals);
}

bool is_bulky(DisplayKind kind) {
  return kind == DisplayKind::kEchoes || kind == DisplayKind::kGrid || kind == DisplayKind::kDepth ||
         kind == DisplayKind::kCubes || kind == DisplayKind::kSphere;
}

bool is_of(DisplayPart part, DisplayKind kind) {
  const bool voxels = kind == DisplayKind::kVoxels;
  switch (part) {
    case DisplayPart::kAll: return true;
    case DisplayPart::kAllButVoxels: return !voxels;
    case DisplayPart::kVoxels: return voxels;
    case DisplayPart::kUrgent: return !voxels && !is_bulky(kind);
    case DisplayPart::kBulky: return is_bulky(kind);
  }
  return false;
}

}  // namespace

void append_record(std::string& out, DisplayKind kind, std::uint64_t number, Time time, std::string_view payload,
                   bool gone) {
  const RecordHead head{static_cast<std::uint8_t>(kind),
                        gone ? kGone : std::uint8_t{0},
                        0,
                        static_cast<std::uint32_t>(gone ? 0 : payload.size()),
                        number,
                        time.time_since_epoch().count()};
  out.append(reinterpret_cast<const char*>(&head), kHead);
  if (gone) return;
  out.append(payload);
  out.append(padded(payload.size()) - payload.size(), '\0');
}

void mark_as_whole(std::string& records, DisplayPart part) {
  if (records.size() < kHead || part == DisplayPart::kBulky) return;
  records[1] = static_cast<char>(records[1] | (part == DisplayPart::kVoxels ? kForgetKind : kForget));
}

std::size_t for_each_record(std::string_view records, const std::function<void(const DisplayRecord&)>& take) {
  std::size_t at = 0;
  while (records.size() - at >= kHead) {
    RecordHead head;
    std::memcpy(&head, records.data() + at, kHead);
    const std::size_t size = kHead + padded(head.bytes);
    if (!is_kind(head.kind) || head.zero != 0 || size > records.size() - at) return at;
    take({static_cast<DisplayKind>(head.kind), (head.flags & kGone) != 0, (head.flags & kForget) != 0,
          (head.flags & kForgetKind) != 0, head.number, Time{Duration(head.time)},
          records.substr(at + kHead, head.bytes)});
    at += size;
  }
  return at;
}

std::size_t DisplayState::KeyHash::operator()(const Key& key) const {
  const std::uint64_t mixed = (key.number ^ static_cast<std::uint64_t>(key.kind) << 56) * 0x9e3779b97f4a7c15u;
  return mixed ^ mixed >> 29;
}

void DisplayState::put(Item item) {
  last_ = first_ ? std::max(last_, item.time) : item.time;
  if (!first_) first_ = item.time;
  const Key key{item.kind, item.number};
  const auto found = by_key_.find(key);
  if (found == by_key_.end()) {
    if (item.gone) return;
    item.stamp = ++stamp_;
    bytes_ += item.payload->size();
    items_.push_back(std::move(item));
    by_key_.emplace(key, std::prev(items_.end()));
    return;
  }
  Item& was = *found->second;
  const bool same = item.gone ? was.gone : !was.gone && (was.payload == item.payload || *was.payload == *item.payload);
  if (same && was.kind != DisplayKind::kEchoes) return;
  if (!was.gone) bytes_ -= was.payload->size();
  if (!item.gone) bytes_ += item.payload->size();
  item.stamp = ++stamp_;
  was = std::move(item);
  items_.splice(items_.end(), items_, found->second);
}

void DisplayState::set(DisplayKind kind, std::uint64_t number, Time time, std::string payload) {
  auto shared = std::make_shared<const std::string>(std::move(payload));
  const std::lock_guard lock(mutex_);
  put({kind, false, number, 0, time, std::move(shared)});
}

void DisplayState::remove(DisplayKind kind, std::uint64_t number, Time time) {
  const std::lock_guard lock(mutex_);
  put({kind, true, number, 0, time, nullptr});
}

std::size_t DisplayState::update(std::string_view records) {
  return for_each_record(records, [this](const DisplayRecord& record) {
    if (record.forget) clear();
    if (record.forget_kind) remove_all(record.kind, record.time);
    if (record.gone) {
      remove(record.kind, record.number, record.time);
    } else {
      set(record.kind, record.number, record.time, std::string(record.payload));
    }
  });
}

void DisplayState::become(const DisplayState& wanted, Time time) {
  const std::scoped_lock lock(mutex_, wanted.mutex_);
  std::vector<Item> gone;
  for (const Item& item : items_) {
    if (item.gone) continue;
    const auto found = wanted.by_key_.find({item.kind, item.number});
    if (found == wanted.by_key_.end() || found->second->gone)
      gone.push_back({item.kind, true, item.number, 0, time, {}});
  }
  for (Item& item : gone) put(std::move(item));
  for (const Item& item : wanted.items_) {
    if (!item.gone) put(item);
  }
}

void DisplayState::remove_all(DisplayKind kind, Time time) {
  const std::lock_guard lock(mutex_);
  std::vector<Item> gone;
  for (const Item& item : items_) {
    if (item.kind == kind && !item.gone) gone.push_back({kind, true, item.number, 0, time, {}});
  }
  for (Item& item : gone) put(std::move(item));
}

void DisplayState::clear() {
  const std::lock_guard lock(mutex_);
  items_.clear();
  by_key_.clear();
  bytes_ = 0;
  cleared_ = ++stamp_;
}

std::uint64_t DisplayState::stamp() const {
  const std::lock_guard lock(mutex_);
  return stamp_;
}

DisplayState::Changes DisplayState::changes_after(std::uint64_t stamp, std::size_t max_bytes, DisplayPart part) const {
  std::vector<Item> changed;
  Changes changes;
  std::size_t bytes = 0;
  {
    const std::lock_guard lock(mutex_);
    const bool whole = stamp <= cleared_;
    auto from = items_.begin();
    if (!whole) {  // search from both ends: readers are near the beginning or, if they keep up, near the end
      for (auto end = items_.end(); from != end && from->stamp <= stamp; ++from) {
        if (std::prev(end)->stamp <= stamp) {
          from = end;
          break;
        }
        --end;
      }
    }
    changes.stamp = stamp_;
    for (; from != items_.end(); ++from) {
      if ((whole && from->gone) || !is_of(part, from->kind)) continue;
      const std::size_t size = kHead + (from->gone ? 0 : padded(from->payload->size()));
      if (!changed.empty() && size > max_bytes - std::min(bytes, max_bytes)) {
        changes.stamp = changed.back().stamp;
        changes.more = true;
        break;
      }
      bytes += size;
      changed.push_back(*from);
    }
    if (whole && changed.empty()) changes.stamp = cleared_;  // no record to mark: the next call must be whole too
    changes.whole = whole && !changed.empty();
  }
  changes.records.reserve(bytes);
  for (const Item& item : changed) {
    append_record(changes.records, item.kind, item.number, item.time,
                  item.gone ? std::string_view() : std::string_view(*item.payload), item.gone);
  }
  if (changes.whole) mark_as_whole(changes.records, part);
  return changes;
}

std::pair<Time, Time> DisplayState::times() const {
  const std::lock_guard lock(mutex_);
  return {first_.value_or(Time{}), last_};
}

std::size_t DisplayState::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace isobath
