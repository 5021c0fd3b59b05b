// McapIndex: seeking in an MCAP file (mcap.hpp): messages of some channels between two times, and the last one before a
// time, from the chunks that hold them and no others.
//
// A file that its writer closed is known by its summary. One that was cut off, is damaged, or is still being written,
// by this program or another, is walked chunk by chunk without unpacking any; `refresh` goes on where the walk stood.
//
// Cost: opening reads the summary, or about 60 bytes and the message indexes of each chunk; a query looks at every
// chunk's times (some microseconds a thousand) and unpacks what it needs; the chunks used last are kept unpacked,
// kCacheBytes of them. Messages outside of chunks have no index and are not found.
//
// Bytes are not trusted, as in McapReader: a chunk that is damaged is passed over and reported, a message that cannot
// be read or is on an unknown channel is counted; nothing is allocated by a length that the file cannot hold. An index
// of messages that lies can hide messages, and costs nothing else. Errors: the constructor throws Error where the file
// cannot be read or does not begin as MCAP; afterwards nothing throws. One thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <isobath/io/mcap.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace isobath {

class McapIndex {
 public:
  static constexpr std::uint64_t kCacheBytes = 64u << 20;
  /// Chunks that overlap in time are merged as long as those under way are not larger than this; then, and only then,
  /// messages may come out of order.
  static constexpr std::uint64_t kMostMerged = 256u << 20;

  explicit McapIndex(const std::filesystem::path& file);
  McapIndex(std::unique_ptr<std::istream> input, const std::string& name);
  ~McapIndex();

  /// Takes in what was appended since. Whether there was any.
  bool refresh();
  /// Whether its writer has closed the file.
  [[nodiscard]] bool complete() const;

  struct Span {
    std::uint64_t first = 0, last = 0;  ///< ns
  };
  /// Of all chunks; empty where there is none.
  [[nodiscard]] std::optional<Span> span() const;
  /// Those of the summary, or passed in the walk.
  [[nodiscard]] const std::map<std::uint16_t, McapChannel>& channels() const;
  [[nodiscard]] const McapSchema* schema(std::uint16_t id) const;
  /// The first of this topic.
  [[nodiscard]] std::optional<std::uint16_t> channel_of(std::string_view topic) const;

  /// Gets each message in the order of time, of the file where times are the same; returns false to end.
  using Visit = std::function<bool(const McapMessage&)>;
  /// Those of these channels with from <= log time <= to.
  void visit(std::span<const std::uint16_t> channels, std::uint64_t from, std::uint64_t to, const Visit& visit);
  /// The last message of a channel at or before a time: of several of that time the one that was written last.
  std::optional<McapMessage> last(std::uint16_t channel, std::uint64_t time);
  /// Times of the messages of a channel next to a time, which is not one of them.
  std::optional<std::uint64_t> time_before(std::uint16_t channel, std::uint64_t time);
  std::optional<std::uint64_t> time_after(std::uint16_t channel, std::uint64_t time);

  using Counts = McapChunkCounts;
  [[nodiscard]] Counts counts() const;
  [[nodiscard]] const SourceReport& report() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
