#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap.hpp>
#include <isobath/recording/recorded_display.hpp>
#include <isobath/recording/run_recorder.hpp>

namespace isobath {
namespace {

std::uint64_t log_time_of(Time time) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(time.time_since_epoch().count(), 0));
}

Time time_of_log(std::uint64_t ns) { return Time(Duration(static_cast<std::int64_t>(ns & ~(std::uint64_t{1} << 63)))); }

std::string_view records_in(const McapMessage& message) {
  return {reinterpret_cast<const char*>(message.data.data()), message.data.size()};
}

}  // namespace

bool is_recording(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  std::array<char, 8> head{};
  std::ifstream(file, std::ios::binary).read(head.data(), head.size());
  if (!looks_like_mcap({reinterpret_cast<const std::uint8_t*>(head.data()), head.size()})) return false;
  const McapIndex index(file);
  return index.channel_of(kDisplayTopic).has_value();
}

RecordedDisplay::RecordedDisplay(const std::filesystem::path& file) : index_(file) {
  find_channels();
  if (index_.complete() && !changes_) {
    throw Error("is not a recording of a run", {file.string(), {}, {}, {}, {}}, "a recording of isobath");
  }
}

void RecordedDisplay::find_channels() {
  if (!changes_) changes_ = index_.channel_of(kDisplayTopic);
  if (!wholes_) wholes_ = index_.channel_of(kWholeDisplayTopic);
}

bool RecordedDisplay::refresh() {
  const bool grown = index_.refresh();
  if (grown) find_channels();
  grown_ = grown_ || grown;
  return grown;
}

std::optional<RecordedDisplay::Span> RecordedDisplay::span() {
  if (!changes_) return std::nullopt;
  const auto last = index_.time_before(*changes_, ~std::uint64_t{0});
  if (!last) return std::nullopt;
  const bool at_zero = index_.time_before(*changes_, 1).has_value();
  const std::uint64_t first = at_zero ? 0 : index_.time_after(*changes_, 0).value_or(*last);
  return Span{time_of_log(first), time_of_log(*last)};
}

void RecordedDisplay::take_changes(std::uint64_t from, std::uint64_t to, DisplayState& items) {
  const std::uint16_t channel = *changes_;
  index_.visit({&channel, 1}, from, to, [&](const McapMessage& message) {
    items.update(records_in(message));
    at_ = time_of_log(message.log_time);
    return true;
  });
}

void RecordedDisplay::seek(Time time, DisplayState& items) {
  at_.reset();
  grown_ = false;
  DisplayState then;
  const std::uint64_t to = log_time_of(time);
  std::uint64_t from = 0;
  if (const auto whole = wholes_ ? index_.last(*wholes_, to) : std::nullopt) {
    then.update(records_in(*whole));
    at_ = time_of_log(whole->log_time);
    from = whole->log_time + 1;
  }
  if (changes_) take_changes(from, to, then);
  items.become(then, time);
}

void RecordedDisplay::advance(Time time, DisplayState& items) {
  // far ahead, a complete sample takes less to read than all changes until there
  constexpr Duration kNear = std::chrono::seconds(5);
  if (!at_ || time < *at_ || time - *at_ > kNear) return seek(time, items);
  // a recording that has grown may hold a second sample at the time of the last one
  const std::uint64_t from = log_time_of(*at_) + (std::exchange(grown_, false) ? 0 : 1);
  if (changes_) take_changes(from, log_time_of(time), items);
}

std::optional<Time> RecordedDisplay::moment_after(Time time) {
  const auto after = changes_ ? index_.time_after(*changes_, log_time_of(time)) : std::nullopt;
  return after ? std::optional(time_of_log(*after)) : std::nullopt;
}

std::optional<Time> RecordedDisplay::moment_before(Time time) {
  const auto before = changes_ ? index_.time_before(*changes_, log_time_of(time)) : std::nullopt;
  return before ? std::optional(time_of_log(*before)) : std::nullopt;
}

}  // namespace isobath
