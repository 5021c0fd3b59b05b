// SqliteFile: an SQLite database that belongs to one program and holds one known schema, and its statements.
//
// The file stays locked while it is open. Rollback journal; every commit flushes the file and its folder before it
// returns. Opening refuses, and does not change, a file that is not a database, that another kind of program made,
// whose schema differs in a word (it could contain triggers), or in which PRAGMA integrity_check finds damage: page
// structure, types, constraints, and indices that do not agree with their tables, which quick_check would not find.
//
// Throws Error with one line that names the file. One thread at a time. Hides sqlite3.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <isobath/base/error.hpp>
#include <span>
#include <string>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace isobath {

struct SqliteSchema {
  std::string what;                 ///< kind of file, for messages: "object store"
  std::int32_t application = 0;     ///< PRAGMA application_id, sqlite.org/fileformat 1.3.17
  int version = 1;                  ///< PRAGMA user_version
  std::vector<std::string> tables;  ///< CREATE ... word for word
};

/// One use of a prepared statement: values are bound and columns are read from left to right.
class SqliteUse {
 public:
  SqliteUse(sqlite3* connection, const std::string& file, sqlite3_stmt* statement)
      : connection_(connection), file_(file), statement_(statement) {}
  SqliteUse(const SqliteUse&) = delete;
  SqliteUse& operator=(const SqliteUse&) = delete;
  ~SqliteUse();

  SqliteUse& with(std::int64_t value);
  SqliteUse& with(double value);
  SqliteUse& with(const std::string& value);
  SqliteUse& with(std::span<const std::byte> value);
  /// Advances; returns whether there is a row.
  bool step();
  void run() {
    while (step()) {
    }
  }
  std::int64_t integer();
  double finite(const char* what);  ///< throws Error if the value is not finite
  std::string text();
  std::span<const std::byte> bytes();  ///< valid until the next step

 private:
  SqliteUse& bound(int code);

  sqlite3* connection_;
  const std::string& file_;
  sqlite3_stmt* statement_;
  int in_ = 0;
  int out_ = 0;
};

class SqliteFile {
 public:
  static constexpr int kLongestValue = 1 << 20;  ///< bytes of a text or a row

  /// Opens the file, or creates it with the schema. The index of a statement is its position in the list.
  SqliteFile(const std::filesystem::path& path, const SqliteSchema& schema, const std::vector<std::string>& statements);
  SqliteFile(const SqliteFile&) = delete;
  SqliteFile& operator=(const SqliteFile&) = delete;
  ~SqliteFile() { close(); }

  [[nodiscard]] SqliteUse use(std::size_t statement) const { return {connection_, name_, statements_[statement]}; }
  [[nodiscard]] bool changed() const;  ///< whether the last INSERT, UPDATE or DELETE changed anything
  [[nodiscard]] const std::string& name() const { return name_; }

  void begin() { execute("BEGIN IMMEDIATE", "cannot be written"); }
  void commit() { execute("COMMIT", "cannot be written"); }
  void roll_back() noexcept;  ///< does nothing where the disk failed: SQLite has rolled back
  [[nodiscard]] bool in_transaction() const;

 private:
  void open(const SqliteSchema& schema);
  [[nodiscard]] bool is_empty(const SqliteSchema& schema) const;
  void close() noexcept;
  [[noreturn]] void fail(const std::string& doing) const;
  void execute(const std::string& sql, const std::string& doing) const;
  [[nodiscard]] std::string ask(const std::string& sql, const std::string& doing) const;

  std::string name_;
  sqlite3* connection_ = nullptr;
  std::vector<sqlite3_stmt*> statements_;
};

}  // namespace isobath
