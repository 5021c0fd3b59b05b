#include <algorithm>
#include <bzlib.h>
#include <isobath/io/ros/ros1_records.hpp>

namespace isobath::ros1 {
namespace {

/// Decompresses as much as there is, up to `size`.
std::string unpack_bz2(Bytes data, std::uint64_t size, bool cut, mcap::Buffer& out) {
  constexpr std::size_t kStep = std::size_t{1} << 20;
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return "out of memory";
  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(data.data()));  // bzlib does not write to it
  stream.avail_in = static_cast<unsigned>(data.size());
  std::size_t used = 0;
  int state = BZ_OK;
  while (state == BZ_OK && used <= size) {
    out.resize(used + std::min<std::size_t>(kStep, size - used + 1));  // one more than allowed shows a lie
    stream.next_out = reinterpret_cast<char*>(out.data()) + used;
    stream.avail_out = static_cast<unsigned>(out.size() - used);
    const unsigned before = stream.avail_in;
    state = BZ2_bzDecompress(&stream);
    const std::size_t now = out.size() - stream.avail_out;
    if (state == BZ_OK && now == used && stream.avail_in == before) break;  // the data end early
    used = now;
  }
  BZ2_bzDecompressEnd(&stream);
  out.resize(std::min<std::size_t>(used, size));
  if (cut) return {};
  if (state != BZ_OK && state != BZ_STREAM_END) return "damaged bz2 data";
  if (used > size) return "more data than the stated size";
  return state == BZ_STREAM_END ? "" : "bz2 data cut off";
}

}  // namespace

std::optional<BagFields> BagFields::parse(Bytes bytes) {
  BagFields header;
  ByteCursor cursor(bytes);
  while (cursor.left() > 0) {
    const auto length = cursor.little<std::uint32_t>();
    const std::string_view field = text_of(cursor.take(length));
    const std::size_t equals = field.find('=');
    if (!cursor.ok() || equals == std::string_view::npos) return {};
    header.fields_.try_emplace(field.substr(0, equals), field.substr(equals + 1));
  }
  return header;
}

std::string_view BagFields::text(std::string_view name) const {
  const auto found = fields_.find(name);
  return found == fields_.end() ? std::string_view() : found->second;
}

std::optional<Time> BagFields::time(std::string_view name) const {
  const auto both = number<std::uint64_t>(name);
  if (!both) return {};
  return Time{std::chrono::seconds(*both & 0xFFFFFFFF) + std::chrono::nanoseconds(*both >> 32)};
}

std::optional<BagRecord> take_record(ByteCursor& cursor) {
  const auto header_bytes = cursor.little<std::uint32_t>();
  const Bytes head = cursor.take(header_bytes);
  const auto data_bytes = cursor.little<std::uint32_t>();
  const Bytes data = cursor.take(data_bytes);
  if (!cursor.ok()) return {};
  auto header = BagFields::parse(head);
  if (!header) {
    cursor.skip(cursor.left() + 1);
    return {};
  }
  return BagRecord{*std::move(header), data};
}

std::string unpack(std::string_view compression, Bytes data, std::uint64_t size, bool cut, mcap::Buffer& out) {
  if (size > kMaxDataBytes) return "chunk over 256 MiB";
  if (compression == "bz2") {
    const std::string problem = unpack_bz2(data, size, cut, out);
    return problem.empty() && !cut && out.size() != size ? "less data than the stated size" : problem;
  }
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(data.data()), data.size());
  if (compression == "lz4") {
    if (cut) return "lz4 data cut off";
    mcap::ChunkHead chunk;
    chunk.compression = "lz4";
    chunk.unpacked_size = size;
    chunk.records = bytes;
    std::string problem = mcap::unpack(chunk, out);
    return problem.empty() && out.size() != size ? "less data than the stated size" : problem;
  }
  if (compression != "none") return "unknown compression";
  if (!cut && data.size() != size) return "other data than the stated size";
  out.assign(bytes.begin(), bytes.end());
  return {};
}

}  // namespace isobath::ros1
