// ChunkTable: the chunks of an MCAP file: the position of each, what is known without unpacking it, and its messages
// once it is unpacked. Internal to mcap_index.cpp; mcap_index.hpp states the guarantees for damaged and growing files.
#pragma once

#include <isobath/io/mcap/mcap_file.hpp>
#include <list>

namespace isobath::mcap {

/// What is known of a chunk without unpacking it.
struct IndexedChunk {
  std::uint64_t start = 0, end = 0;                                   ///< log times
  std::uint64_t offset = 0, length = 0;                               ///< position of the record in the file
  std::vector<std::pair<std::uint16_t, std::uint64_t>> indexes = {};  ///< channel, offset of its message index
  bool knows_channels = false;                                        ///< whether `indexes` lists all its channels
  bool damaged = false;
  [[nodiscard]] bool may_hold(std::uint16_t channel) const;
};

struct PlacedMessage {
  std::uint64_t time = 0;
  std::uint64_t offset = 0;  ///< position of the record's content in the chunk
  std::uint64_t size = 0;
  std::uint16_t channel = 0;
};

struct UnpackedChunk {
  std::size_t chunk = 0;
  Buffer bytes;
  std::vector<PlacedMessage> messages;  ///< in the order of the chunk
  [[nodiscard]] std::uint64_t size() const { return bytes.size() + messages.size() * sizeof(PlacedMessage); }
};
using Unpacked = std::shared_ptr<const UnpackedChunk>;

McapMessage message_at(const Unpacked& chunk, const PlacedMessage& at);

class ChunkTable {
 public:
  /// Caches up to `cache_bytes` of the most recently used unpacked chunks.
  ChunkTable(std::unique_ptr<std::istream> input, const std::string& name, std::uint64_t cache_bytes);

  bool refresh();
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] const std::vector<IndexedChunk>& chunks() const { return chunks_; }
  /// An unpacked chunk; null if it is damaged.
  Unpacked unpacked(std::size_t chunk);
  /// The log times of a channel's messages in a chunk, rising.
  std::vector<std::uint64_t> times(std::size_t chunk, std::uint16_t channel);
  /// Marks a chunk whose index was wrong: from now on only its messages are used.
  void distrust(std::size_t chunk) { chunks_[chunk].knows_channels = false; }

  std::map<std::uint16_t, McapSchema> schemas;
  std::map<std::uint16_t, McapChannel> channels;
  McapChunkCounts counts;
  SourceReport report;

 private:
  bool take_summary(const SummaryBytes& summary);
  bool take_chunk_index(std::span<const std::uint8_t> content, std::uint64_t limit);
  void add_definition(std::uint8_t opcode, std::span<const std::uint8_t> content);
  void walk();
  bool walk_record(std::uint8_t opcode, std::uint64_t size);
  bool walk_chunk(std::uint64_t size);
  void close_tail();
  bool resynchronise(const char* reason);
  std::string unpack(const IndexedChunk& at, UnpackedChunk& out);
  void list_messages(UnpackedChunk& chunk);
  std::optional<std::vector<std::uint64_t>> indexed_times(const IndexedChunk& chunk, std::uint16_t channel);

  SeekableInput input_;
  std::uint64_t cache_bytes_;
  std::vector<IndexedChunk> chunks_;  ///< in the order of the file
  bool complete_ = false;
  std::uint64_t position_ = 8;  ///< position of the walk
  bool tail_open_ = false;      ///< whether message indexes of the last chunk may still follow
  std::list<Unpacked> cache_;   ///< most recently used first
  Buffer scratch_;
};

}  // namespace isobath::mcap
