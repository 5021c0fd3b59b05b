#include <algorithm>
#include <bit>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap_records.hpp>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

namespace isobath::mcap {
namespace {

static_assert(std::endian::native == std::endian::little);

/// Grows `out` as the decoder needs it; false at `limit`.
bool make_room(Buffer& out, std::size_t used, std::uint64_t limit) {
  if (used < out.size()) return true;
  if (used >= limit) return false;
  out.resize(std::min<std::uint64_t>(limit, std::max<std::uint64_t>(2 * used, 256 << 10)));
  return true;
}

std::string unpack_zstd(const ChunkHead& chunk, Buffer& out) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  ZSTD_inBuffer in{chunk.records.data(), chunk.records.size(), 0};
  std::size_t used = 0;
  for (;;) {
    const bool room = make_room(out, used, chunk.unpacked_size);
    ZSTD_outBuffer piece{out.data() + used, room ? out.size() - used : 0, 0};
    const std::size_t in_before = in.pos;
    const std::size_t left = ZSTD_decompressStream(context.get(), &piece, &in);
    used += piece.pos;
    if (ZSTD_isError(left)) return "damaged zstd data";
    if (left == 0) break;
    if (piece.pos == 0 && in.pos == in_before) return room ? "zstd data cut off" : "more data than the stated size";
  }
  out.resize(used);
  return {};
}

std::string unpack_lz4(const ChunkHead& chunk, Buffer& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) return "out of memory";
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(raw,
                                                                                     LZ4F_freeDecompressionContext);
  std::span<const std::uint8_t> in = chunk.records;
  std::size_t used = 0;
  for (;;) {
    const bool room = make_room(out, used, chunk.unpacked_size);
    std::size_t given = room ? out.size() - used : 0, taken = in.size();
    const std::size_t left = LZ4F_decompress(context.get(), out.data() + used, &given, in.data(), &taken, nullptr);
    if (LZ4F_isError(left)) return "damaged lz4 data";
    used += given;
    in = in.subspan(taken);
    if (left == 0) break;
    if (given == 0 && taken == 0) return room ? "lz4 data cut off" : "more data than the stated size";
  }
  out.resize(used);
  return {};
}

std::string unpack_records(const ChunkHead& chunk, Buffer& out) {
  if (chunk.compression == "zstd") return unpack_zstd(chunk, out);
  if (chunk.compression == "lz4") return unpack_lz4(chunk, out);
  if (!chunk.compression.empty()) return "unknown compression";
  out.assign(chunk.records.begin(), chunk.records.end());
  return {};
}

}  // namespace

Writer& Writer::map(const TextMap& values) {
  return counted([&] {
    for (const auto& [key, value] : values) text(key).text(value);
  });
}

TextMap Cursor::map() {
  Cursor entries(bytes(number<std::uint32_t>()));
  TextMap values;
  while (ok_ && !entries.left().empty()) {
    std::string key = entries.text();
    std::string value = entries.text();
    ok_ = entries.ok();
    if (ok_) values.emplace(std::move(key), std::move(value));
  }
  return values;
}

std::optional<Record> take_record(Cursor& cursor) {
  Record record;
  record.opcode = cursor.number<std::uint8_t>();
  record.content = cursor.bytes(cursor.number<std::uint64_t>());
  return cursor.ok() ? std::optional(record) : std::nullopt;
}

std::optional<McapSchema> parse_schema(std::span<const std::uint8_t> content) {
  Cursor c(content);
  McapSchema schema;
  schema.id = c.number<std::uint16_t>();
  schema.name = c.text();
  schema.encoding = c.text();
  schema.data = c.text();
  return c.ok() && schema.id != 0 ? std::optional(std::move(schema)) : std::nullopt;
}

std::optional<McapChannel> parse_channel(std::span<const std::uint8_t> content) {
  Cursor c(content);
  McapChannel channel;
  channel.id = c.number<std::uint16_t>();
  channel.schema_id = c.number<std::uint16_t>();
  channel.topic = c.text();
  channel.message_encoding = c.text();
  channel.metadata = c.map();
  return c.ok() ? std::optional(std::move(channel)) : std::nullopt;
}

std::optional<McapMessage> parse_message(std::span<const std::uint8_t> content) {
  Cursor c(content);
  McapMessage message;
  message.channel_id = c.number<std::uint16_t>();
  message.sequence = c.number<std::uint32_t>();
  message.log_time = c.number<std::uint64_t>();
  message.publish_time = c.number<std::uint64_t>();
  message.data = c.left();
  return c.ok() ? std::optional(std::move(message)) : std::nullopt;
}

