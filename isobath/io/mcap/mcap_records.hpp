// The bytes of MCAP records: little-endian numbers, strings and maps with a length in front, the opcodes, and the
// packing of chunks. Internal to the mcap_*.cpp files.
#pragma once

#include <cstdint>
#include <cstring>
#include <isobath/io/mcap/mcap.hpp>

namespace isobath::mcap {

constexpr std::uint8_t kMagic[8] = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::uint64_t kRecordHead = 9;  ///< opcode and length

enum Opcode : std::uint8_t {
  kHeader = 1,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kMessageIndex,
  kChunkIndex,
  kAttachment,
  kAttachmentIndex,
  kStatistics,
  kMetadata,
  kMetadataIndex,
  kSummaryOffset,
  kDataEnd,
};

using Buffer = std::vector<std::uint8_t>;
using TextMap = std::map<std::string, std::string>;

/// Appends values to a buffer.
class Writer {
 public:
  explicit Writer(Buffer& out) : out_(out) {}

  template <class Number>
  Writer& number(Number value) {
    return bytes(
        {reinterpret_cast<const std::uint8_t*>(&value), sizeof value});  // all supported machines are little-endian
  }
  Writer& bytes(std::span<const std::uint8_t> data) {
    out_.insert(out_.end(), data.begin(), data.end());
    return *this;
  }
  Writer& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    return bytes({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
  }
  Writer& map(const TextMap& values);
  /// Writes a 32-bit length and the bytes that `fill` appends.
  template <class Fill>
  Writer& counted(Fill fill) {
    const std::size_t at = out_.size();
    number(std::uint32_t{0});
    fill();
    const auto size = static_cast<std::uint32_t>(out_.size() - at - 4);
    std::memcpy(out_.data() + at, &size, 4);
    return *this;
  }
  /// Writes opcode, length and the bytes that `fill` appends.
  template <class Fill>
  Writer& record(Opcode opcode, Fill fill) {
    number(static_cast<std::uint8_t>(opcode));
    const std::size_t at = out_.size();
    number(std::uint64_t{0});
    fill();
    const std::uint64_t size = out_.size() - at - 8;
    std::memcpy(out_.data() + at, &size, 8);
    return *this;
  }

 private:
  Buffer& out_;
};

/// Reads untrusted bytes: after the first value that does not fit, `ok` is false and all further values are zero.
class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> data) : left_(data) {}

  template <class Number>
  Number number() {
    Number value{};
    const auto data = bytes(sizeof value);
    if (ok_) std::memcpy(&value, data.data(), sizeof value);
    return value;
  }
  std::span<const std::uint8_t> bytes(std::uint64_t count) {
    ok_ = ok_ && count <= left_.size();
    if (!ok_) return {};
    const auto data = left_.first(count);
    left_ = left_.subspan(count);
    return data;
  }
  std::string text() {
    const auto data = bytes(number<std::uint32_t>());
    return {reinterpret_cast<const char*>(data.data()), data.size()};
  }
  TextMap map();

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::span<const std::uint8_t> left() const { return left_; }

 private:
  std::span<const std::uint8_t> left_;
  bool ok_ = true;
};

struct Record {
  std::uint8_t opcode = 0;
  std::span<const std::uint8_t> content;
};
/// The record at the cursor; empty at the end and if the record does not fit.
std::optional<Record> take_record(Cursor& cursor);

struct ChunkHead {
  std::uint64_t start = 0;
  std::uint64_t end = 0;
  std::uint64_t unpacked_size = 0;
  std::uint32_t unpacked_crc = 0;  ///< 0: absent
  std::string compression;
  std::span<const std::uint8_t> records;
};

std::optional<McapSchema> parse_schema(std::span<const std::uint8_t> content);
std::optional<McapChannel> parse_channel(std::span<const std::uint8_t> content);
std::optional<McapMessage> parse_message(std::span<const std::uint8_t> content);
std::optional<McapMetadata> parse_metadata(std::span<const std::uint8_t> content);
/// Also empty if the checksum is wrong.
std::optional<McapAttachment> parse_attachment(std::span<const std::uint8_t> content);
std::optional<ChunkHead> parse_chunk(std::span<const std::uint8_t> content);
/// Whether a chunk of this size can begin with these bytes. Cheap; random bytes pass once in 2^64.
bool chunk_can_begin_so(std::span<const std::uint8_t> content_head, std::uint64_t content_size);
constexpr std::size_t kChunkHeadBytes = 44;  ///< the longest head that chunk_can_begin_so looks at

std::uint32_t crc32(std::span<const std::uint8_t> data, std::uint32_t before = 0);
const char* name_of(McapCompression compression);
Buffer pack(std::span<const std::uint8_t> records, McapCompression compression);
/// Unpacks a chunk. Returns what is wrong with it, or an empty text. Memory grows with the unpacked data, up to
/// `unpacked_size`.
std::string unpack(const ChunkHead& chunk, Buffer& out);

}  // namespace isobath::mcap
