// Objects, their attributes and their histories: kept across closing, crashes and damage.
#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/map/features/object_store.hpp>
#include <map>
#include <rapidcheck/gtest.h>
#include <sys/wait.h>
#include <tests/support/data.hpp>
#include <unistd.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Vector3 = Eigen::Vector3d;

Time at(double s) { return Time{seconds(s)}; }

MapObject rock(double north, double east, std::uint32_t capabilities = 1, const std::string& name = "rock") {
  MapObject o;
  o.capabilities = capabilities;
  o.kind = "rock";
  o.name = name;
  o.p_W = {north, east, 7.25};
  o.covariance << 4, 1, 0.5, 1, 3, 0.25, 0.5, 0.25, 2;
  return o;
}

std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

// ledger: S1-07
TEST(ObjectStore, ARecordReadsBackAfterClosing) {
  const fs::path file = test::scratch_folder() / "objects.sqlite";
  const MapObject written = rock(12.5, -3, 0x80000001U, "Böhme's \"rock\"; DROP TABLE object");
  ObjectId id = 0;
  {
    ObjectStore store(file);
    id = store.create(written);
  }
  const auto read = ObjectStore(file).find(id);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->id, id);
  EXPECT_EQ(read->capabilities, 0x80000001U);
  EXPECT_EQ(read->kind, written.kind);
  EXPECT_EQ(read->name, written.name);
  EXPECT_EQ(read->p_W, written.p_W);
  EXPECT_EQ(read->covariance, written.covariance);
}

// ledger: S1-07
TEST(ObjectStore, CreatesAndUpdatesWithoutGivingAnIdTwice) {
  const fs::path file = test::scratch_folder() / "objects.sqlite";
  MapObject o = rock(1, 2);
  {
    ObjectStore store(file);
    o.id = store.create(o);
    o.p_W.x() = 5;
    EXPECT_TRUE(store.update(o));
    EXPECT_EQ(store.find(o.id)->p_W.x(), 5);
  }
  ObjectStore store(file);
  EXPECT_GT(store.create(rock(0, 0)), o.id);
  EXPECT_EQ(store.find(o.id)->p_W.x(), 5);
  o.id += 100;  // there is none
  EXPECT_FALSE(store.update(o));
  EXPECT_FALSE(store.put(o.id, "colour", {at(2), 1.0}));
  EXPECT_EQ(store.find(o.id), std::nullopt);
  EXPECT_THAT(store.history(o.id, "colour"), IsEmpty());
}

// Against a plain search, with the first and the last bit. ledger: S1-07
TEST(ObjectStore, MaskQueriesGiveExactlyTheMatchingObjects) {
  const fs::path file = test::scratch_folder() / "objects.sqlite";
  std::map<ObjectId, std::uint32_t> all;
  Random random(7);
  {
    ObjectStore store(file);
    ObjectStore::Transaction changes(store);
    for (int i = 0; i < 300; ++i) {
      const auto bits = static_cast<std::uint32_t>(random.bits() & random.bits());
      all[store.create(rock(i, i, bits))] = bits;
    }
    changes.commit();
  }
  const ObjectStore store(file);
  for (const std::uint32_t mask : {1U, 1U << 31, 0x80000001U, 0xffffffffU, 0U, 0x00ff0000U, 6U}) {
    std::vector<ObjectId> with_any;
    for (const auto& [id, bits] : all) {
      if ((bits & mask) != 0) with_any.push_back(id);
    }
    EXPECT_EQ(store.with_any(mask), with_any) << mask;
  }
}

// ledger: S1-08
TEST(ObjectStore, AFullHistoryHoldsTheNewestInOrder) {
  ObjectStore store(test::scratch_folder() / "objects.sqlite");
  const ObjectId id = store.create(rock(0, 0));
  ObjectStore::Transaction changes(store);
  for (int i = 0; i < ObjectStore::kEntries + 3; ++i) ASSERT_TRUE(store.put(id, "height", {at(i), 0.5 * i}));
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(store.put(id, "short", {at(i), 0.5 * i}));
  changes.commit();
  const auto full = store.history(id, "height");
  ASSERT_EQ(full.size(), 16u);
  for (std::size_t i = 0; i < full.size(); ++i) {
    EXPECT_EQ(full[i].time, at(3.0 + static_cast<double>(i)));
    EXPECT_EQ(std::get<double>(full[i].value), 0.5 * (3.0 + static_cast<double>(i)));
  }
  EXPECT_EQ(store.history(id, "short").size(), 5u);
  EXPECT_EQ(store.latest(id, "height")->time, at(18));
  EXPECT_EQ(store.latest(id, "short")->time, at(4));
  EXPECT_EQ(store.latest(id, "nothing"), std::nullopt);
  EXPECT_THAT(store.attributes(id), ElementsAre("height", "short"));
}

