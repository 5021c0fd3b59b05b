#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap_file.hpp>
#include <isobath/io/ros/ros1_bag.hpp>
#include <isobath/io/ros/ros1_records.hpp>
#include <map>
#include <sstream>

namespace isobath {
namespace {

constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
constexpr std::size_t kMaxConnections = 1 << 16;

Bytes view_of(const mcap::Buffer& buffer) { return std::as_bytes(std::span(buffer)); }

class Ros1Bag final : public RosRecording {
 public:
  Ros1Bag(std::unique_ptr<std::istream> input, const std::string& name) : input_(std::move(input)), name_(name) {
    report_.format = "ROS 1 bag";
    report_.bytes_total = limit_ = input_.size();
    read_bag_header();
    const std::uint64_t first = position_;
    if (!read_index()) {
      report_.details["index"] = "none: the bag was cut off, is damaged at its end, or was not closed";
      topics_.clear();
      connections_.clear();
      while (const auto message = read()) ++topics_[message->topic].messages;
      report_.damages.clear();
      report_.rejected.clear();
      report_.bytes_skipped = 0;
    }
    position_ = first;
    report_.bytes_read = first;
    chunk_.reset();
    chunk_at_ = 0;
  }

  [[nodiscard]] const std::vector<RosTopic>& topics() const override { return topics_; }
  std::optional<RosRecord> next() override { return read(); }
  [[nodiscard]] SourceReport& report() override { return report_; }

 private:
  void read_bag_header();
  bool read_index();
  std::optional<RosRecord> read();
  std::optional<RosRecord> take(const ros1::BagRecord& record, const std::shared_ptr<const void>& owner);
  void open_next();
  void open_chunk(const ros1::BagFields& header, std::uint64_t data_at, std::uint64_t data_bytes);
  void add_connection(const ros1::BagRecord& record);
  void resynchronise(const char* reason);
  [[nodiscard]] std::uint64_t next_chunk(std::uint64_t from);

