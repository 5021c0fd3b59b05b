#include <algorithm>
#include <fcntl.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap_records.hpp>
#include <unistd.h>

namespace isobath {

using mcap::Buffer;
using mcap::Writer;

std::vector<Field> fields(McapWriterConfig& c) {
  return {
      Field::choice(
          "compression", &c.compression,
          {{"none", McapCompression::kNone}, {"lz4", McapCompression::kLz4}, {"zstd", McapCompression::kZstd}},
          "Compression of the chunks of a log."),
      Field::integer("chunk_kib", &c.chunk_kib, {1, 65536}, "KiB", "Size at which a chunk is compressed and written."),
      Field::real("chunk_s", &c.chunk_s, {0, 3600}, "s",
                  "Maximum time span of one chunk, and so of what a crash can lose; 0: no limit."),
      Field::flag("sync", &c.sync,
                  "Forces each chunk onto the disk, so that a power failure loses no more than a crash.")};
}

struct McapWriter::State {
  struct ChunkEntry {
    std::uint64_t start, end, offset, length, index_length, packed, unpacked;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };
  struct Messages {
    std::uint64_t count = 0;
    std::uint64_t first = ~std::uint64_t{0};
    std::uint64_t last = 0;
    void add(std::uint64_t time) {
      ++count;
      first = std::min(first, time);
      last = std::max(last, time);
    }
  };

  std::string file;
  McapWriterConfig config;
  std::ofstream out;
  std::uint64_t position = 0;
  std::uint32_t crc = 0;
  bool closed = false;
  std::vector<McapSchema> schemas;
  std::vector<McapChannel> channels;
  std::map<std::uint16_t, std::uint64_t> counts;
  Messages all;
  struct OpenChunk {
    Messages in;
    Buffer records;
    std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index;  // log time, offset
  };
  std::map<int, OpenChunk> open;  // by group
  std::vector<int> groups;        // group of each channel
  std::vector<ChunkEntry> chunks;
  Buffer attachment_indexes, metadata_indexes;
  std::uint32_t attachments = 0, metadata = 0;

