// MCAP: the container for logs that is common in this field (https://mcap.dev/spec). A file is a sequence of records
// with a type and a length: messages on channels, in compressed chunks with checksums, and a summary at the end.
// McapWriter and McapReader do not interpret the messages.
//
// Writer: schemas, channels, metadata and attachments are outside the chunks, before the messages that need them. The
// writer passes each chunk with its index to the operating system as a whole when it is full or old enough. A truncated
// file is therefore readable up to its last complete chunk, and a killed program loses less than one chunk per group of
// channels. Channels that are read together share chunks; another group has its own chunks, so that a reader by index
// (mcap_index.hpp) unpacks nothing else. A power failure also loses what the operating system has not yet written
// (seconds, by default up to half a minute), unless `sync` waits for the disk at each chunk.
// Reader: always in the order of the file. A valid summary (magic, CRC) helps with damage: it gives the channels and
// the position of the next chunk. Without a summary, the reader searches for a plausible chunk head. Damage in a chunk
// loses that chunk.
// Errors: the writer throws Error if the disk refuses. The reader throws Error only if the file does not begin as MCAP.
// Bounds: at most kMaxMcapChunkBytes per chunk, packed or unpacked; nothing is allocated by a length that the file
// cannot hold.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <isobath/base/config.hpp>
#include <isobath/event/event.hpp>
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
  double chunk_s = 5;    ///< or when its messages span more than this; 0: no limit
  bool sync = false;     ///< waits until each chunk is on the disk
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
  std::shared_ptr<const void> storage;  ///< set for messages that were read: keeps `data` alive
};

/// The work that McapIndex has done for its queries.
struct McapChunkCounts {
  std::uint64_t chunks = 0;
  std::uint64_t unpacked = 0;        ///< how often a chunk was read and unpacked
  std::uint64_t unpacked_bytes = 0;  ///< bytes of these chunks, unpacked
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
  /// `profile`: the convention that channels and schemas follow, as the head of the file states it ("ros2").
  McapWriter(const std::filesystem::path& file, const McapWriterConfig& config, const std::string& profile = {});
  ~McapWriter();  ///< closes; hides errors, so call close() first
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// The writer assigns ids in order, from 1; it ignores the ids of the arguments.
  std::uint16_t add_schema(McapSchema schema);
  /// Within a group, messages keep the order in which they were written; across groups they may not.
  std::uint16_t add_channel(McapChannel channel, int group = 0);
  /// Writes a message on a channel that was added before.
  void write(const McapMessage& message);
  void add_metadata(const McapMetadata& metadata);
  void add_attachment(const McapAttachment& attachment);
  /// Writes all buffered messages to make them safe.
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

  /// The next message in the order of the file; empty at the end.
  std::optional<McapMessage> next();

  /// Those known so far; complete at the end, or from the start if the file has a summary. Null: unknown id.
  [[nodiscard]] const McapSchema* schema(std::uint16_t id) const;
  [[nodiscard]] const McapChannel* channel(std::uint16_t id) const;
  [[nodiscard]] const std::map<std::uint16_t, McapChannel>& channels() const;
  /// Those read so far; those at the head of the file are known from the start.
  [[nodiscard]] const std::vector<McapMetadata>& metadata() const;
  [[nodiscard]] const std::vector<McapAttachment>& attachments() const;
  /// The number of messages that a valid summary states.
  [[nodiscard]] std::optional<std::uint64_t> messages_in_summary() const;
  [[nodiscard]] const SourceReport& report() const;
  [[nodiscard]] SourceReport& report();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