std::optional<McapMetadata> parse_metadata(std::span<const std::uint8_t> content) {
  Cursor c(content);
  McapMetadata metadata;
  metadata.name = c.text();
  metadata.values = c.map();
  return c.ok() ? std::optional(std::move(metadata)) : std::nullopt;
}

std::optional<McapAttachment> parse_attachment(std::span<const std::uint8_t> content) {
  Cursor c(content);
  McapAttachment attachment;
  attachment.log_time = c.number<std::uint64_t>();
  attachment.create_time = c.number<std::uint64_t>();
  attachment.name = c.text();
  attachment.media_type = c.text();
  const auto data = c.bytes(c.number<std::uint64_t>());
  attachment.data.assign(reinterpret_cast<const char*>(data.data()), data.size());
  const std::size_t covered = content.size() - c.left().size();
  const auto crc = c.number<std::uint32_t>();
  if (!c.ok() || (crc != 0 && crc != crc32(content.first(covered)))) return std::nullopt;
  return attachment;
}

std::optional<ChunkHead> parse_chunk(std::span<const std::uint8_t> content) {
  Cursor c(content);
  ChunkHead chunk;
  chunk.start = c.number<std::uint64_t>();
  chunk.end = c.number<std::uint64_t>();
  chunk.unpacked_size = c.number<std::uint64_t>();
  chunk.unpacked_crc = c.number<std::uint32_t>();
  chunk.compression = c.text();
  chunk.records = c.bytes(c.number<std::uint64_t>());
  return c.ok() ? std::optional(std::move(chunk)) : std::nullopt;
}

bool chunk_can_begin_so(std::span<const std::uint8_t> head, std::uint64_t content_size) {
  Cursor c(head);
  const auto start = c.number<std::uint64_t>(), end = c.number<std::uint64_t>();
  const auto unpacked = c.number<std::uint64_t>();
  (void)c.number<std::uint32_t>();
  const auto length = c.number<std::uint32_t>();
  if (!c.ok() || start > end || unpacked > kMaxMcapChunkBytes || length > 4) return false;
  const auto name = c.bytes(length);
  const auto records = c.number<std::uint64_t>();
  const std::string_view text(reinterpret_cast<const char*>(name.data()), name.size());
  return c.ok() && (text.empty() || text == "lz4" || text == "zstd") && content_size <= kMaxMcapChunkBytes &&
         content_size >= 40 + length && records == content_size - 40 - length;
}

std::uint32_t crc32(std::span<const std::uint8_t> data, std::uint32_t before) {
  return static_cast<std::uint32_t>(::crc32_z(before, data.data(), data.size()));
}

const char* name_of(McapCompression compression) {
  switch (compression) {
    case McapCompression::kNone: return "";
    case McapCompression::kLz4: return "lz4";
    case McapCompression::kZstd: return "zstd";
  }
  return "";
}

Buffer pack(std::span<const std::uint8_t> records, McapCompression compression) {
  if (compression == McapCompression::kNone) return {records.begin(), records.end()};
  const bool zstd = compression == McapCompression::kZstd;
  constexpr int kFastLevel = 1;  // higher levels gain little on noisy echoes, and a vehicle records in real time
  Buffer out(zstd ? ZSTD_compressBound(records.size()) : LZ4F_compressFrameBound(records.size(), nullptr));
  const std::size_t size = zstd ? ZSTD_compress(out.data(), out.size(), records.data(), records.size(), kFastLevel)
                                : LZ4F_compressFrame(out.data(), out.size(), records.data(), records.size(), nullptr);
  ISOBATH_ASSERT(!(zstd ? ZSTD_isError(size) : LZ4F_isError(size)));
  out.resize(size);
  return out;
}

std::string unpack(const ChunkHead& chunk, Buffer& out) {
  if (chunk.unpacked_size > kMaxMcapChunkBytes) return "chunk larger than 512 MiB";
  out.clear();
  std::string problem = unpack_records(chunk, out);
  if (!problem.empty()) return "chunk: " + problem;
  if (out.size() != chunk.unpacked_size) return "chunk: size differs from the stated size";
  if (chunk.unpacked_crc != 0 && crc32(out) != chunk.unpacked_crc) return "chunk: checksum differs";
  return {};
}

}  // namespace isobath::mcap
