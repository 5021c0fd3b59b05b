#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/map/features/object_store.hpp>
#include <isobath/map/storage/sqlite_file.hpp>
#include <utility>

namespace isobath {
namespace {

constexpr std::size_t kLongestText = SqliteFile::kLongestValue - 1024;  // of an attribute, so that its row fits

/// Part of it, but used by no statement: the indexes by place and by name.
SqliteSchema schema() {
  return {"object store",
          0x49534f42,  // "ISOB"
          1,
          {R"(CREATE TABLE object(
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  capabilities INTEGER NOT NULL CHECK(capabilities BETWEEN 0 AND 4294967295),
  kind TEXT NOT NULL, name TEXT NOT NULL,
  north REAL NOT NULL, east REAL NOT NULL, depth REAL NOT NULL,
  nn REAL NOT NULL, ne REAL NOT NULL, nd REAL NOT NULL, ee REAL NOT NULL, ed REAL NOT NULL, dd REAL NOT NULL
) STRICT)",
           R"(CREATE INDEX object_by_place ON object(north, east))",
           R"(CREATE TABLE attribute(
  id INTEGER PRIMARY KEY,
  object INTEGER NOT NULL REFERENCES object(id) ON DELETE CASCADE,
  name TEXT NOT NULL,
  capacity INTEGER NOT NULL CHECK(capacity BETWEEN 1 AND 65536),
  written INTEGER NOT NULL,
  UNIQUE(object, name)
) STRICT)",
           R"(CREATE INDEX attribute_by_name ON attribute(name, object))",
           R"(CREATE TABLE entry(
  attribute INTEGER NOT NULL REFERENCES attribute(id) ON DELETE CASCADE,
  time_ns INTEGER NOT NULL, sequence INTEGER NOT NULL,
  kind INTEGER NOT NULL CHECK(kind BETWEEN 0 AND 3),
  number REAL NOT NULL, x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL, text TEXT NOT NULL, holes INTEGER NOT NULL,
  PRIMARY KEY(attribute, time_ns, sequence)
) STRICT, WITHOUT ROWID)"}};
}

enum Query : std::size_t {
  kCreate,
  kUpdate,
  kFind,
  kWithAny,
  kAttributes,
  kAttribute,
  kMakeAttribute,
  kCountUp,
  kPut,
  kTrim,
  kHistory,
  kLatest,
  kQueries
};

constexpr const char* kColumns = "id, capabilities, kind, name, north, east, depth, nn, ne, nd, ee, ed, dd";

std::vector<std::string> statements() {
  const std::string columns = kColumns;
  const std::string entry =
      "time_ns, kind, number, x, y, z, text, holes FROM entry JOIN attribute ON attribute.id = "
      "entry.attribute WHERE object = ? AND name = ? ORDER BY time_ns";
  std::vector<std::string> sql(kQueries);
  sql[kCreate] = "INSERT INTO object(" + columns.substr(4) + ") VALUES(?,?,?,?,?,?,?,?,?,?,?,?) RETURNING id";
  sql[kUpdate] =
      "UPDATE object SET capabilities=?, kind=?, name=?, north=?, east=?, depth=?, nn=?, ne=?, nd=?, ee=?, ed=?, dd=? "
      "WHERE id=?";
  sql[kFind] = "SELECT " + columns + " FROM object WHERE id=?";
  sql[kWithAny] = "SELECT id FROM object WHERE capabilities & ?1 <> 0 ORDER BY id";
  sql[kAttributes] = "SELECT name FROM attribute WHERE object=? AND written > 0 ORDER BY name";
  sql[kAttribute] = "SELECT id, capacity FROM attribute WHERE object=? AND name=?";
  sql[kMakeAttribute] =
      "INSERT INTO attribute(object, name, capacity, written) SELECT id, ?, ?, 0 FROM object WHERE id=? "
      "ON CONFLICT DO NOTHING";
  sql[kCountUp] = "UPDATE attribute SET written = written + 1 WHERE id=? RETURNING written";
  sql[kPut] = "INSERT INTO entry VALUES(?,?,?,?,?,?,?,?,?,?)";
  sql[kTrim] =  // entries older than the N-th newest, if there is one
      "DELETE FROM entry WHERE attribute = ?1 AND (time_ns, sequence) < (SELECT time_ns, sequence FROM entry WHERE "
      "attribute = ?1 ORDER BY time_ns DESC, sequence DESC LIMIT 1 OFFSET ?2 - 1)";
  sql[kHistory] = "SELECT " + entry + ", sequence";
  sql[kLatest] = "SELECT " + entry + " DESC, sequence DESC LIMIT 1";
  return sql;
}