  mcap::SeekableInput input_;
  std::string name_;
  SourceReport report_;
  std::vector<RosTopic> topics_;
  std::map<std::uint32_t, std::size_t> connections_;  ///< number in the bag: topic
  std::uint64_t position_ = 0, limit_ = 0;            ///< `limit_`: end of the chunks
  std::uint64_t index_at_ = 0;
  mcap::Buffer scratch_;
  std::shared_ptr<mcap::Buffer> chunk_;  ///< the unpacked chunk that is being read
  std::size_t chunk_at_ = 0;
};

void Ros1Bag::read_bag_header() {
  const auto refuse = [&](const char* problem, const char* advice = "") { throw Error(problem, {name_}, {}, advice); };
  const std::size_t want = std::min<std::uint64_t>(input_.size(), 64 << 10);
  if (!input_.read(0, want, scratch_)) refuse("cannot be read");
  const std::string_view head = text_of(view_of(scratch_));
  if (head.starts_with("#ROSBAG V1.")) refuse("is a ROS bag of format 1", "convert it with rosbag fix");
  if (!head.starts_with(kBagMagic)) refuse("is not a ROS bag of format 2.0");
  ByteCursor cursor(view_of(scratch_), kBagMagic.size());
  const auto record = ros1::take_record(cursor);
  if (!record || record->header.op() != ros1::kBagHeader) refuse("ends within its header or has an impossible one");
  if (!record->header.text("encryptor").empty()) refuse("is an encrypted ROS bag", "decrypt it with rosbag decrypt");
  index_at_ = record->header.number<std::uint64_t>("index_pos").value_or(0);
  position_ = cursor.position();
}

/// Reads the connections and the counts of messages at the end of the file; false if any of it is not as it must be.
bool Ros1Bag::read_index() {
  const std::uint64_t size = input_.size();
  if (index_at_ < position_ || index_at_ >= size || size - index_at_ > ros1::kMaxDataBytes) return false;
  mcap::Buffer index;
  if (!input_.read(index_at_, size - index_at_, index)) return false;
  ByteCursor cursor(view_of(index));
  while (cursor.left() > 0) {
    const auto record = ros1::take_record(cursor);
    if (!record) return false;
    if (record->header.op() == ros1::kConnection) {
      add_connection(*record);
    } else if (record->header.op() == ros1::kChunkInfo) {
      for (ByteCursor counts(record->data); counts.left() >= 8;) {
        const auto known = connections_.find(counts.little<std::uint32_t>());
        const auto count = counts.little<std::uint32_t>();
        if (known != connections_.end()) topics_[known->second].messages += count;
      }
    } else {
      return false;
    }
  }
  if (!report_.rejected.empty()) return report_.rejected.clear(), false;
  limit_ = index_at_;
  return true;
}

std::optional<RosRecord> Ros1Bag::read() {
  for (;;) {
    if (chunk_ && chunk_at_ < chunk_->size()) {
      ByteCursor cursor(view_of(*chunk_), chunk_at_);
      const auto record = ros1::take_record(cursor);
      chunk_at_ = record ? cursor.position() : chunk_->size();
      if (!record) {
        ++report_.rejected["chunk with a broken record inside"];
      } else if (auto message = take(*record, chunk_)) {
        return message;
      }
    } else if (position_ >= limit_) {
      report_.bytes_read = report_.bytes_total;
      return {};
    } else {
      open_next();
    }
  }
}

/// Uses a record within a chunk.
std::optional<RosRecord> Ros1Bag::take(const ros1::BagRecord& record, const std::shared_ptr<const void>& owner) {
  if (record.header.op() == ros1::kConnection) {
    add_connection(record);
    return {};
  }
  if (record.header.op() != ros1::kMessage) {
    ++report_.rejected["record that is not allowed in a chunk"];
    return {};
  }
  const auto connection = record.header.number<std::uint32_t>("conn");
  const auto time = record.header.time("time");
  const auto known = connection ? connections_.find(*connection) : connections_.end();
  if (!time || known == connections_.end()) {
    ++report_.rejected[time ? "message of an unknown connection" : "message without a time"];
    return {};
  }
  return RosRecord{known->second, *time, record.data, owner};
}

/// Reads the record at the position, outside of chunks.
void Ros1Bag::open_next() {
  const std::uint64_t left = limit_ - position_;
  if (left < 8 || !input_.read(position_, 4, scratch_)) return resynchronise("record cut off");
  const std::uint64_t head = ByteCursor(view_of(scratch_)).little<std::uint32_t>();
  if (head > ros1::kMaxHeaderBytes || head + 8 > left) return resynchronise("record with an impossible header");
  mcap::Buffer bytes;
  if (!input_.read(position_ + 4, head + 4, bytes)) return resynchronise("record cut off");
  const auto header = ros1::BagFields::parse(view_of(bytes).first(head));
  if (!header) return resynchronise("record with an impossible header");
  const std::uint64_t size = ByteCursor(view_of(bytes), head).little<std::uint32_t>();
  const std::uint64_t data_at = position_ + 8 + head;
  if (header->op() == ros1::kChunk) return open_chunk(*header, data_at, size);
  if (size > limit_ - data_at) return resynchronise("record longer than the file");
  if (header->op() == ros1::kConnection && size <= ros1::kMaxDataBytes) {
    mcap::Buffer data;
    if (input_.read(data_at, size, data)) add_connection({*header, view_of(data)});
  } else if (header->op() != ros1::kIndex && header->op() != ros1::kChunkInfo) {
    return resynchronise("record of a kind that does not stand outside of chunks");
  }
  position_ = data_at + size;
  report_.bytes_read = position_;
}

void Ros1Bag::open_chunk(const ros1::BagFields& header, std::uint64_t data_at, std::uint64_t data_bytes) {
  const std::uint64_t here = std::min(data_bytes, limit_ - data_at), end = data_at + here;
  const bool cut = here < data_bytes;
  if (cut && next_chunk(position_ + 1) < limit_) return resynchronise("chunk longer than the file");
  mcap::Buffer data;
  const auto size = header.number<std::uint32_t>("size");
  std::string problem = !size                               ? "chunk without a size"
                        : data_bytes > ros1::kMaxDataBytes  ? "chunk over 256 MiB"
                        : !input_.read(data_at, here, data) ? "chunk cut off"
                                                            : "";
  auto unpacked = std::make_shared<mcap::Buffer>();
  if (problem.empty()) problem = ros1::unpack(header.text("compression"), view_of(data), *size, cut, *unpacked);
  if (problem.empty()) {
    chunk_ = std::move(unpacked);
    chunk_at_ = 0;
    if (cut) report_.details["cut off"] = "the file ends within a chunk, which is read up to there";
  } else {
    report_.add_damage(position_, end - position_, problem);
  }
  position_ = end;
  report_.bytes_read = position_;
}

void Ros1Bag::add_connection(const ros1::BagRecord& record) {
  const auto number = record.header.number<std::uint32_t>("conn");
  const auto inner = ros1::BagFields::parse(record.data);
  const std::string topic(record.header.text("topic"));
  if (!number || !inner || topic.empty() || inner->text("type").empty()) {
    ++report_.rejected["connection that cannot be read"];
    return;
  }
  const std::string type = ros_type_name(inner->text("type"));
  const auto known = connections_.find(*number);
  if (known != connections_.end()) {
    const RosTopic& before = topics_[known->second];
    if (before.name == topic && before.type == type) return;
    ++report_.rejected["connection defined twice with different content"];
    return;
  }
  if (connections_.size() >= kMaxConnections) return;
  const auto same = std::ranges::find_if(topics_, [&](const RosTopic& t) { return t.name == topic && t.type == type; });
  connections_[*number] = static_cast<std::size_t>(same - topics_.begin());
  if (same != topics_.end()) return;  // another publisher
  topics_.push_back(
      {topic, type, RosEncoding::kRos1, RosDefinition::parse(type, inner->text("message_definition")), 0});
}

/// Skips from damage to the next chunk.
void Ros1Bag::resynchronise(const char* reason) {
  const std::uint64_t to = next_chunk(position_ + 1);
  report_.add_damage(position_, to - position_, reason);
  position_ = to;
  report_.bytes_read = position_;
}

/// The first position from `from` on at which a record of a chunk begins, else the end of the chunks.
std::uint64_t Ros1Bag::next_chunk(std::uint64_t from) {
  constexpr std::uint64_t kStep = 1 << 20, kHead = 256;
  constexpr std::string_view kMark("\x04\x00\x00\x00op=\x05", 8);
  mcap::Buffer bytes;
  for (; from < limit_; from += kStep) {
    const std::uint64_t count = std::min(limit_ - from, kStep + kHead);
    if (!input_.read(from, count, bytes)) return limit_;
    const std::string_view text = text_of(view_of(bytes));
    for (std::size_t mark = text.find(kMark); mark != std::string_view::npos; mark = text.find(kMark, mark + 1)) {
      for (std::size_t at = mark - std::min<std::size_t>(mark, kHead); at + 4 <= mark; ++at) {
        ByteCursor cursor(view_of(bytes), at);
        const auto size = cursor.little<std::uint32_t>();
        if (size > kHead || at + 4 + size < mark + kMark.size()) continue;
        const auto header = ros1::BagFields::parse(cursor.take(size));
        if (cursor.ok() && header && header->op() == ros1::kChunk && header->number<std::uint32_t>("size")) {
          return from + at;
        }
      }
    }
  }
  return limit_;
}

}  // namespace

bool looks_like_ros1_bag(std::span<const std::uint8_t> head) {
  return text_of(std::as_bytes(head)).starts_with("#ROSBAG V");
}

std::unique_ptr<RosRecording> open_ros1_recording(std::unique_ptr<std::istream> input, const std::string& name) {
  return std::make_unique<Ros1Bag>(std::move(input), name);
}

std::unique_ptr<Source> open_ros1_bag(const std::filesystem::path& file, const InputConfig& config) {
  auto input = std::make_unique<std::ifstream>(file, std::ios::binary);
  if (!*input) throw Error("cannot be read", {file.string()});
  return ros_events(open_ros1_recording(std::move(input), file.string()), config);
}

}  // namespace isobath