  void put(std::span<const std::uint8_t> bytes) {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    check();
    crc = mcap::crc32(bytes, crc);
    position += bytes.size();
  }
  void check() const {
    if (!out) throw Error("cannot be written", {file, position, {}, {}, {}}, "", "check its folder and the free space");
  }
  template <class Fill>
  void put_record(mcap::Opcode opcode, Fill fill) {
    Buffer buffer;
    Writer w(buffer);
    w.record(opcode, [&] { fill(w); });
    put(buffer);
  }
  void flush_chunk(OpenChunk& chunk);
  void flush_chunks();
  /// Passes the buffered bytes to the operating system and, with `sync`, waits until they are on the disk.
  void make_safe();
  void flush_older_than(std::uint64_t time);
  void write_chunk_indexes(const OpenChunk& chunk, ChunkEntry& entry);
  void write_summary();
};

namespace {

void put_schema(Writer& w, const McapSchema& s) {
  w.record(mcap::kSchema, [&] { w.number(s.id).text(s.name).text(s.encoding).text(s.data); });
}
void put_channel(Writer& w, const McapChannel& c) {
  w.record(mcap::kChannel,
           [&] { w.number(c.id).number(c.schema_id).text(c.topic).text(c.message_encoding).map(c.metadata); });
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& file, const McapWriterConfig& config, const std::string& profile)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.file = file.string();
  s.config = config;
  s.out.open(file, std::ios::binary | std::ios::trunc);
  s.put(mcap::kMagic);
  s.put_record(mcap::kHeader, [&](Writer& w) { w.text(profile).text("isobath"); });
}

McapWriter::~McapWriter() {
  try {
    close();
  } catch (const Error&) {  // call close() to see errors
  }
}

std::uint16_t McapWriter::add_schema(McapSchema schema) {
  State& s = *state_;
  ISOBATH_ASSERT(!s.closed && s.schemas.size() < 0xffff);
  schema.id = static_cast<std::uint16_t>(s.schemas.size() + 1);
  Buffer buffer;
  Writer w(buffer);
  put_schema(w, schema);
  s.put(buffer);
  s.schemas.push_back(std::move(schema));
  return s.schemas.back().id;
}

std::uint16_t McapWriter::add_channel(McapChannel channel, int group) {
  State& s = *state_;
  ISOBATH_ASSERT(!s.closed && s.channels.size() < 0xffff && channel.schema_id <= s.schemas.size());
  channel.id = static_cast<std::uint16_t>(s.channels.size() + 1);
  Buffer buffer;
  Writer w(buffer);
  put_channel(w, channel);
  s.put(buffer);
  s.channels.push_back(std::move(channel));
  s.groups.push_back(group);
  return s.channels.back().id;
}

void McapWriter::write(const McapMessage& m) {
  State& s = *state_;
  ISOBATH_ASSERT(!s.closed && m.channel_id >= 1 && m.channel_id <= s.channels.size());
  s.flush_older_than(m.log_time);
  State::OpenChunk& chunk = s.open[s.groups[m.channel_id - 1u]];
  chunk.index[m.channel_id].emplace_back(m.log_time, chunk.records.size());
  Writer w(chunk.records);
  w.record(mcap::kMessage,
           [&] { w.number(m.channel_id).number(m.sequence).number(m.log_time).number(m.publish_time).bytes(m.data); });
  chunk.in.add(m.log_time);
  s.all.add(m.log_time);
  ++s.counts[m.channel_id];
  if (chunk.records.size() < static_cast<std::size_t>(s.config.chunk_kib) << 10) return;
  s.flush_chunk(chunk);
  s.make_safe();
}

void McapWriter::add_metadata(const McapMetadata& metadata) {
  State& s = *state_;
  ISOBATH_ASSERT(!s.closed);
  const std::uint64_t offset = s.position;
  s.put_record(mcap::kMetadata, [&](Writer& w) { w.text(metadata.name).map(metadata.values); });
  ++s.metadata;
  Writer w(s.metadata_indexes);
  w.record(mcap::kMetadataIndex, [&] { w.number(offset).number(s.position - offset).text(metadata.name); });
}

void McapWriter::add_attachment(const McapAttachment& a) {
  State& s = *state_;
  ISOBATH_ASSERT(!s.closed);
  const std::uint64_t offset = s.position;
  const auto data = std::span(reinterpret_cast<const std::uint8_t*>(a.data.data()), a.data.size());
  Buffer content;
  Writer(content).number(a.log_time).number(a.create_time).text(a.name).text(a.media_type);
  Writer(content).number(std::uint64_t{data.size()}).bytes(data);
  s.put_record(mcap::kAttachment, [&](Writer& w) { w.bytes(content).number(mcap::crc32(content)); });
  ++s.attachments;
  Writer w(s.attachment_indexes);
  w.record(mcap::kAttachmentIndex, [&] {
    w.number(offset).number(s.position - offset).number(a.log_time).number(a.create_time);
    w.number(std::uint64_t{data.size()}).text(a.name).text(a.media_type);
  });
}

void McapWriter::flush() {
  state_->flush_chunks();
  state_->make_safe();
}

void McapWriter::State::flush_chunks() {
  for (auto& [group, chunk] : open) flush_chunk(chunk);
}

/// Writes the chunks whose span, with a message of this time, would exceed chunk_s.
void McapWriter::State::flush_older_than(std::uint64_t time) {
  if (!(config.chunk_s > 0)) return;
  const auto longest = static_cast<std::uint64_t>(config.chunk_s * 1e9);
  bool written = false;
  for (auto& [group, chunk] : open) {
    if (chunk.in.count == 0) continue;
    const std::uint64_t first = std::min(chunk.in.first, time), last = std::max(chunk.in.last, time);
    if (last - first <= longest) continue;
    flush_chunk(chunk);
    written = true;
  }
  if (written) make_safe();
}

void McapWriter::State::make_safe() {
  out.flush();
  check();
  if (!config.sync) return;
  const int handle = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);  // fdatasync works on any handle of the file
  const bool synced = handle >= 0 && ::fdatasync(handle) == 0;
  if (handle >= 0) ::close(handle);
  if (!synced) out.setstate(std::ios::badbit);
  check();
}

