#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/ros/ros1_records.hpp>
#include <isobath/io/ros/ros_recorder.hpp>
#include <lz4frame.h>
#include <map>
#include <set>

namespace isobath {
namespace {

using ros1::Op;

constexpr std::size_t kBagChunkBytes = 768 << 10;  // as rosbag has it
constexpr std::size_t kBagHeadBytes = 4096;        // of the first record, so that it can be written again
constexpr std::string_view kMagicOfBag = "#ROSBAG V2.0\n";

template <class Number>
std::string bag_bytes(Number value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string bag_bytes(Time time) {
  const std::int64_t ns = time.time_since_epoch().count();
  constexpr std::int64_t kSecond = 1'000'000'000;
  return bag_bytes(static_cast<std::uint32_t>(ns / kSecond)) + bag_bytes(static_cast<std::uint32_t>(ns % kSecond));
}

/// Fields of a header: each with its length, name and value.
class BagHeader {
 public:
  explicit BagHeader(Op op) { add("op", std::string(1, static_cast<char>(op))); }
  BagHeader() = default;
  BagHeader& add(std::string_view name, std::string_view value) {
    bytes_ += bag_bytes(static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    bytes_.append(name).append("=").append(value);
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  /// The record with this header.
  [[nodiscard]] std::string with(std::string_view data) const {
    std::string record = bag_bytes(static_cast<std::uint32_t>(bytes_.size())) + bytes_;
    record += bag_bytes(static_cast<std::uint32_t>(data.size()));
    return record.append(data);
  }

 private:
  std::string bytes_;
};

/// One frame of lz4 with independent blocks and a checksum, as the reader of ROS needs it.
std::string lz4_frame(std::string_view plain) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.blockSizeID = LZ4F_max1MB;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string out(LZ4F_compressFrameBound(plain.size(), &preferences), '\0');
  const std::size_t size = LZ4F_compressFrame(out.data(), out.size(), plain.data(), plain.size(), &preferences);
  ISOBATH_ASSERT(!LZ4F_isError(size));
  out.resize(size);
  return out;
}

class Ros1BagWriter final : public RosRecorder {
 public:
  explicit Ros1BagWriter(const std::filesystem::path& file) : file_(file.string()) {
    out_.open(file, std::ios::binary | std::ios::trunc);
    put_bytes(kMagicOfBag);
    put_bytes(head(0));
  }

  [[nodiscard]] RosEncoding encoding() const override { return RosEncoding::kRos1; }

  void close() override {
    finish_chunk();
    const std::uint64_t index = position_;
    for (std::size_t i = 0; i < topics().size(); ++i) put_bytes(connection(i));
    for (const std::string& info : infos_) put_bytes(info);
    out_.seekp(static_cast<std::streamoff>(kMagicOfBag.size()));
    put_bytes(head(index));
    out_.close();
    check();
  }

 private:
  void start(std::size_t) override {}

  void put(std::size_t topic, Time time, std::span<const std::uint8_t> message) override {
    const auto number = static_cast<std::uint32_t>(topic);
    if (started_.insert(topic).second) chunk_ += connection(topic);
    index_[number] += bag_bytes(time) + bag_bytes(static_cast<std::uint32_t>(chunk_.size()));
    in_chunk_.add(time);
    const std::string_view data(reinterpret_cast<const char*>(message.data()), message.size());
    chunk_ += BagHeader(Op::kMessage).add("conn", bag_bytes(number)).add("time", bag_bytes(time)).with(data);
    if (chunk_.size() >= kBagChunkBytes) finish_chunk();
  }

  [[nodiscard]] std::string connection(std::size_t topic) const {
    const RecordedTopic& t = topics()[topic];
    BagHeader data;
    data.add("topic", t.name).add("type", t.type).add("md5sum", ros1_checksum(t.type));
    data.add("message_definition", known_ros_definition(t.type, RosEncoding::kRos1));
    if (t.latched) data.add("latching", "1");
    BagHeader header(Op::kConnection);
    header.add("conn", bag_bytes(static_cast<std::uint32_t>(topic))).add("topic", t.name);
    return header.with(data.bytes());
  }

  [[nodiscard]] std::string head(std::uint64_t index) const {
    BagHeader header(Op::kBagHeader);
    header.add("index_pos", bag_bytes(index));
    header.add("conn_count", bag_bytes(static_cast<std::uint32_t>(topics().size())));
    header.add("chunk_count", bag_bytes(static_cast<std::uint32_t>(infos_.size())));
    return header.with(std::string(kBagHeadBytes - header.bytes().size(), ' '));
  }

  void finish_chunk() {
    if (chunk_.empty()) return;
    BagHeader info(Op::kChunkInfo);
    info.add("ver", bag_bytes(std::uint32_t{1})).add("chunk_pos", bag_bytes(position_));
    info.add("start_time", bag_bytes(*in_chunk_.first)).add("end_time", bag_bytes(*in_chunk_.last));
    info.add("count", bag_bytes(static_cast<std::uint32_t>(index_.size())));
    BagHeader header(Op::kChunk);
    header.add("compression", "lz4").add("size", bag_bytes(static_cast<std::uint32_t>(chunk_.size())));
    put_bytes(header.with(lz4_frame(chunk_)));
    std::string counts;
    for (const auto& [topic, entries] : index_) {
      constexpr std::size_t kEntry = 12;  // time and offset of a message
      const auto count = static_cast<std::uint32_t>(entries.size() / kEntry);
      BagHeader listed(Op::kIndex);
      listed.add("ver", bag_bytes(std::uint32_t{1})).add("conn", bag_bytes(topic)).add("count", bag_bytes(count));
      put_bytes(listed.with(entries));
      counts += bag_bytes(topic) + bag_bytes(count);
    }
    infos_.push_back(info.with(counts));
    chunk_.clear();
    index_.clear();
    in_chunk_ = {};
  }

  void put_bytes(std::string_view bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    check();
    position_ += bytes.size();
  }
  void check() const {
    if (!out_)
      throw Error("cannot be written", {file_, position_, {}, {}, {}}, "", "check its folder and the free space");
  }

  std::string file_;
  std::ofstream out_;
  std::uint64_t position_ = 0;
  std::string chunk_;                           ///< records of the chunk that grows
  std::map<std::uint32_t, std::string> index_;  ///< topic: times and offsets of its messages in the chunk
  RecordedSpan in_chunk_;
  std::set<std::size_t> started_;   ///< topics whose connection a chunk holds
  std::vector<std::string> infos_;  ///< records of the chunks for the end of the file
};

}  // namespace

void RecordedSpan::add(Time time) {
  first = first ? std::min(*first, time) : time;
  last = last ? std::max(*last, time) : time;
}

std::size_t RosRecorder::add_topic(RecordedTopic topic) {
  topics_.push_back(std::move(topic));
  start(topics_.size() - 1);
  return topics_.size() - 1;
}

void RosRecorder::write(std::size_t topic, Time time, std::span<const std::uint8_t> message) {
  put(topic, time, message);
  ++topics_[topic].messages;
  span_.add(time);
}

std::unique_ptr<RosRecorder> record_ros1_bag(const std::filesystem::path& file) {
  return std::make_unique<Ros1BagWriter>(file);
}

}  // namespace isobath
