// MCAP: the container that logs of this field use (https://mcap.dev/spec): records with a type and a length; messages
// on channels, in compressed chunks with checksums; a summary at the end. McapWriter and McapReader know nothing of
// what messages mean.
//
// Writer: Schemas, channels, metadata and attachments stand outside the chunks, before the messages that need them;
// every chunk goes to the system as a whole with its index as soon as it is full or old enough. So a file cut off
// anywhere is readable up to its last whole chunk, and a program that is killed loses less than one chunk of each group
// of channels: channels that are read together share chunks, those of another group have chunks of their own, so that
// a reader by index (mcap_index.hpp) unpacks nothing else. When the supply fails, what the system had not yet written
// is lost too (seconds, by default half a minute), unless `sync` waits for the disk at each chunk. Reader: in the order
// of the file, always. A valid summary (magic, CRC) helps where there is damage: channels are known from it, and it
// says where the next chunk stands. Without one the next chunk is found by its look. A damaged chunk costs that chunk.
// Errors: the writer throws Error when the disk refuses; the reader throws Error only where the file does not begin as
// MCAP. Bounds: no more than kMaxChunkBytes a chunk, packed or not; nothing is allocated by a length that the file
// cannot hold.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <isobath/base/config.hpp>
#include <isobath/io/event.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

constexpr std::uint64_t kMaxMcapChunkBytes = 512u << 20;

enum class McapCompression : std::uint8_t { kNone, kLz4, kZstd };

struct McapWriterConfig {
  McapCompression compression = McapCompression::kZstd;
  int chunk_kib = 1024;  ///< a chunk is written when its messages reach this size
  double chunk_s = 5;    ///< or would be further apart than this; 0: whatever their times
  bool sync = false;     ///< waits until the disk has it
};
std::vector<Field> fields(McapWriterConfig& config);

struct McapSchema {
  std::uint16_t id = 0;  ///< never 0
  std::string name;
  std::string encoding;
  std::string data;
  bool operator==(const McapSchema&) const = default;
};

struct McapChannel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;  ///< 0: none
  std::string topic;
  std::string message_encoding;
  std::map<std::string, std::string> metadata;
  bool operator==(const McapChannel&) const = default;
};

struct McapMessage {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;  ///< ns
  std::uint64_t publish_time = 0;
  std::span<const std::uint8_t> data;
  std::shared_ptr<const void> storage;  ///< of a message that was read: keeps `data` alive
};

/// What McapIndex has done to answer its questions.
struct McapChunkCounts {
  std::uint64_t chunks = 0;
  std::uint64_t unpacked = 0;        ///< times that a chunk was read and unpacked
  std::uint64_t unpacked_bytes = 0;  ///< of these
};

struct McapAttachment {
  std::uint64_t log_time = 0;
  std::uint64_t create_time = 0;
  std::string name;
  std::string media_type;
  std::string data;
};

struct McapMetadata {
  std::string name;
  std::map<std::string, std::string> values;
};

class McapWriter {
 public:
  McapWriter(const std::filesystem::path& file, const McapWriterConfig& config);
  ~McapWriter();  ///< closes; an error then stays unseen, so call close()
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Ids are given in order, from 1; the ids of the arguments are not looked at.
  std::uint16_t add_schema(McapSchema schema);
  /// Messages stand in the file in the order in which they were written within a group, not across groups.
  std::uint16_t add_channel(McapChannel channel, int group = 0);
  /// On a channel that was added before.
  void write(const McapMessage& message);
  void add_metadata(const McapMetadata& metadata);
  void add_attachment(const McapAttachment& attachment);
  /// Writes what is left of the messages, to make them safe.
  void flush();
  /// Writes the summary; nothing can be added afterwards.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether a file begins as MCAP does.
bool looks_like_mcap(std::span<const std::uint8_t> head);

class McapReader {
 public:
  McapReader(std::unique_ptr<std::istream> input, const std::string& name);
  ~McapReader();

  /// In the order of the file; empty at the end.
  std::optional<McapMessage> next();

  /// Known so far: complete at the end, and from the start where the file has a summary. Null where there is none.
  [[nodiscard]] const McapSchema* schema(std::uint16_t id) const;
  [[nodiscard]] const McapChannel* channel(std::uint16_t id) const;
  [[nodiscard]] const std::map<std::uint16_t, McapChannel>& channels() const;
  /// Those that were passed so far; the ones at the head of the file are known from the start.
  [[nodiscard]] const std::vector<McapMetadata>& metadata() const;
  [[nodiscard]] const std::vector<McapAttachment>& attachments() const;
  /// What the summary says, where it is valid.
  [[nodiscard]] std::optional<std::uint64_t> messages_in_summary() const;
  [[nodiscard]] const SourceReport& report() const;
  [[nodiscard]] SourceReport& report();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
