#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap_file.hpp>
#include <istream>

namespace isobath {

using mcap::Buffer;
using mcap::Cursor;

namespace {

constexpr std::uint64_t kMaxAttachmentsKept = 256u << 20;

}  // namespace

struct McapReader::State {
  State(std::unique_ptr<std::istream> stream, const std::string& name);

  mcap::SeekableInput input;
  SourceReport report;
  std::map<std::uint16_t, McapSchema> schemas;
  std::map<std::uint16_t, McapChannel> channels;
  std::vector<McapMetadata> metadata;
  std::vector<McapAttachment> attachments;
  std::uint64_t attachment_bytes = 0;
  std::optional<std::uint64_t> messages_in_summary;
  std::vector<std::uint64_t> chunk_offsets;  // from a valid summary, rising
  std::uint64_t limit = 0;                   // latest possible end of the data section
  std::uint64_t position = 0;
  bool has_summary = false;
  Buffer scratch;
  std::shared_ptr<Buffer> chunk;  // the chunk that is being read
  Cursor chunk_rest{{}};

  bool load_summary();
  bool parse_summary(std::span<const std::uint8_t> summary);
  void read_head();
  std::optional<McapMessage> next();
  std::optional<McapMessage> next_in_chunk();
  std::optional<McapMessage> next_in_file();
  std::optional<McapMessage> take(std::uint8_t opcode, std::uint64_t size);
  void open_chunk(std::uint64_t size);
  void add_definition(const mcap::Record& record);
  std::optional<McapMessage> known_channel(std::optional<McapMessage> message);
  void resynchronise(const std::string& reason);
  bool load(std::uint64_t offset, std::uint64_t count) { return input.read(offset, count, scratch); }
};

McapReader::State::State(std::unique_ptr<std::istream> stream, const std::string& name) : input(std::move(stream)) {
  report.format = "MCAP";
  report.bytes_total = limit = input.size();
  if (input.size() < 8 || !load(0, 8) || !looks_like_mcap(scratch)) throw Error("not MCAP", {name, 0, {}, {}, {}});
  has_summary = load_summary();
  if (!has_summary) {
    schemas.clear();
    channels.clear();
    chunk_offsets.clear();
    messages_in_summary.reset();
    report.rejected.clear();
    report.details["index"] = "none: the log was cut off, is damaged at its end, or is still being written";
  }
  position = 8;
  read_head();
}

bool McapReader::State::load_summary() {
  const auto summary = mcap::load_summary(input);
  if (!summary || !parse_summary(summary->records)) return false;
  limit = summary->start;
  std::sort(chunk_offsets.begin(), chunk_offsets.end());
  return true;
}

bool McapReader::State::parse_summary(std::span<const std::uint8_t> summary) {
  Cursor rest(summary);
  while (!rest.left().empty()) {
    const auto record = mcap::take_record(rest);
    if (!record) return false;
    Cursor c(record->content);
    if (record->opcode == mcap::kSchema || record->opcode == mcap::kChannel) {
      add_definition(*record);
    } else if (record->opcode == mcap::kStatistics) {
      messages_in_summary = c.number<std::uint64_t>();
    } else if (record->opcode == mcap::kChunkIndex) {
      (void)c.bytes(16);
      chunk_offsets.push_back(c.number<std::uint64_t>());
    } else if (record->opcode < mcap::kChunkIndex) {
      return false;  // a data record
    }
    if (!c.ok()) return false;
  }
  return true;
}

/// Reads the records before the first message, so that metadata is known from the start.
void McapReader::State::read_head() {
  while (position + mcap::kRecordHead <= limit && load(position, mcap::kRecordHead)) {
    Cursor head(scratch);
    const auto opcode = head.number<std::uint8_t>();
    const auto size = head.number<std::uint64_t>();
    const bool wanted = opcode == mcap::kHeader || opcode == mcap::kSchema || opcode == mcap::kChannel ||
                        opcode == mcap::kAttachment || opcode == mcap::kMetadata;
    if (!wanted || size > limit - position - mcap::kRecordHead) return;
    (void)take(opcode, size);
  }
}

std::optional<McapMessage> McapReader::State::next() {
  for (;;) {
    if (chunk) {
      if (auto message = next_in_chunk()) return message;
    } else if (position >= limit) {
      report.bytes_read = report.bytes_total;
      return std::nullopt;
    } else if (auto message = next_in_file()) {
      return message;
    }
  }
}

std::optional<McapMessage> McapReader::State::next_in_chunk() {
  if (chunk_rest.left().empty()) {
    chunk.reset();
    return std::nullopt;
  }
  const auto record = mcap::take_record(chunk_rest);
  if (!record) {
    ++report.rejected["chunk with a broken record inside"];
    chunk.reset();
    return std::nullopt;
  }
  if (record->opcode == mcap::kMessage) {
    auto message = known_channel(mcap::parse_message(record->content));
    if (message) message->storage = chunk;
    return message;
  }
  if (record->opcode == mcap::kSchema || record->opcode == mcap::kChannel) {
    add_definition(*record);
  } else if (record->opcode < 0x80) {
    ++report.rejected["record that is not allowed in a chunk"];
  }
  return std::nullopt;
}

std::optional<McapMessage> McapReader::State::next_in_file() {
  const std::uint64_t left = limit - position;
  if (left < mcap::kRecordHead || !load(position, mcap::kRecordHead)) {
    resynchronise("record cut off");
    return std::nullopt;
  }
  Cursor head(scratch);
  const auto opcode = head.number<std::uint8_t>();
  const auto size = head.number<std::uint64_t>();
  if (size > left - mcap::kRecordHead) {
    resynchronise("record longer than the file");
    return std::nullopt;
  }
  return take(opcode, size);
}

/// Reads the record at `position`, whose length fits into the file, and moves behind it.
std::optional<McapMessage> McapReader::State::take(std::uint8_t opcode, std::uint64_t size) {
  const std::uint64_t content = position + mcap::kRecordHead;
  const std::uint64_t behind = content + size;
  switch (opcode) {
    case mcap::kChunk: open_chunk(size); return std::nullopt;
    case mcap::kDataEnd:
      if (size == 4 && (!has_summary || behind == limit)) {
        position = limit = behind;
      } else {
        resynchronise("end-of-data record before the end of the data");
      }
      report.bytes_read = position;
      return std::nullopt;
    case mcap::kMessageIndex: break;  // not needed: messages are read in the order of the file
    case mcap::kHeader:
    case mcap::kSchema:
    case mcap::kChannel:
    case mcap::kMessage:
    case mcap::kAttachment:
    case mcap::kMetadata: {
      if (size > mcap::kMaxOtherRecord) {
        ++report.rejected["record over 64 MiB"];
        break;
      }
      const auto record = std::make_shared<Buffer>();
      if (!input.read(content, size, *record)) break;
      position = behind;
      report.bytes_read = position;
      if (opcode != mcap::kMessage) {
        add_definition({opcode, *record});
        return std::nullopt;
      }
      auto message = known_channel(mcap::parse_message(*record));
      if (message) message->storage = record;
      return message;
    }
    default:
      if (opcode < 0x80) {
        resynchronise("unknown record type");
        return std::nullopt;
      }
  }
  position = behind;
  report.bytes_read = position;
  return std::nullopt;
}

void McapReader::State::open_chunk(std::uint64_t size) {
  const std::uint64_t content = position + mcap::kRecordHead;
  const std::uint64_t look = std::min<std::uint64_t>(size, mcap::kChunkHeadBytes);
  if (!load(content, look) || !mcap::chunk_can_begin_so(scratch, size))
    return resynchronise("chunk with an impossible head");
  if (!load(content, size)) return resynchronise("chunk cut off");
  const auto head = mcap::parse_chunk(scratch);
  auto unpacked = std::make_shared<Buffer>();
  const std::string problem = head ? mcap::unpack(*head, *unpacked) : "chunk with an impossible head";
  if (!problem.empty()) {
    report.add_damage(position, mcap::kRecordHead + size, problem);
  } else {
    chunk_rest = Cursor(*unpacked);
    chunk = std::move(unpacked);
  }
  position = content + size;
  report.bytes_read = position;
}

void McapReader::State::add_definition(const mcap::Record& record) {
  const auto keep = [&](auto& known, auto&& item, const char* kind) {
    if (!item) {
      ++report.rejected[fmt::format("{} that cannot be read", kind)];
    } else if (const auto [at, is_new] = known.try_emplace(item->id, *item); !is_new && !(at->second == *item)) {
      ++report.rejected[fmt::format("{} defined twice with different content", kind)];
    }
  };
  if (record.opcode == mcap::kSchema) {
    keep(schemas, mcap::parse_schema(record.content), "schema");
  } else if (record.opcode == mcap::kChannel) {
    keep(channels, mcap::parse_channel(record.content), "channel");
  } else if (record.opcode == mcap::kHeader) {
    Cursor c(record.content);
    (void)c.text();
    report.details["written by"] = c.text();
  } else if (record.opcode == mcap::kMetadata) {
    if (auto item = mcap::parse_metadata(record.content)) {
      metadata.push_back(*std::move(item));
    } else {
      ++report.rejected["metadata that cannot be read"];
    }
  } else if (record.opcode == mcap::kAttachment) {
    attachment_bytes += record.content.size();
    auto item = mcap::parse_attachment(record.content);
    if (item && attachment_bytes <= kMaxAttachmentsKept) {
      attachments.push_back(*std::move(item));
    } else {
      ++report.rejected["attachment that is damaged or too large"];
    }
  }
}

std::optional<McapMessage> McapReader::State::known_channel(std::optional<McapMessage> message) {
  if (!message) {
    ++report.rejected["message that cannot be read"];
  } else if (!channels.contains(message->channel_id)) {
    ++report.rejected["message on an unknown channel"];
    message.reset();
  }
  return message;
}

/// Skips from an invalid record to the next chunk.
void McapReader::State::resynchronise(const std::string& reason) {
  std::uint64_t to = limit;
  if (has_summary && !chunk_offsets.empty()) {
    const auto at = std::upper_bound(chunk_offsets.begin(), chunk_offsets.end(), position);
    if (at != chunk_offsets.end()) to = std::min(*at, limit);
  } else {
    to = mcap::find_chunk(input, position + 1, limit);
  }
  report.add_damage(position, to - position, reason);
  position = to;
  report.bytes_read = position;
}

bool looks_like_mcap(std::span<const std::uint8_t> head) {
  return head.size() >= 8 && std::equal(std::begin(mcap::kMagic), std::end(mcap::kMagic), head.begin());
}

McapReader::McapReader(std::unique_ptr<std::istream> input, const std::string& name)
    : state_(std::make_unique<State>(std::move(input), name)) {}
McapReader::~McapReader() = default;

std::optional<McapMessage> McapReader::next() { return state_->next(); }

const McapSchema* McapReader::schema(std::uint16_t id) const {
  const auto at = state_->schemas.find(id);
  return at == state_->schemas.end() ? nullptr : &at->second;
}
const McapChannel* McapReader::channel(std::uint16_t id) const {
  const auto at = state_->channels.find(id);
  return at == state_->channels.end() ? nullptr : &at->second;
}
const std::map<std::uint16_t, McapChannel>& McapReader::channels() const { return state_->channels; }
const std::vector<McapMetadata>& McapReader::metadata() const { return state_->metadata; }
const std::vector<McapAttachment>& McapReader::attachments() const { return state_->attachments; }
std::optional<std::uint64_t> McapReader::messages_in_summary() const { return state_->messages_in_summary; }
const SourceReport& McapReader::report() const { return state_->report; }
SourceReport& McapReader::report() { return state_->report; }

}  // namespace isobath
