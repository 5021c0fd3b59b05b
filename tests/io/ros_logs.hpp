// Messages of ROS in both encodings, and the files that hold them, written by hand: bags of ROS 1 by their format page,
// bags of ROS 2 by SQLite and by McapWriter.
#pragma once

#include <bzlib.h>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <isobath/io/mcap/mcap.hpp>
#include <lz4frame.h>
#include <sqlite3.h>
#include <string>
#include <tests/io/bytes_by_hand.hpp>
#include <vector>

namespace isobath::test {

/// Writes values one after the other, packed (ROS 1), or aligned after a head of four bytes (CDR of ROS 2).
class RosBytes {
 public:
  explicit RosBytes(bool cdr) : cdr_(cdr), bytes_(cdr ? std::string("\0\1\0\0", 4) : std::string()) {}

  template <class Number>
  RosBytes& number(Number value) {
    while (cdr_ && (bytes_.size() - 4) % sizeof value != 0) bytes_ += '\0';
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  template <class Number>
  RosBytes& numbers(const std::vector<Number>& values, bool counted = true) {
    if (counted) number(static_cast<std::uint32_t>(values.size()));
    for (const Number value : values) number(value);
    return *this;
  }
  RosBytes& text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + (cdr_ ? 1 : 0)));
    bytes_ += value;
    if (cdr_) bytes_ += '\0';
    return *this;
  }
  RosBytes& bytes(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  RosBytes& header(double time_s, const std::string& frame) {
    if (!cdr_) number(std::uint32_t{7});
    const auto whole = static_cast<std::uint32_t>(time_s);
    number(whole).number(static_cast<std::uint32_t>((time_s - whole) * 1e9 + 0.5));
    return text(frame);
  }
  [[nodiscard]] const std::string& done() const { return bytes_; }

 private:
  bool cdr_;
  std::string bytes_;
};

inline const std::string kRosRule = std::string(80, '=') + "\nMSG: ";
inline const std::string kRosHeader1 = kRosRule + "std_msgs/Header\nuint32 seq\n# when\ntime stamp\nstring frame_id\n";
inline const std::string kRosHeader2 = kRosRule + "std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" +
                                       kRosRule + "builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

struct RosTopicText {
  std::string topic, type, definition;  ///< the definition without that of Header
};
struct RosMessageBytes {
  std::size_t topic = 0;
  double time_s = 0;
  std::string data;
};

/// A log as its topics and messages; written as any kind of file.
struct RosLog {
  std::vector<RosTopicText> topics;
  std::vector<RosMessageBytes> messages;
};

inline std::string bag_field(const std::string& name, const std::string& value) {
  return little(static_cast<std::uint32_t>(name.size() + 1 + value.size())) + name + "=" + value;
}
inline std::string bag_record(const std::string& header, const std::string& data) {
  return little(static_cast<std::uint32_t>(header.size())) + header + little(static_cast<std::uint32_t>(data.size())) +
         data;
}
inline std::string bag_time(double time_s) {
  const auto whole = static_cast<std::uint32_t>(time_s);
  return little(whole) + little(static_cast<std::uint32_t>((time_s - whole) * 1e9 + 0.5));
}

inline std::string packed(const std::string& plain, const std::string& compression) {
  if (compression == "bz2") {
    std::string out(plain.size() + plain.size() / 100 + 600, '\0');
    auto size = static_cast<unsigned>(out.size());
    BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(plain.data()), static_cast<unsigned>(plain.size()), 9,
                             0, 0);
    out.resize(size);
    return out;
  }
  if (compression == "lz4") {
    std::string out(LZ4F_compressFrameBound(plain.size(), nullptr), '\0');
    out.resize(LZ4F_compressFrame(out.data(), out.size(), plain.data(), plain.size(), nullptr));
    return out;
  }
  return plain;
}

