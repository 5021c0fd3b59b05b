#include <cmath>
#include <fmt/format.h>
#include <isobath/map/storage/sqlite_file.hpp>
#include <sqlite3.h>
#include <utility>

namespace isobath {

SqliteUse::~SqliteUse() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

SqliteUse& SqliteUse::bound(int code) {
  if (code != SQLITE_OK) {
    throw Error(fmt::format("a value is refused: {}", sqlite3_errstr(code)), {file_},
                fmt::format("at most {} bytes", SqliteFile::kLongestValue));
  }
  return *this;
}

SqliteUse& SqliteUse::with(std::int64_t value) { return bound(sqlite3_bind_int64(statement_, ++in_, value)); }
SqliteUse& SqliteUse::with(double value) { return bound(sqlite3_bind_double(statement_, ++in_, value)); }
SqliteUse& SqliteUse::with(const std::string& value) {
  return bound(sqlite3_bind_text64(statement_, ++in_, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}

SqliteUse& SqliteUse::with(std::span<const std::byte> value) {
  return bound(sqlite3_bind_blob64(statement_, ++in_, value.data(), value.size(), SQLITE_TRANSIENT));
}

bool SqliteUse::step() {
  out_ = 0;
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  throw Error(fmt::format("cannot be read or written: {}", sqlite3_errmsg(connection_)), {file_});
}

std::int64_t SqliteUse::integer() { return sqlite3_column_int64(statement_, out_++); }

double SqliteUse::finite(const char* what) {
  const double value = sqlite3_column_double(statement_, out_++);
  if (!std::isfinite(value)) throw Error(fmt::format("{} is not finite", what), {file_});
  return value;
}

std::string SqliteUse::text() {
  const auto* first = reinterpret_cast<const char*>(sqlite3_column_text(statement_, out_));
  const int size = sqlite3_column_bytes(statement_, out_++);
  return first == nullptr ? std::string() : std::string(first, static_cast<std::size_t>(size));
}

std::span<const std::byte> SqliteUse::bytes() {
  const auto* first = static_cast<const std::byte*>(sqlite3_column_blob(statement_, out_));
  const int size = sqlite3_column_bytes(statement_, out_++);
  return {first, first == nullptr ? 0 : static_cast<std::size_t>(size)};
}

SqliteFile::SqliteFile(const std::filesystem::path& path, const SqliteSchema& schema,
                       const std::vector<std::string>& statements)
    : name_(path.string()), statements_(statements.size(), nullptr) {
  try {
    open(schema);
    for (std::size_t i = 0; i < statements.size(); ++i) {
      const int code = sqlite3_prepare_v3(connection_, statements[i].c_str(), -1, SQLITE_PREPARE_PERSISTENT,
                                          &statements_[i], nullptr);
      if (code != SQLITE_OK) fail("cannot be used");
    }
  } catch (...) {
    close();
    throw;
  }
}

void SqliteFile::close() noexcept {
  for (sqlite3_stmt*& s : statements_) sqlite3_finalize(std::exchange(s, nullptr));
  sqlite3_close(std::exchange(connection_, nullptr));
}

void SqliteFile::fail(const std::string& doing) const {
  const int code = connection_ == nullptr ? SQLITE_NOMEM : sqlite3_errcode(connection_);
  const std::string advice = code == SQLITE_BUSY ? "another program has it open; close that first"
                             : code == SQLITE_NOTADB || code == SQLITE_CORRUPT
                                 ? "give another file, or move this one away to start anew"
                                 : "";
  throw Error(fmt::format("{}: {}", doing, connection_ == nullptr ? "out of memory" : sqlite3_errmsg(connection_)),
              {name_}, {}, advice);
}

void SqliteFile::execute(const std::string& sql, const std::string& doing) const {
  if (sqlite3_exec(connection_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail(doing);
}

/// First column of the first row.
std::string SqliteFile::ask(const std::string& sql, const std::string& doing) const {
  std::string answer;
  const auto take = [](void* out, int count, char** values, char**) {
    auto& text = *static_cast<std::string*>(out);
    if (count > 0 && values[0] != nullptr && text.empty()) text = values[0];
    return 0;
  };
  if (sqlite3_exec(connection_, sql.c_str(), take, &answer, nullptr) != SQLITE_OK) fail(doing);
  return answer;
}

void SqliteFile::open(const SqliteSchema& schema) {
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
  if (sqlite3_open_v2(name_.c_str(), &connection_, flags, nullptr) != SQLITE_OK) fail("cannot be opened");
  sqlite3_limit(connection_, SQLITE_LIMIT_LENGTH, kLongestValue);
  sqlite3_db_config(connection_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(connection_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  execute("PRAGMA locking_mode = EXCLUSIVE; PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0", "cannot be opened");
  execute("BEGIN EXCLUSIVE; COMMIT", "cannot be opened");

  const bool empty = is_empty(schema);
  const std::string found = ask("PRAGMA integrity_check(1)", "is damaged");
  if (found != "ok") throw Error("is damaged: " + found, {name_}, {}, "move it away to start anew");
  execute("PRAGMA journal_mode = DELETE; PRAGMA synchronous = EXTRA; PRAGMA foreign_keys = ON", "cannot be opened");
  if (!empty) return;
  std::string make = "BEGIN;";
  for (const std::string& sql : schema.tables) make += sql + ";";
  make +=
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}; COMMIT", schema.application, schema.version);
  execute(make, "cannot be created");
}

/// Throws Error where the file holds something other than the schema.
bool SqliteFile::is_empty(const SqliteSchema& schema) const {
  const std::string not_one = "cannot be read as the " + schema.what;
  const auto count = [&](const std::string& condition) {
    return ask("SELECT count(*) FROM sqlite_schema WHERE " + condition, not_one);
  };
  const std::string application = ask("PRAGMA application_id", not_one);
  const std::string version = ask("PRAGMA user_version", not_one);
  if (application == "0" && version == "0" && count("true") == "0") return true;
  if (application != std::to_string(schema.application)) {
    throw Error("is a database, but not of the " + schema.what, {name_}, {}, "give another file");
  }
  if (version != std::to_string(schema.version)) {
    throw Error(fmt::format("has schema version {}", version), {name_}, std::to_string(schema.version),
                "read it with the version of the program that wrote it");
  }
  bool same = count("name NOT LIKE 'sqlite\\_%' ESCAPE '\\'") == std::to_string(schema.tables.size());
  for (const std::string& sql : schema.tables) same = same && count(fmt::format("sql = '{}'", sql)) == "1";
  if (!same) throw Error("has tables that do not belong to the " + schema.what, {name_}, {}, "give another file");
  return false;
}

bool SqliteFile::changed() const { return sqlite3_changes(connection_) > 0; }

bool SqliteFile::in_transaction() const { return sqlite3_get_autocommit(connection_) == 0; }

void SqliteFile::roll_back() noexcept {
  if (in_transaction()) sqlite3_exec(connection_, "ROLLBACK", nullptr, nullptr, nullptr);
}

}  // namespace isobath
