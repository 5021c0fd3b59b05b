#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/ros/ros2_database.hpp>
#include <map>
#include <sqlite3.h>

namespace isobath {
namespace {

constexpr int kMaxRowBytes = 256 << 20;

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct FinaliseQuery {
  void operator()(sqlite3_stmt* query) const { sqlite3_finalize(query); }
};
using RosDatabase = std::unique_ptr<sqlite3, CloseDatabase>;
using RosQuery = std::unique_ptr<sqlite3_stmt, FinaliseQuery>;

std::string column_text(sqlite3_stmt* query, int column) {
  const auto* const text = sqlite3_column_text(query, column);
  return text ? std::string(reinterpret_cast<const char*>(text)) : std::string();
}

class Ros2Database final : public RosRecording {
 public:
  explicit Ros2Database(const std::filesystem::path& file) : name_(file.string()) {
    report_.format = "ROS 2 bag (SQLite)";
    std::error_code unknown;
    report_.bytes_total = std::filesystem::file_size(file, unknown);
    sqlite3* raw = nullptr;
    const int opened = sqlite3_open_v2(name_.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(raw);
    if (opened != SQLITE_OK) refuse();
    sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, kMaxRowBytes);
    read_topics();
    messages_ = query("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, rowid");
    if (!messages_) refuse();
  }

  [[nodiscard]] const std::vector<RosTopic>& topics() const override { return topics_; }
  [[nodiscard]] SourceReport& report() override { return report_; }

  std::optional<RosRecord> next() override {
    while (messages_) {
      const int state = sqlite3_step(messages_.get());
      if (state != SQLITE_ROW) {
        if (state != SQLITE_DONE) {
          report_.details["damage"] = fmt::format("SQLite cannot read on: {}", sqlite3_errmsg(database_.get()));
          ++report_.rejected["rest of the database, which SQLite cannot read"];
        }
        messages_.reset();
        break;
      }
      if (auto record = row()) return record;
    }
    report_.bytes_read = report_.bytes_total;
    return {};
  }

 private:
  [[noreturn]] void refuse() {
    const char* const why = database_ ? sqlite3_errmsg(database_.get()) : "out of memory";
    throw Error(fmt::format("is a ROS 2 bag that SQLite cannot read ({})", why), {name_});
  }

  /// Null: SQLite refuses it, for example since a table does not exist.
  RosQuery query(const char* text) {
    sqlite3_stmt* raw = nullptr;
    const int prepared = sqlite3_prepare_v2(database_.get(), text, -1, &raw, nullptr);
    RosQuery query(raw);
    return prepared == SQLITE_OK ? std::move(query) : nullptr;
  }

  void read_topics() {
    std::map<std::string, std::string> definitions;
    if (const RosQuery q =
            query("SELECT topic_type, encoded_message_definition FROM message_definitions WHERE encoding='ros2msg'")) {
      while (sqlite3_step(q.get()) == SQLITE_ROW) definitions[column_text(q.get(), 0)] = column_text(q.get(), 1);
    }
    std::map<std::int64_t, std::uint64_t> counts;
    if (const RosQuery q = query("SELECT topic_id, count(*) FROM messages GROUP BY topic_id")) {
      while (sqlite3_step(q.get()) == SQLITE_ROW) {
        counts[sqlite3_column_int64(q.get(), 0)] = static_cast<std::uint64_t>(sqlite3_column_int64(q.get(), 1));
      }
    }
    const RosQuery q = query("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    if (!q) refuse();
    while (sqlite3_step(q.get()) == SQLITE_ROW && topics_.size() < 10'000) {
      const std::int64_t id = sqlite3_column_int64(q.get(), 0);
      RosTopic topic{
          column_text(q.get(), 1), ros_type_name(column_text(q.get(), 2)), RosEncoding::kCdr, {}, counts[id]};
      const auto own = definitions.find(column_text(q.get(), 2));
      const std::string text =
          own != definitions.end() ? own->second : known_ros_definition(topic.type, RosEncoding::kCdr);
      if (column_text(q.get(), 3) == "cdr" && !text.empty()) topic.definition = RosDefinition::parse(topic.type, text);
      numbers_[id] = topics_.size();
      topics_.push_back(std::move(topic));
    }
  }

  std::optional<RosRecord> row() {
    const auto topic = numbers_.find(sqlite3_column_int64(messages_.get(), 0));
    if (topic == numbers_.end()) {
      ++report_.rejected["message of an unknown topic"];
      return {};
    }
    const auto* const bytes = static_cast<const std::byte*>(sqlite3_column_blob(messages_.get(), 2));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(messages_.get(), 2));
    const auto kept = std::make_shared<const std::vector<std::byte>>(bytes, bytes + (bytes ? size : 0));
    report_.bytes_read = std::min(report_.bytes_total, report_.bytes_read + size);
    const Time time{std::chrono::nanoseconds(sqlite3_column_int64(messages_.get(), 1))};
    return RosRecord{topic->second, time, *kept, kept};
  }

  std::string name_;
  SourceReport report_;
  RosDatabase database_;
  RosQuery messages_;
  std::vector<RosTopic> topics_;
  std::map<std::int64_t, std::size_t> numbers_;  ///< topic_id: index of topics_
};

}  // namespace

std::vector<std::string> sqlite_tables(std::string_view head) {
  constexpr std::string_view kWords = "CREATE TABLE ", kQuotes = "\"'`[ ";
  constexpr std::size_t kMaxTables = 20;
  std::vector<std::string> tables;
  for (std::size_t at = head.find(kWords); at != std::string_view::npos; at = head.find(kWords, at + 1)) {
    std::string_view name = head.substr(at + kWords.size(), 80);
    name.remove_prefix(std::min(name.find_first_not_of(kQuotes), name.size()));
    name = name.substr(0, name.find_first_of("\"'`]( "));
    if (!name.empty() && tables.size() < kMaxTables) tables.emplace_back(name);
  }
  std::ranges::sort(tables);
  return tables;
}

bool looks_like_ros2_database(Bytes head) {
  if (!text_of(head).starts_with("SQLite format 3")) return false;
  const std::vector<std::string> tables = sqlite_tables(text_of(head));
  return std::ranges::count(tables, "topics") > 0 && std::ranges::count(tables, "messages") > 0;
}

std::unique_ptr<RosRecording> open_ros2_recording(const std::filesystem::path& file) {
  return std::make_unique<Ros2Database>(file);
}

std::unique_ptr<Source> open_ros2_database(const std::filesystem::path& file, const InputConfig& config) {
  return ros_events(open_ros2_recording(file), config);
}

}  // namespace isobath
