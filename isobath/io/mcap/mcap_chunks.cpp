#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap_chunks.hpp>
#include <utility>

namespace isobath::mcap {

bool IndexedChunk::may_hold(std::uint16_t channel) const {
  return !knows_channels ||
         std::any_of(indexes.begin(), indexes.end(), [&](const auto& index) { return index.first == channel; });
}

McapMessage message_at(const Unpacked& chunk, const PlacedMessage& at) {
  auto message = parse_message(std::span<const std::uint8_t>(chunk->bytes).subspan(at.offset, at.size));
  message->storage = chunk;
  return *std::move(message);
}

ChunkTable::ChunkTable(std::unique_ptr<std::istream> stream, const std::string& name, std::uint64_t cache_bytes)
    : input_(std::move(stream)), cache_bytes_(cache_bytes) {
  report.format = "MCAP";
  if (input_.size() < 8 || !input_.read(0, 8, scratch_) || !looks_like_mcap(scratch_)) {
    throw Error("not MCAP", {name, 0, {}, {}, {}});
  }
  const auto summary = load_summary(input_);
  if (summary && take_summary(*summary)) {
    complete_ = true;
  } else {
    schemas.clear();
    channels.clear();
    chunks_.clear();
    walk();
  }
  report.bytes_total = report.bytes_read = input_.size();
}

// What is known without unpacking ------------------------------------------------------------------------------------

bool ChunkTable::take_summary(const SummaryBytes& summary) {
  Cursor rest(summary.records);
  while (!rest.left().empty()) {
    const auto record = take_record(rest);
    if (!record) return false;
    if (record->opcode == kSchema || record->opcode == kChannel) {
      add_definition(record->opcode, record->content);
    } else if (record->opcode == kChunkIndex && !take_chunk_index(record->content, summary.start)) {
      return false;
    }
  }
  std::sort(chunks_.begin(), chunks_.end(),
            [](const IndexedChunk& a, const IndexedChunk& b) { return a.offset < b.offset; });
  return !chunks_.empty();  // a summary may omit them
}

bool ChunkTable::take_chunk_index(std::span<const std::uint8_t> content, std::uint64_t limit) {
  Cursor c(content);
  IndexedChunk chunk;
  chunk.start = c.number<std::uint64_t>();
  chunk.end = c.number<std::uint64_t>();
  chunk.offset = c.number<std::uint64_t>();
  chunk.length = c.number<std::uint64_t>();
  Cursor offsets(c.bytes(c.number<std::uint32_t>()));
  while (offsets.ok() && !offsets.left().empty()) {
    const auto channel = offsets.number<std::uint16_t>();
    chunk.indexes.emplace_back(channel, offsets.number<std::uint64_t>());
  }
  chunk.knows_channels = !chunk.indexes.empty();
  if (!c.ok() || !offsets.ok() || chunk.start > chunk.end || chunk.offset < 8 || chunk.offset > limit) return false;
  if (chunk.length < kRecordHead || chunk.length > limit - chunk.offset) return false;
  chunks_.push_back(std::move(chunk));
  return true;
}

void ChunkTable::add_definition(std::uint8_t opcode, std::span<const std::uint8_t> content) {
  const auto keep = [&](auto& known, auto&& item) {
    if (!item) return false;
    const auto [at, is_new] = known.try_emplace(item->id, *item);
    return is_new || at->second == *item;
  };
  const bool good = opcode == kSchema ? keep(schemas, parse_schema(content)) : keep(channels, parse_channel(content));
  if (!good) ++report.rejected["schema or channel that cannot be read, or is defined twice"];
}

void ChunkTable::walk() {
  while (!complete_ && input_.size() - position_ >= kRecordHead) {
    if (!input_.read(position_, kRecordHead, scratch_)) return;
    Cursor head(scratch_);
    const auto opcode = head.number<std::uint8_t>();
    const auto size = head.number<std::uint64_t>();
    if (size > input_.size() - position_ - kRecordHead) {
      if (!resynchronise("record longer than the file")) return;  // the rest is still to be written, or was lost
    } else if (walk_record(opcode, size)) {
      position_ += kRecordHead + size;
    } else if (!resynchronise("unknown record type")) {
      return;
    }
  }
}

/// Reads the record at `position_`, which lies completely in the file. False: not a valid record.
bool ChunkTable::walk_record(std::uint8_t opcode, std::uint64_t size) {
  if (opcode == 0 || (opcode > kDataEnd && opcode < 0x80)) return false;
  if (opcode == kChunk) return walk_chunk(size);
  if (opcode == kMessageIndex) {
    if (size < 6 || !input_.read(position_ + kRecordHead, 2, scratch_)) return false;
    if (tail_open_) chunks_.back().indexes.emplace_back(Cursor(scratch_).number<std::uint16_t>(), position_);
    return true;
  }
  const std::uint64_t content = position_ + kRecordHead;
  close_tail();
  if (opcode == kSchema || opcode == kChannel) {
    if (size > kMaxOtherRecord || !input_.read(content, size, scratch_)) return false;
    add_definition(opcode, scratch_);
  }
  if (opcode == kMessage) ++report.rejected["message outside of chunks"];
  if (opcode == kDataEnd) complete_ = size == 4;
  return opcode != kDataEnd || size == 4;
}

bool ChunkTable::walk_chunk(std::uint64_t size) {
  const std::uint64_t look = std::min<std::uint64_t>(size, kChunkHeadBytes);
  if (!input_.read(position_ + kRecordHead, look, scratch_)) return false;
  if (!chunk_can_begin_so(scratch_, size)) return false;
  close_tail();
  IndexedChunk chunk;
  Cursor head(scratch_);
  chunk.start = head.number<std::uint64_t>();
  chunk.end = head.number<std::uint64_t>();
  chunk.offset = position_;
  chunk.length = kRecordHead + size;
  chunks_.push_back(std::move(chunk));
  tail_open_ = true;
  return true;
}

/// Called when all message indexes of the last chunk are read. A chunk without any is unpacked to find its channels.
void ChunkTable::close_tail() {
  if (!std::exchange(tail_open_, false)) return;
  const std::size_t last = chunks_.size() - 1;
  chunks_[last].knows_channels = !chunks_[last].indexes.empty();
  const auto is_unknown = [&](const auto& index) { return !channels.contains(index.first); };
  const auto& indexes = chunks_[last].indexes;
  const bool defines = std::any_of(indexes.begin(), indexes.end(), is_unknown);  // a channel may be defined in a chunk
  if (defines || indexes.empty()) (void)unpacked(last);
}

/// Skips from an invalid record to the next chunk; false if there is none yet.
bool ChunkTable::resynchronise(const char* reason) {
  const std::uint64_t to = find_chunk(input_, position_ + 1, input_.size());
  if (to >= input_.size()) return false;
  report.add_damage(position_, to - position_, reason);
  position_ = to;
  return true;
}

// Unpacking ----------------------------------------------------------------------------------------------------------

Unpacked ChunkTable::unpacked(std::size_t chunk) {
  const auto known = std::find_if(cache_.begin(), cache_.end(), [&](const Unpacked& u) { return u->chunk == chunk; });
  if (known != cache_.end()) {
    cache_.splice(cache_.begin(), cache_, known);
    return cache_.front();
  }
  if (chunks_[chunk].damaged) return nullptr;
  auto fresh = std::make_shared<UnpackedChunk>();
  fresh->chunk = chunk;
  const std::string problem = unpack(chunks_[chunk], *fresh);
  ++counts.unpacked;
  if (!problem.empty()) {
    chunks_[chunk].damaged = true;
    report.add_damage(chunks_[chunk].offset, chunks_[chunk].length, problem);
    return nullptr;
  }
  counts.unpacked_bytes += fresh->bytes.size();
  list_messages(*fresh);
  cache_.push_front(std::move(fresh));
  std::uint64_t bytes = 0;
  for (auto at = cache_.begin(); at != cache_.end();) {
    bytes += (*at)->size();
    at = bytes > cache_bytes_ && at != cache_.begin() ? cache_.erase(at) : std::next(at);
  }
  return cache_.front();
}

std::string ChunkTable::unpack(const IndexedChunk& at, UnpackedChunk& out) {
  if (at.length > kRecordHead + kMaxMcapChunkBytes) return "chunk larger than 512 MiB";
  Buffer record;
  if (!input_.read(at.offset, at.length, record)) return "chunk cut off";
  Cursor cursor(record);
  const auto whole = take_record(cursor);
  if (!whole || whole->opcode != kChunk || !cursor.left().empty()) return "no chunk where the index says";
  const auto head = parse_chunk(whole->content);
  return head ? mcap::unpack(*head, out.bytes) : "chunk with an impossible head";
}

void ChunkTable::list_messages(UnpackedChunk& chunk) {
  Cursor rest(chunk.bytes);
  while (!rest.left().empty()) {
    const auto record = take_record(rest);
    if (!record) {
      ++report.rejected["chunk with a broken record inside"];
      return;
    }
    if (record->opcode == kSchema || record->opcode == kChannel) {
      add_definition(record->opcode, record->content);
    } else if (record->opcode == kMessage) {
      const auto message = parse_message(record->content);
      if (!message || !channels.contains(message->channel_id)) {
        ++report.rejected["message that cannot be read, or on an unknown channel"];
        continue;
      }
      const auto offset = static_cast<std::uint64_t>(record->content.data() - chunk.bytes.data());
      chunk.messages.push_back({message->log_time, offset, record->content.size(), message->channel_id});
    }
  }
}

/// The times in the chunk's message index; empty if there is no readable index.
std::optional<std::vector<std::uint64_t>> ChunkTable::indexed_times(const IndexedChunk& chunk, std::uint16_t channel) {
  std::vector<std::uint64_t> times;
  for (const auto& [id, offset] : chunk.indexes) {
    if (id != channel) continue;
    if (offset > input_.size() || input_.size() - offset < kRecordHead) return std::nullopt;
    if (!input_.read(offset, kRecordHead, scratch_)) return std::nullopt;
    Cursor head(scratch_);
    const auto opcode = head.number<std::uint8_t>();
    const auto size = head.number<std::uint64_t>();
    if (opcode != kMessageIndex || size > kMaxOtherRecord) return std::nullopt;
    if (size > input_.size() - offset - kRecordHead) return std::nullopt;
    if (!input_.read(offset + kRecordHead, size, scratch_)) return std::nullopt;
    Cursor content(scratch_);
    if (content.number<std::uint16_t>() != channel) return std::nullopt;
    Cursor entries(content.bytes(content.number<std::uint32_t>()));
    if (!content.ok() || entries.left().size() % 16 != 0) return std::nullopt;
    while (!entries.left().empty()) {
      times.push_back(entries.number<std::uint64_t>());
      (void)entries.number<std::uint64_t>();
    }
    break;  // one index per channel: accepting more would let a small file cost much work
  }
  std::sort(times.begin(), times.end());
  return times;
}

std::vector<std::uint64_t> ChunkTable::times(std::size_t chunk, std::uint16_t channel) {
  if (chunks_[chunk].knows_channels) {
    if (auto indexed = indexed_times(chunks_[chunk], channel)) return *std::move(indexed);
  }
  std::vector<std::uint64_t> times;
  if (const Unpacked content = unpacked(chunk)) {
    for (const PlacedMessage& m : content->messages) {
      if (m.channel == channel) times.push_back(m.time);
    }
  }
  std::sort(times.begin(), times.end());
  return times;
}

bool ChunkTable::refresh() {
  if (complete_) return false;
  const std::uint64_t before = position_;
  input_.measure();
  if (input_.size() < position_) return false;  // the file has shrunk: its lost chunks will be reported as damaged
  walk();
  report.bytes_total = report.bytes_read = input_.size();
  return position_ != before;
}

}  // namespace isobath::mcap