bool stays_inside(const std::string& file) {
  const std::filesystem::path path(file);
  if (file.empty() || path.has_root_path() || !path.has_filename()) return false;
  return std::none_of(path.begin(), path.end(), [](const auto& part) { return part == ".." || part == "."; });
}

}  // namespace

struct ObjectStore::Database {
  struct Attribute {
    std::int64_t id;
    std::int64_t capacity;
  };

  SqliteFile file;

  explicit Database(const std::filesystem::path& path) : file(path, schema(), statements()) {}
  [[nodiscard]] SqliteUse use(Query query) const { return file.use(query); }
  [[nodiscard]] std::optional<Attribute> attribute(ObjectId object, const std::string& name) const;
  void trim(std::int64_t attribute, std::int64_t capacity) const;
};

namespace {

void bind_object(SqliteUse& use, const MapObject& o, const std::string& file) {
  if (!o.p_W.allFinite() || !o.covariance.allFinite()) {
    throw Error(fmt::format("the position of object \"{}\" is not finite", o.name), {file});
  }
  use.with(std::int64_t{o.capabilities}).with(o.kind).with(o.name);
  for (int i = 0; i < 3; ++i) use.with(o.p_W[i]);
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) use.with(o.covariance(i, j));
  }
}

MapObject object_of(SqliteUse& use) {
  MapObject o;
  o.id = use.integer();
  o.capabilities = static_cast<std::uint32_t>(use.integer());
  o.kind = use.text();
  o.name = use.text();
  for (int i = 0; i < 3; ++i) o.p_W[i] = use.finite("a position");
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) o.covariance(i, j) = o.covariance(j, i) = use.finite("a covariance");
  }
  return o;
}

struct Columns {
  double number = 0;
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  std::string text;
  std::int64_t holes = 0;
};

Columns columns_of(const AttributeValue& value, const std::string& file) {
  Columns c;
  if (const auto* number = std::get_if<double>(&value)) c.number = *number;
  if (const auto* vector = std::get_if<Eigen::Vector3d>(&value)) c.vector = *vector;
  if (const auto* text = std::get_if<std::string>(&value)) c.text = *text;
  if (const auto* shape = std::get_if<ShapeReference>(&value)) {
    c = {shape->volume_m3, shape->centroid, shape->file, shape->holes};
    if (!stays_inside(shape->file)) {
      throw Error(fmt::format("the shape file \"{}\" is outside the map's folder", shape->file), {file},
                  "a relative path without ..");
    }
  }
  if (c.text.size() > kLongestText) {
    throw Error(fmt::format("an attribute of {} bytes", c.text.size()), {file}, fmt::format("0 .. {}", kLongestText));
  }
  if (!std::isfinite(c.number) || !c.vector.allFinite()) throw Error("an attribute is not finite", {file});
  return c;
}

AttributeEntry entry_of(SqliteUse& use, const std::string& file) {
  AttributeEntry entry;
  entry.time = Time(Duration(use.integer()));
  const auto kind = use.integer();
  const double number = use.finite("an attribute");
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = use.finite("an attribute");
  std::string text = use.text();
  const auto holes = static_cast<std::int32_t>(use.integer());
  switch (kind) {
    case 0: entry.value = number; break;
    case 1: entry.value = v; break;
    case 2: entry.value = std::move(text); break;
    default:
      if (!stays_inside(text)) throw Error(fmt::format("the shape file \"{}\" is outside the folder", text), {file});
      entry.value = ShapeReference{std::move(text), number, v, holes};
  }
  return entry;
}

}  // namespace

/// Keeps the newest `capacity` entries and deletes older ones.
void ObjectStore::Database::trim(std::int64_t attribute, std::int64_t capacity) const {
  use(kTrim).with(attribute).with(capacity).run();
}