/// `a_chunk`: messages in a chunk. `closed`: with the index at the end.
inline std::string ros1_bag(const RosLog& log, const std::string& compression = "none", std::size_t a_chunk = 4,
                            bool closed = true) {
  const auto connection = [&](std::size_t i) {
    const RosTopicText& t = log.topics[i];
    return bag_record(bag_field("conn", little(static_cast<std::uint32_t>(i))) + bag_field("op", "\x07") +
                          bag_field("topic", t.topic),
                      bag_field("topic", t.topic) + bag_field("type", t.type) + bag_field("md5sum", "*") +
                          bag_field("message_definition", t.definition + "\n" + kRosHeader1));
  };
  std::string body, infos;
  std::uint32_t chunks = 0;
  for (std::size_t first = 0; first < log.messages.size(); first += a_chunk, ++chunks) {
    std::string plain;
    std::vector<std::uint32_t> counts(log.topics.size());
    for (std::size_t i = 0; i < log.topics.size(); ++i) plain += connection(i);
    const std::size_t last = std::min(first + a_chunk, log.messages.size());
    for (std::size_t m = first; m < last; ++m) {
      const RosMessageBytes& message = log.messages[m];
      ++counts[message.topic];
      plain +=
          bag_record(bag_field("op", "\x02") + bag_field("conn", little(static_cast<std::uint32_t>(message.topic))) +
                         bag_field("time", bag_time(message.time_s)),
                     message.data);
    }
    body += bag_record(bag_field("compression", compression) + bag_field("op", "\x05") +
                           bag_field("size", little(static_cast<std::uint32_t>(plain.size()))),
                       packed(plain, compression));
    std::string listed;
    for (std::uint32_t i = 0; i < counts.size(); ++i) listed += little(i) + little(counts[i]);
    infos += bag_record(bag_field("ver", little(std::uint32_t{1})) + bag_field("op", "\x06") +
                            bag_field("chunk_pos", little(std::uint64_t{0})) +
                            bag_field("start_time", bag_time(log.messages[first].time_s)) +
                            bag_field("end_time", bag_time(log.messages[last - 1].time_s)) +
                            bag_field("count", little(static_cast<std::uint32_t>(counts.size()))),
                        listed);
  }
  const std::string magic = "#ROSBAG V2.0\n";
  const auto head = [&](std::uint64_t index) {
    const std::string fields = bag_field("op", "\x03") + bag_field("index_pos", little(index)) +
                               bag_field("conn_count", little(static_cast<std::uint32_t>(log.topics.size()))) +
                               bag_field("chunk_count", little(chunks));
    return bag_record(fields, std::string(4096 - fields.size(), ' '));
  };
  std::string connections;
  for (std::size_t i = 0; i < log.topics.size(); ++i) connections += connection(i);
  const std::size_t index = magic.size() + head(0).size() + body.size();
  if (!closed) return magic + head(0) + body;
  return magic + head(index) + body + connections + infos;
}

/// "sensor_msgs/Range" -> "sensor_msgs/msg/Range".
inline std::string ros2_name(std::string type) { return type.insert(type.find('/'), "/msg"); }

/// `definitions`: as rosbag2 writes them since Iron.
inline void write_ros2_database(const std::filesystem::path& file, const RosLog& log, bool definitions) {
  sqlite3* database = nullptr;
  sqlite3_open(file.string().c_str(), &database);
  const auto run = [&](const std::string& sql) { sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr); };
  run("PRAGMA synchronous=OFF");  // no test loses power
  run("BEGIN");
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT "
      "NULL,offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB "
      "NOT "
      "NULL)");
  if (definitions) {
    run("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type TEXT NOT NULL,encoding TEXT NOT "
        "NULL,encoded_message_definition TEXT NOT NULL,type_description_hash TEXT NOT NULL)");
  }
  for (std::size_t i = 0; i < log.topics.size(); ++i) {
    const RosTopicText& t = log.topics[i];
    run("INSERT INTO topics VALUES(" + std::to_string(i + 1) + ",'" + t.topic + "','" + ros2_name(t.type) +
        "','cdr','')");
    if (definitions) {
      run("INSERT INTO message_definitions(topic_type,encoding,encoded_message_definition,type_description_hash) "
          "VALUES('" +
          ros2_name(t.type) + "','ros2msg','" + t.definition + "\n" + kRosHeader2 + "','')");
    }
  }
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)", -1, &insert, nullptr);
  for (const RosMessageBytes& m : log.messages) {
    sqlite3_bind_int64(insert, 1, static_cast<sqlite3_int64>(m.topic + 1));
    sqlite3_bind_int64(insert, 2, static_cast<sqlite3_int64>(m.time_s * 1e9));
    sqlite3_bind_blob(insert, 3, m.data.data(), static_cast<int>(m.data.size()), SQLITE_TRANSIENT);
    sqlite3_step(insert);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  run("COMMIT");
  sqlite3_close(database);
}

inline void write_ros_mcap(const std::filesystem::path& file, const RosLog& log, bool cdr) {
  McapWriter writer(file, {});
  std::vector<std::uint16_t> channels;
  for (const RosTopicText& t : log.topics) {
    McapSchema schema;
    schema.name = cdr ? ros2_name(t.type) : t.type;
    schema.encoding = cdr ? "ros2msg" : "ros1msg";
    schema.data = t.definition + "\n" + (cdr ? kRosHeader2 : kRosHeader1);
    McapChannel channel;
    channel.schema_id = writer.add_schema(schema);
    channel.topic = t.topic;
    channel.message_encoding = cdr ? "cdr" : "ros1";
    channels.push_back(writer.add_channel(channel));
  }
  for (const RosMessageBytes& m : log.messages) {
    McapMessage message;
    message.channel_id = channels[m.topic];
    message.log_time = message.publish_time = static_cast<std::uint64_t>(m.time_s * 1e9);
    message.data = {reinterpret_cast<const std::uint8_t*>(m.data.data()), m.data.size()};
    writer.write(message);
  }
  writer.close();
}

}  // namespace isobath::test
