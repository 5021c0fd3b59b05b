#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap.hpp>
#include <isobath/io/mcap/mcap_file.hpp>
#include <isobath/io/ros/ros_mcap.hpp>
#include <map>

namespace isobath {
namespace {

std::optional<RosEncoding> ros_encoding_of(const McapChannel& channel) {
  if (channel.message_encoding == "cdr") return RosEncoding::kCdr;
  if (channel.message_encoding == "ros1") return RosEncoding::kRos1;
  return {};
}

/// The messages of each channel, as the summary at the end of the file states them; empty: there is none.
std::map<std::uint16_t, std::uint64_t> counts_in_summary(std::unique_ptr<std::istream> input) {
  mcap::SeekableInput file(std::move(input));
  std::map<std::uint16_t, std::uint64_t> counts;
  const auto summary = mcap::load_summary(file);
  if (!summary) return counts;
  mcap::Cursor rest(summary->records);
  while (const auto record = mcap::take_record(rest)) {
    if (record->opcode != mcap::kStatistics) continue;
    constexpr std::uint64_t kBeforeCounts = 8 + 2 + 4 + 4 + 4 + 4 + 8 + 8, kCountBytes = 2 + 8;
    mcap::Cursor c(record->content);
    (void)c.bytes(kBeforeCounts);
    const auto bytes = c.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < bytes / kCountBytes && c.ok(); ++i) {
      const auto channel = c.number<std::uint16_t>();
      counts[channel] += c.number<std::uint64_t>();
    }
  }
  return counts;
}

class RosMcap final : public RosRecording {
 public:
  RosMcap(const OpenLog& open, const std::string& name) : reader_(open(), name) {
    reader_.report().format = "ROS messages in MCAP";
    auto counts = counts_in_summary(open());
    if (counts.empty()) {
      McapReader first(open(), name);  // once for the topics and their counts
      while (const auto message = first.next()) ++counts[message->channel_id];
      for (const auto& [id, channel] : first.channels()) add(channel, first.schema(channel.schema_id));
    } else {
      for (const auto& [id, channel] : reader_.channels()) add(channel, reader_.schema(channel.schema_id));
    }
    for (const auto& [id, count] : counts) {
      const auto known = numbers_.find(id);
      if (known != numbers_.end()) topics_[known->second].messages += count;
    }
  }

  [[nodiscard]] const std::vector<RosTopic>& topics() const override { return topics_; }
  [[nodiscard]] SourceReport& report() override { return reader_.report(); }

  std::optional<RosRecord> next() override {
    const auto message = reader_.next();
    if (!message) return {};
    auto known = numbers_.find(message->channel_id);
    if (known == numbers_.end()) {
      const McapChannel& channel = *reader_.channel(message->channel_id);
      add(channel, reader_.schema(channel.schema_id));
      known = numbers_.find(message->channel_id);
    }
    const Time time{std::chrono::nanoseconds(static_cast<std::int64_t>(message->log_time))};
    return RosRecord{known->second, time, std::as_bytes(message->data), message->storage};
  }

 private:
  void add(const McapChannel& channel, const McapSchema* schema) {
    const auto encoding = ros_encoding_of(channel);
    RosTopic topic{channel.topic,
                   schema ? ros_type_name(schema->name) : channel.message_encoding,
                   encoding.value_or(RosEncoding::kCdr),
                   {},
                   0};
    if (schema && encoding) {
      const bool written = schema->encoding == "ros1msg" || schema->encoding == "ros2msg";
      const std::string text = written ? schema->data : known_ros_definition(topic.type, *encoding);
      if (!text.empty()) topic.definition = RosDefinition::parse(topic.type, text);
    }
    numbers_[channel.id] = topics_.size();
    topics_.push_back(std::move(topic));
  }

  McapReader reader_;
  std::vector<RosTopic> topics_;
  std::map<std::uint16_t, std::size_t> numbers_;  ///< channel: index of topics_
};

std::unique_ptr<std::istream> opened_log(const std::filesystem::path& file) {
  auto input = std::make_unique<std::ifstream>(file, std::ios::binary);
  if (!*input) throw Error("cannot be read", {file.string()});
  return input;
}

}  // namespace

bool holds_ros_messages(const std::filesystem::path& file) {
  constexpr int kLook = 1000;  // messages, in a file without a summary
  McapReader reader(opened_log(file), file.string());
  if (reader.channels().empty()) {
    for (int i = 0; i < kLook && reader.next(); ++i) {
    }
  }
  bool ros = false;
  for (const auto& [id, channel] : reader.channels()) {
    const McapSchema* const schema = reader.schema(channel.schema_id);
    if (schema && schema->name.starts_with("isobath/")) return false;
    ros = ros || (schema && ros_encoding_of(channel));
  }
  return ros;
}

std::unique_ptr<RosRecording> open_ros_mcap_recording(const OpenLog& open, const std::string& name) {
  return std::make_unique<RosMcap>(open, name);
}

std::unique_ptr<Source> open_ros_mcap(const std::filesystem::path& file, const InputConfig& config) {
  return ros_events(open_ros_mcap_recording([&] { return opened_log(file); }, file.string()), config);
}

}  // namespace isobath