/// For an object that exists; a new attribute keeps `kEntries` entries.
std::optional<ObjectStore::Database::Attribute> ObjectStore::Database::attribute(ObjectId object,
                                                                                 const std::string& name) const {
  use(kMakeAttribute).with(name).with(std::int64_t{kEntries}).with(object).run();
  SqliteUse found = use(kAttribute);
  found.with(object).with(name);
  if (!found.step()) return std::nullopt;
  const std::int64_t id = found.integer();
  return Attribute{id, found.integer()};
}

ObjectStore::ObjectStore(const std::filesystem::path& file) : database_(std::make_unique<Database>(file)) {}
ObjectStore::ObjectStore(ObjectStore&&) noexcept = default;
ObjectStore& ObjectStore::operator=(ObjectStore&&) noexcept = default;
ObjectStore::~ObjectStore() = default;

ObjectStore::Transaction::Transaction(ObjectStore& store) : store_(store) {
  ISOBATH_ASSERT(!store_.database_->file.in_transaction());
  store_.database_->file.begin();
}

ObjectStore::Transaction::~Transaction() {
  if (open_) store_.database_->file.roll_back();
}

void ObjectStore::Transaction::commit() {
  ISOBATH_ASSERT(open_);
  store_.database_->file.commit();
  open_ = false;
}

ObjectId ObjectStore::create(const MapObject& object) {
  SqliteUse use = database_->use(kCreate);
  bind_object(use, object, database_->file.name());
  use.step();
  const ObjectId id = use.integer();
  use.run();
  return id;
}

bool ObjectStore::update(const MapObject& object) {
  SqliteUse use = database_->use(kUpdate);
  bind_object(use, object, database_->file.name());
  use.with(object.id).run();
  return database_->file.changed();
}

bool ObjectStore::put(ObjectId id, const std::string& attribute, const AttributeEntry& entry) {
  const Columns c = columns_of(entry.value, database_->file.name());
  std::optional<Transaction> own;
  if (!database_->file.in_transaction()) own.emplace(*this);
  const auto found = database_->attribute(id, attribute);
  if (!found) return false;
  std::int64_t sequence = 0;
  {
    SqliteUse count = database_->use(kCountUp);
    count.with(found->id).step();
    sequence = count.integer();
    count.run();
  }
  {
    SqliteUse use = database_->use(kPut);
    use.with(found->id).with(std::int64_t{entry.time.time_since_epoch().count()}).with(sequence);
    use.with(static_cast<std::int64_t>(entry.value.index())).with(c.number);
    for (int i = 0; i < 3; ++i) use.with(c.vector[i]);
    use.with(c.text).with(c.holes).run();
  }
  database_->trim(found->id, found->capacity);
  if (own) own->commit();
  return true;
}

std::optional<MapObject> ObjectStore::find(ObjectId id) const {
  SqliteUse use = database_->use(kFind);
  if (!use.with(id).step()) return std::nullopt;
  return object_of(use);
}

std::vector<MapObject> ObjectStore::find(std::span<const ObjectId> ids) const {
  std::vector<MapObject> objects;
  objects.reserve(ids.size());
  for (const ObjectId id : ids) {
    if (auto object = find(id)) objects.push_back(std::move(*object));
  }
  return objects;
}

std::vector<ObjectId> ObjectStore::with_any(std::uint32_t mask) const {
  SqliteUse use = database_->use(kWithAny);
  use.with(std::int64_t{mask});
  std::vector<ObjectId> ids;
  while (use.step()) ids.push_back(use.integer());
  return ids;
}

std::vector<std::string> ObjectStore::attributes(ObjectId id) const {
  SqliteUse use = database_->use(kAttributes);
  use.with(id);
  std::vector<std::string> names;
  while (use.step()) names.push_back(use.text());
  return names;
}

std::vector<AttributeEntry> ObjectStore::history(ObjectId id, const std::string& attribute) const {
  SqliteUse use = database_->use(kHistory);
  use.with(id).with(attribute);
  std::vector<AttributeEntry> entries;
  while (use.step()) entries.push_back(entry_of(use, database_->file.name()));
  return entries;
}

std::optional<AttributeEntry> ObjectStore::latest(ObjectId id, const std::string& attribute) const {
  SqliteUse use = database_->use(kLatest);
  if (!use.with(id).with(attribute).step()) return std::nullopt;
  return entry_of(use, database_->file.name());
}

}  // namespace isobath
