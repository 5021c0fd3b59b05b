// ROS 2 bags: in SQLite with metadata.yaml, and in MCAP.
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/mcap.hpp>
#include <isobath/io/ros/ros_recorder.hpp>
#include <sqlite3.h>

namespace isobath {
namespace {

/// Quality of service of a topic, as rosbag2 keeps it: reliable; "transient local" if it is latched.
std::string qos_of(const RecordedTopic& topic) {
  if (!topic.latched) return {};
  constexpr const char* kNoLimit = "\n    sec: 9223372036\n    nsec: 854775807\n";
  return fmt::format(
      "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n  deadline:{0}  lifespan:{0}  liveliness: 1\n  "
      "liveliness_lease_duration:{0}  avoid_ros_namespace_conventions: false",
      kNoLimit);
}

/// "sensor_msgs/Range" -> "sensor_msgs/msg/Range".
std::string ros2_type(std::string type) { return type.insert(type.find('/'), "/msg"); }

class Ros2DatabaseWriter final : public RosRecorder {
 public:
  explicit Ros2DatabaseWriter(const std::filesystem::path& file) : file_(file.string()) {
    std::ofstream(file, std::ios::trunc).flush();  // SQLite would add to what stands there
    sqlite3* raw = nullptr;
    const int opened = sqlite3_open_v2(file_.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    database_.reset(raw);
    check(opened == SQLITE_OK);
    run("PRAGMA synchronous=OFF");  // the file is complete at the end or not at all
    run("PRAGMA journal_mode=OFF");
    run("BEGIN");
    run("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL)");
    run("INSERT INTO schema VALUES(4,'jazzy')");
    run("CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,metadata TEXT NOT NULL)");
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT "
        "NOT "
        "NULL,offered_qos_profiles TEXT NOT NULL,type_description_hash TEXT NOT NULL)");
    run("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type TEXT NOT NULL,encoding TEXT NOT "
        "NULL,encoded_message_definition TEXT NOT NULL,type_description_hash TEXT NOT NULL)");
    run("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL,data BLOB "
        "NOT NULL)");
    run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
    message_ = prepared("INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)");
  }

  [[nodiscard]] RosEncoding encoding() const override { return RosEncoding::kCdr; }

  void close() override {
    message_.reset();
    run("COMMIT");
    database_.reset();
  }

 private:
  struct Closing {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Closing>;

  void start(std::size_t topic) override {
    const RecordedTopic& t = topics()[topic];
    const Statement add = prepared(
        "INSERT INTO topics(id,name,type,serialization_format,offered_qos_profiles,type_description_hash) "
        "VALUES(?,?,?,'cdr',?,'')");
    check(sqlite3_bind_int64(add.get(), 1, static_cast<sqlite3_int64>(topic) + 1) == SQLITE_OK);
    bind(add, 2, t.name);
    bind(add, 3, ros2_type(t.type));
    bind(add, 4, qos_of(t));
    check(sqlite3_step(add.get()) == SQLITE_DONE);
    const Statement define = prepared(
        "INSERT INTO message_definitions(topic_type,encoding,encoded_message_definition,type_description_hash) SELECT "
        "?1,'ros2msg',?2,'' WHERE NOT EXISTS (SELECT 1 FROM message_definitions WHERE topic_type=?1)");
    bind(define, 1, ros2_type(t.type));
    bind(define, 2, known_ros_definition(t.type, RosEncoding::kCdr));
    check(sqlite3_step(define.get()) == SQLITE_DONE);
  }

  void put(std::size_t topic, Time time, std::span<const std::uint8_t> message) override {
    sqlite3_bind_int64(message_.get(), 1, static_cast<sqlite3_int64>(topic) + 1);
    sqlite3_bind_int64(message_.get(), 2, time.time_since_epoch().count());
    sqlite3_bind_blob64(message_.get(), 3, message.data(), message.size(), SQLITE_STATIC);
    check(sqlite3_step(message_.get()) == SQLITE_DONE);
    sqlite3_reset(message_.get());
  }