void McapWriter::State::flush_chunk(OpenChunk& chunk) {
  if (chunk.in.count == 0) return;
  const Buffer packed = mcap::pack(chunk.records, config.compression);
  ChunkEntry entry{chunk.in.first, chunk.in.last, position, 0, 0, packed.size(), chunk.records.size(), {}};
  put_record(mcap::kChunk, [&](Writer& w) {
    w.number(entry.start).number(entry.end).number(entry.unpacked).number(mcap::crc32(chunk.records));
    w.text(mcap::name_of(config.compression)).number(entry.packed).bytes(packed);
  });
  entry.length = position - entry.offset;
  write_chunk_indexes(chunk, entry);
  chunks.push_back(std::move(entry));
  chunk.records.clear();
  chunk.index.clear();
  chunk.in = {};
}

void McapWriter::State::write_chunk_indexes(const OpenChunk& chunk, ChunkEntry& entry) {
  const std::uint64_t start = position;
  for (const auto& [channel, messages] : chunk.index) {
    entry.index_offsets[channel] = position;
    put_record(mcap::kMessageIndex, [&, id = channel, &list = messages](Writer& w) {
      w.number(id).counted([&] {
        for (const auto& [time, offset] : list) w.number(time).number(offset);
      });
    });
  }
  entry.index_length = position - start;
}

void McapWriter::State::write_summary() {
  const std::uint64_t start = position;
  Buffer summary, offsets;
  Writer w(summary), o(offsets);
  const auto group = [&](mcap::Opcode opcode, auto fill) {
    const std::uint64_t before = summary.size();
    fill();
    const std::uint64_t length = summary.size() - before;
    if (length == 0) return;
    o.record(mcap::kSummaryOffset,
             [&] { o.number(static_cast<std::uint8_t>(opcode)).number(start + before).number(length); });
  };
  group(mcap::kSchema,
        [&] { std::for_each(schemas.begin(), schemas.end(), [&](const auto& s) { put_schema(w, s); }); });
  group(mcap::kChannel,
        [&] { std::for_each(channels.begin(), channels.end(), [&](const auto& c) { put_channel(w, c); }); });
  group(mcap::kStatistics, [&] {
    w.record(mcap::kStatistics, [&] {
      w.number(all.count).number(static_cast<std::uint16_t>(schemas.size()));
      w.number(static_cast<std::uint32_t>(channels.size())).number(attachments).number(metadata);
      w.number(static_cast<std::uint32_t>(chunks.size())).number(all.count ? all.first : 0).number(all.last);
      w.counted([&] {
        for (const auto& [channel, count] : counts) w.number(channel).number(count);
      });
    });
  });
  group(mcap::kChunkIndex, [&] {
    for (const ChunkEntry& c : chunks) {
      w.record(mcap::kChunkIndex, [&] {
        w.number(c.start).number(c.end).number(c.offset).number(c.length).counted([&] {
          for (const auto& [channel, offset] : c.index_offsets) w.number(channel).number(offset);
        });
        w.number(c.index_length).text(mcap::name_of(config.compression)).number(c.packed).number(c.unpacked);
      });
    }
  });
  group(mcap::kAttachmentIndex, [&] { w.bytes(attachment_indexes); });
  group(mcap::kMetadataIndex, [&] { w.bytes(metadata_indexes); });

  const std::uint64_t offsets_start = start + summary.size();
  w.bytes(offsets);
  w.number(static_cast<std::uint8_t>(mcap::kFooter)).number(std::uint64_t{20}).number(start).number(offsets_start);
  w.number(mcap::crc32(summary));
  put(summary);
}

void McapWriter::close() {
  State& s = *state_;
  if (s.closed) return;
  s.closed = true;
  s.flush_chunks();
  s.put_record(mcap::kDataEnd, [crc = s.crc](Writer& w) { w.number(crc); });
  s.write_summary();
  s.put(mcap::kMagic);
  s.make_safe();
  s.out.close();
  s.check();
}

}  // namespace isobath
