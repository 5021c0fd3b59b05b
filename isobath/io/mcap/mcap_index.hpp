// McapIndex: seeking in an MCAP file (mcap.hpp). It finds the messages of some channels between two times, and the last
// message before a time, and reads only the chunks that hold them.
//
// For a file that its writer closed, the summary gives the chunks. A file that was truncated, is damaged, or is still
// being written, by this program or another, is walked chunk by chunk without unpacking any; `refresh` continues the
// walk.
//
// Cost: opening reads the summary, or about 60 bytes and the message indexes of each chunk. A query compares the times
// of all chunks (some microseconds per thousand chunks) and unpacks the chunks that it needs. Up to kCacheBytes of the
// most recently used chunks stay unpacked. Messages outside of chunks have no index and are not found.
//
// Input is not trusted, as in McapReader: a damaged chunk is skipped and reported, a message that cannot be read or is
// on an unknown channel is counted, and nothing is allocated by a length that the file cannot hold. A wrong message
// index can hide messages, and has no other effect. Errors: the constructor throws Error if the file cannot be read or
// does not begin as MCAP; afterwards nothing throws. One thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <isobath/io/mcap/mcap.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace isobath {

class McapIndex {
 public:
  static constexpr std::uint64_t kCacheBytes = 64u << 20;
  /// Chunks that overlap in time are merged as long as the open chunks do not exceed this size. Beyond it, and only
  /// then, messages may come out of order.
  static constexpr std::uint64_t kMaxMerged = 256u << 20;

  explicit McapIndex(const std::filesystem::path& file);
  McapIndex(std::unique_ptr<std::istream> input, const std::string& name);
  ~McapIndex();

  /// Reads what was appended since the last call. True if there was anything.
  bool refresh();
  /// Whether the writer has closed the file.
  [[nodiscard]] bool complete() const;

  struct Span {
    std::uint64_t first = 0, last = 0;  ///< ns
  };
  /// The time span of all chunks; empty if there are none.
  [[nodiscard]] std::optional<Span> span() const;
  /// The channels from the summary, or found in the walk so far.
  [[nodiscard]] const std::map<std::uint16_t, McapChannel>& channels() const;
  [[nodiscard]] const McapSchema* schema(std::uint16_t id) const;
  /// The first channel of this topic.
  [[nodiscard]] std::optional<std::uint16_t> channel_of(std::string_view topic) const;

  /// Receives the messages in order of time; at equal times, in the order of the file. Returns false to stop.
  using Visit = std::function<bool(const McapMessage&)>;
  /// Visits the messages of these channels with from <= log time <= to.
  void visit(std::span<const std::uint16_t> channels, std::uint64_t from, std::uint64_t to, const Visit& visit);
  /// The last message of a channel at or before a time; of several with that time, the one that was written last.
  std::optional<McapMessage> last(std::uint16_t channel, std::uint64_t time);
  /// The times of a channel's nearest messages strictly before and strictly after a time.
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