  Statement prepared(const char* text) {
    sqlite3_stmt* raw = nullptr;
    check(sqlite3_prepare_v2(database_.get(), text, -1, &raw, nullptr) == SQLITE_OK);
    return Statement(raw);
  }
  void bind(const Statement& statement, int column, const std::string& text) {
    check(sqlite3_bind_text(statement.get(), column, text.c_str(), -1, SQLITE_TRANSIENT) == SQLITE_OK);
  }
  void run(const char* text) { check(sqlite3_exec(database_.get(), text, nullptr, nullptr, nullptr) == SQLITE_OK); }
  void check(bool fine) const {
    if (fine) return;
    const char* const why = database_ ? sqlite3_errmsg(database_.get()) : "out of memory";
    throw Error(fmt::format("cannot be written by SQLite ({})", why), {file_}, "",
                "check its folder and the free space");
  }

  std::string file_;
  std::unique_ptr<sqlite3, Closing> database_;
  Statement message_;
};

class Ros2McapWriter final : public RosRecorder {
 public:
  explicit Ros2McapWriter(const std::filesystem::path& file) : mcap_(file, {}, "ros2") {}

  [[nodiscard]] RosEncoding encoding() const override { return RosEncoding::kCdr; }
  void close() override { mcap_.close(); }

 private:
  void start(std::size_t topic) override {
    const RecordedTopic& t = topics()[topic];
    const std::uint16_t schema =
        mcap_.add_schema({0, ros2_type(t.type), "ros2msg", known_ros_definition(t.type, RosEncoding::kCdr)});
    channels_.push_back(mcap_.add_channel({0, schema, t.name, "cdr", {{"offered_qos_profiles", qos_of(t)}}}));
  }
  void put(std::size_t topic, Time time, std::span<const std::uint8_t> message) override {
    const auto ns = static_cast<std::uint64_t>(time.time_since_epoch().count());
    const auto sequence = static_cast<std::uint32_t>(topics()[topic].messages);
    mcap_.write({channels_[topic], sequence, ns, ns, message, nullptr});
  }

  McapWriter mcap_;
  std::vector<std::uint16_t> channels_;  ///< by topic
};

/// A text of several lines between quotes of YAML.
std::string quoted_yaml(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out + "\"";
}

}  // namespace

std::unique_ptr<RosRecorder> record_ros2_database(const std::filesystem::path& file) {
  return std::make_unique<Ros2DatabaseWriter>(file);
}

std::unique_ptr<RosRecorder> record_ros2_mcap(const std::filesystem::path& file) {
  return std::make_unique<Ros2McapWriter>(file);
}

std::string metadata_yaml(const RosRecorder& bag, const std::string& file_name) {
  const Time first = bag.span().first.value_or(Time{}), last = bag.span().last.value_or(first);
  const std::int64_t start = first.time_since_epoch().count(), length = (last - first).count();
  std::uint64_t all = 0;
  std::string topics;
  for (const RecordedTopic& t : bag.topics()) {
    all += t.messages;
    topics += fmt::format(
        "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n        "
        "offered_qos_profiles: {}\n      message_count: {}\n",
        t.name, ros2_type(t.type), quoted_yaml(qos_of(t)), t.messages);
  }
  return fmt::format(
      "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  duration:\n    nanoseconds: {0}\n  "
      "starting_time:\n    nanoseconds_since_epoch: {1}\n  message_count: {2}\n  topics_with_message_count:{3}\n{4}  "
      "compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - {5}\n  files:\n    - path: "
      "{5}\n      starting_time:\n        nanoseconds_since_epoch: {1}\n      duration:\n        nanoseconds: {0}\n    "
      "  "
      "message_count: {2}\n",
      length, start, all, topics.empty() ? " []" : "", topics, quoted_yaml(file_name));
}

}  // namespace isobath