// Whatever the order of coming, the ring is the newest N of all by (time, order of coming). ledger: S1-08
RC_GTEST_PROP(ObjectStoreProperty, HistoryIsTheNewestByTime, ()) {
  const auto count = *rc::gen::inRange<std::size_t>(10, 30);
  const auto times = *rc::gen::container<std::vector<int>>(count, rc::gen::inRange(-10, 10));
  static ObjectStore store(test::scratch_folder() / "objects.sqlite");
  ObjectStore::Transaction changes(store);  // undone at the end
  const ObjectId id = store.create(rock(0, 0));
  std::vector<std::pair<int, int>> model;
  for (std::size_t i = 0; i < times.size(); ++i) {
    store.put(id, "a", {at(times[i]), static_cast<double>(i)});
    model.emplace_back(times[i], static_cast<int>(i));
    std::sort(model.begin(), model.end());
    if (model.size() > ObjectStore::kEntries) model.erase(model.begin());
  }
  std::vector<std::pair<int, int>> read;
  for (const AttributeEntry& e : store.history(id, "a")) {
    read.emplace_back(static_cast<int>(to_seconds(e.time)), static_cast<int>(std::get<double>(e.value)));
  }
  RC_ASSERT(read == model);
}

// ledger: S1-09
TEST(ObjectStore, AnyTypeOfValueIsKept) {
  const fs::path file = test::scratch_folder() / "objects.sqlite";
  const ShapeReference mesh{"shapes/arch.ply", 12.5, {1, 2, 3}, 1};
  const std::vector<AttributeValue> values = {0.1, Vector3(1, -2, 1e-300), std::string("a\0b", 3), mesh};
  ObjectId id = 0;
  {
    ObjectStore store(file);
    id = store.create(rock(0, 0));
    for (std::size_t i = 0; i < values.size(); ++i) store.put(id, "any", {at(static_cast<double>(i)), values[i]});
  }
  const auto read = ObjectStore(file).history(id, "any");
  ASSERT_EQ(read.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(read[i].value, values[i]);
}

TEST(ObjectStore, RefusesWhatIsNotFiniteOrStandsOutsideTheFolder) {
  ObjectStore store(test::scratch_folder() / "objects.sqlite");
  const ObjectId id = store.create(rock(0, 0));
  EXPECT_THROW(store.create(rock(NAN, 0)), Error);
  EXPECT_THROW(store.put(id, "a", {at(0), INFINITY}), Error);
  EXPECT_THROW(store.put(id, "a", {at(0), std::string(2 << 20, 'x')}), Error);
  for (const char* outside : {"", "/etc/passwd", "../arch.ply", "shapes/../../arch.ply", "shapes/"}) {
    EXPECT_THROW(store.put(id, "a", {at(0), ShapeReference{outside, 0, {0, 0, 0}, 0}}), Error) << outside;
  }
  EXPECT_THAT(store.attributes(id), IsEmpty());
}

TEST(ObjectStore, ATransactionIsAllOrNothing) {
  ObjectStore store(test::scratch_folder() / "objects.sqlite");
  const ObjectId kept = store.create(rock(0, 0));
  {
    ObjectStore::Transaction changes(store);
    store.create(rock(1, 1));
    store.put(kept, "a", {at(0), 1.0});
  }
  EXPECT_THAT(store.with_any(~0U), ElementsAre(kept));
  EXPECT_EQ(store.latest(kept, "a"), std::nullopt);
}

// The file and its journal as they stand when the power fails, at every change of a transaction that is larger than
// the page cache.
TEST(ObjectStore, APowerCutLeavesTheLastCommit) {
  const fs::path folder = test::scratch_folder();
  const fs::path file = folder / "objects.sqlite";
  ObjectStore store(file);
  const ObjectId id = store.create(rock(0, 0));
  store.put(id, "note", {at(0), std::string("committed")});
  ObjectStore::Transaction changes(store);
  int journals = 0;
  for (int i = 0; i < 6; ++i) {
    store.put(id, "note", {at(i), std::string(900'000, 'x')});
    const fs::path copy = folder / ("cut" + std::to_string(i));
    fs::copy_file(file, copy);
    if (fs::exists(file.string() + "-journal")) {
      journals += fs::file_size(file) > 100'000;  // pages of the unfinished transaction are in the file already
      fs::copy_file(file.string() + "-journal", copy.string() + "-journal");
    }
    const ObjectStore after(copy);
    ASSERT_EQ(after.history(id, "note").size(), 1u) << i;
    EXPECT_EQ(std::get<std::string>(after.latest(id, "note")->value), "committed");
  }
  EXPECT_GT(journals, 1);
}

TEST(ObjectStore, AKilledProgramLeavesTheLastCommit) {
  const fs::path file = test::scratch_folder() / "objects.sqlite";
  { const ObjectStore made(file); }
  const pid_t child = fork();
  if (child == 0) {
    ObjectStore store(file);
    store.create(rock(1, 1));
    ObjectStore::Transaction changes(store);
    for (int i = 0; i < 20; ++i) store.create(rock(i, i));
    _exit(0);  // no destructor runs
  }
  int status = 1;
  waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
  EXPECT_EQ(ObjectStore(file).with_any(~0U).size(), 1u);
}

TEST(ObjectStore, IsOneProgramsAtATime) {
  const fs::path file = test::scratch_folder() / "objects.sqlite";
  const ObjectStore first(file);
  EXPECT_THAT(error_of([&] { ObjectStore second(file); }), HasSubstr("close that first"));
}

/// Bytes 60..63 of an SQLite file: the user version; 68..71: the application id (sqlite.org/fileformat).
void overwrite(const fs::path& file, std::streamoff offset, const std::string& bytes) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(offset);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

TEST(ObjectStore, RefusesFilesThatAreNotItsOwnAndLeavesThemAlone) {
  const fs::path folder = test::scratch_folder();
  const fs::path file = folder / "objects.sqlite";
  { ObjectStore(file).create(rock(0, 0)); }
  const auto damaged = [&](std::streamoff offset, const std::string& bytes) {
    const fs::path copy = folder / "copy";
    fs::copy_file(file, copy, fs::copy_options::overwrite_existing);
    overwrite(copy, offset, bytes);
    return error_of([&] { ObjectStore store(copy); });
  };
  EXPECT_THAT(damaged(60, {"\0\0\0\2", 4}), HasSubstr("copy: has schema version 2; allowed: 1; read it with"));
  EXPECT_THAT(damaged(68, "abcd"), HasSubstr("copy: is a database, but not of the object store"));
  EXPECT_THAT(damaged(0, "SQLite format 4"), HasSubstr("file is not a database"));

  const fs::path text = folder / "notes.txt";
  const std::string notes(5000, 'n');
  std::ofstream(text) << notes;
  EXPECT_THAT(error_of([&] { ObjectStore store(text); }), HasSubstr("file is not a database"));
  std::ifstream stream(text);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), notes);
  EXPECT_THAT(error_of([&] { ObjectStore store(folder); }), HasSubstr("cannot be opened"));
}

// A word of the schema is enough: here the guard on capabilities, 4294967295, becomes 9294967295.
TEST(ObjectStore, RefusesAnotherSchema) {
  const fs::path file = test::scratch_folder() / "objects.sqlite";
  { const ObjectStore store(file); }
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  const auto place = bytes.find("4294967295");
  ASSERT_NE(place, std::string::npos);
  overwrite(file, static_cast<std::streamoff>(place), "9");
  EXPECT_THAT(error_of([&] { ObjectStore store(file); }), HasSubstr("tables that do not belong to the object store"));
}

// The index of places does not agree with the table.
TEST(ObjectStore, RefusesAnIndexThatDisagreesWithItsTable) {
  const fs::path file = test::scratch_folder() / "objects.sqlite";
  {
    ObjectStore store(file);
    for (int i = 1; i < 9; ++i) store.create(rock(1024.5 * i, 3));
  }
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  // 5122.5 as a big-endian double stands in the table and in the index; moved to 5123.5 in one of them.
  const std::string north("\x40\xb4\x02\x80", 4);
  const auto place = bytes.rfind(north);
  ASSERT_NE(place, bytes.find(north));
  overwrite(file, static_cast<std::streamoff>(place), std::string("\x40\xb4\x03\x80", 4));
  EXPECT_THAT(error_of([&] { ObjectStore store(file); }), HasSubstr("is damaged: "));
}

// Opens and reads all, or throws Error: nothing else.
TEST(ObjectStore, DamageIsAnErrorOrHarmless) {
  const fs::path folder = test::scratch_folder();
  const fs::path file = folder / "objects.sqlite";
  {
    ObjectStore store(file);
    ObjectStore::Transaction changes(store);
    for (int i = 0; i < 30; ++i) {
      const ObjectId id = store.create(rock(i, i));
      for (int k = 0; k < 4; ++k) store.put(id, "place", {at(k), Vector3(1, 2, 3)});
      store.put(id, "shape", {at(0), ShapeReference{"a.ply", 1, {0, 0, 0}, 2}});
    }
    changes.commit();
  }
  const auto size = static_cast<std::uint64_t>(fs::file_size(file));
  Random random(3);
  int refused = 0, read = 0;
  std::size_t records = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const fs::path copy = folder / "copy";
    fs::remove(copy.string() + "-journal");
    fs::copy_file(file, copy, fs::copy_options::overwrite_existing);
    for (int k = 0; k <= trial % 6; ++k) {
      overwrite(copy, static_cast<std::streamoff>(random.index(size)), {static_cast<char>(random.bits() & 255)});
    }
    if (trial % 8 == 0) fs::resize_file(copy, random.index(size));
    try {
      const ObjectStore store(copy);
      for (const ObjectId id : store.with_any(~0U)) {
        EXPECT_TRUE(store.find(id));
        ++records;
        for (const std::string& name : store.attributes(id)) records += store.history(id, name).size();
      }
      ++read;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), Not(HasSubstr("\n")));
      ++refused;
    }
  }
  EXPECT_GT(refused, 10);
  EXPECT_GT(read, 2);
  EXPECT_GT(records, 100u);
}

}  // namespace
}  // namespace isobath
