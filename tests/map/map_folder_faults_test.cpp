// What a stored map keeps, whatever fails: every call of the system in turn, the program at every call, files that are
// damaged, exchanged, newer than the program, or links.
#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <functional>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/map/storage/disk_file.hpp>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/wait.h>
#include <tests/support/tree_file_bytes.hpp>
#include <unistd.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Contents = std::map<std::string, std::string>;

constexpr int kSmallLevels = 6;

MapFacts small_facts() {
  MapFacts facts;
  facts.area = {{{16, -16}, 0.5}, kSmallLevels};
  facts.epoch = Time(std::chrono::hours(24));
  facts.datum = "water surface";
  return facts;
}

/// A map whose depth tells its generation.
DepthTrees small_trees(std::uint64_t generation) {
  RegionQuadtree sensed(kSmallLevels, 0), state(kSmallLevels, 0);
  for (int i = 0; i < 64; ++i) {
    sensed.fill({i, i, 1, 1}, DepthPixel::word_of_depth(static_cast<double>(generation) + 0.01 * i));
    state.fill({i, i, 1, 1}, DepthPixel::word_of_state(i % 21, kSensed, static_cast<std::uint32_t>(generation)));
  }
  return {RegionQuadtree(kSmallLevels, DepthPixel::word_of_depth(30)), sensed, state};
}

std::string bytes_in(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void put_bytes(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

Contents contents_of(const fs::path& folder) {
  Contents contents;
  for (const auto& entry : fs::directory_iterator(folder)) {
    contents[entry.path().filename().string()] = bytes_in(entry.path());
  }
  return contents;
}

/// Makes the call of this number fail, from 0; counts all.
struct NthCall {
  int number = 0;
  int code = EIO;
  int calls = 0;
  bool met = false;

  void watch() {
    set_disk_fault([this](DiskCall, const fs::path&) {
      const bool now = calls++ == number;
      met = met || now;
      return now ? code : 0;
    });
  }
};

class StoredMapFaults : public testing::Test {
 protected:
  StoredMapFaults() : folder_(fs::temp_directory_path() / ("isobath_faults_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
  }
  ~StoredMapFaults() override {
    set_disk_fault({});
    fs::remove_all(folder_);
  }

  void commit(std::uint64_t generation) const {
    MapFolder folder(folder_);
    MapFacts facts = folder.holds_map() ? folder.open().facts : small_facts();
    folder.commit(facts, small_trees(generation));
  }
  /// Changes the record, and makes its checksum right.
  void rewrite(const char* name, const std::function<void(nlohmann::ordered_json&)>& change) const {
    auto whole = nlohmann::ordered_json::parse(bytes_in(folder_ / name));
    change(whole["isobath_map"]);
    const std::string body = whole["isobath_map"].dump();
    const test::TreeFileBytes bytes{{body.begin(), body.end()}};
    whole["crc32"] = bytes.crc(0, body.size());
    put_bytes(folder_ / name, whole.dump(1) + "\n");
  }
  void expect_state(std::uint64_t generation, const std::string& when) const {
    const StoredMap map = open_map(folder_);
    ASSERT_TRUE(map.damages.empty()) << when << ": " << to_text(map.damages.front());
    ASSERT_EQ(map.facts.generation, generation) << when;
    EXPECT_TRUE(map.trees.sensed() == small_trees(generation).sensed()) << when;
    EXPECT_TRUE(map.trees.state() == small_trees(generation).state()) << when;
    EXPECT_TRUE(map.trees.prior() == small_trees(1).prior()) << when;
  }
  std::string refusal(const std::function<void()>& doing) const {
    try {
      doing();
    } catch (const Error& e) {
      return e.what();
    }
    return "no refusal";
  }
  void expect_untouched(const std::string& reason) const {
    const Contents before = contents_of(folder_);
    EXPECT_THAT(refusal([&] { commit(9); }), HasSubstr(reason));
    EXPECT_TRUE(contents_of(folder_) == before) << "nothing was written or removed: " << reason;
  }

  fs::path folder_;
};

// Calls that fail -----------------------------------------------------------------------------------------------------

// ledger: S1-26
TEST_F(StoredMapFaults, EachCallOfACommitFailsOnceAndTheMapIsOfThisStateOrTheOneBefore) {
  commit(1);
  std::uint64_t generation = 1;
  int refused = 0;
  constexpr std::array<int, 3> kCodes{EIO, ENOSPC, EACCES};
  for (int n = 0;; ++n) {
    NthCall fault{n, kCodes[static_cast<std::size_t>(n) % kCodes.size()]};
    {
      MapFolder folder(folder_);
      MapFacts facts = folder.open().facts;
      fault.watch();
      try {
        folder.commit(facts, small_trees(generation + 1));
      } catch (const Error&) {
        ++refused;
      }
      set_disk_fault({});
    }
    const std::string when = "call " + std::to_string(n);
    const std::uint64_t found = open_map(folder_).facts.generation;
    ASSERT_TRUE(found == generation || found == generation + 1) << when;
    expect_state(found, when);
    generation = found;
    if (!fault.met) break;
  }
  EXPECT_GT(refused, 20);
  commit(generation + 1);
  expect_state(generation + 1, "at last");
  EXPECT_EQ(contents_of(folder_).size(), 6U) << "two records, three trees, the lock";
}

// ledger: S1-26
TEST_F(StoredMapFaults, EachCallOfOpeningFailsOnceAndNoMapIsContinuedWithoutATree) {
  commit(1);
  const Contents before = contents_of(folder_);
  for (const int code : {EIO, EMFILE, EACCES, ENOMEM}) {
    int refused = 0;
    for (int n = 0;; ++n) {
      NthCall fault{n, code};
      fault.watch();
      try {
        MapFolder folder(folder_);
        EXPECT_TRUE(folder.open().damages.empty()) << "call " << n;
        EXPECT_FALSE(fault.met) << "call " << n << " failed, and this was not said";
      } catch (const Error&) {
        ++refused;
      }
      set_disk_fault({});
      ASSERT_TRUE(contents_of(folder_) == before) << "call " << n;
      if (!fault.met) break;
    }
    EXPECT_GT(refused, 8);
  }
  expect_state(1, "at last");
}

TEST_F(StoredMapFaults, ATreeThatCannotBeMappedIsRefused) {
  constexpr int kLargeLevels = 10;
  std::vector<std::uint32_t> depths(1U << (2 * kLargeLevels));
  for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = DepthPixel::kDepthOffset + static_cast<std::uint32_t>(i);
  MapFacts facts = small_facts();
  facts.area.levels = kLargeLevels;
  const RegionQuadtree none(kLargeLevels);
  MapFolder folder(folder_);
  folder.commit(facts, DepthTrees(none, RegionQuadtree::from_raster(kLargeLevels, depths, 1024, 1024, 0), none));
  set_disk_fault([](DiskCall call, const fs::path&) { return call == DiskCall::kMap ? ENOMEM : 0; });
  EXPECT_THAT(refusal([&] { (void)folder.open(); }), HasSubstr("cannot be mapped"));
}

// The program that ends
// ------------------------------------------------------------------------------------------------

// ledger: S1-26
TEST_F(StoredMapFaults, KilledAtEachCallOfACommitTheMapIsOfThisStateOrTheOneBefore) {
  std::uint64_t generation = 0;
  for (const std::uint64_t first : {0U, 1U}) {  // of a new map, and of one that is continued
    if (first == 1 && generation == 0) commit(generation = 1);
    for (int n = 0;; ++n) {
      if (first == 0) fs::remove_all(folder_), generation = 0;
      const pid_t child = ::fork();
      if (child == 0) {
        int calls = 0;
        set_disk_fault([&](DiskCall, const fs::path&) { return calls++ == n ? ::raise(SIGKILL) : 0; });
        try {
          commit(generation + 1);
        } catch (...) {
          ::_exit(1);
        }
        ::_exit(0);
      }
      int status = 0;
      ASSERT_EQ(::waitpid(child, &status, 0), child);
      ASSERT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
      const std::string when = "call " + std::to_string(n) + " after state " + std::to_string(generation);
      if (looks_like_map(folder_)) {
        const std::uint64_t found = open_map(folder_).facts.generation;
        ASSERT_TRUE(found == generation || found == generation + 1) << when;
        expect_state(found, when);
        generation = found;
      } else {
        ASSERT_EQ(generation, 0U) << when;
        commit(1);
        expect_state(1, when);
      }
      if (WIFEXITED(status)) {
        EXPECT_GT(n, 20);
        break;
      }
    }
  }
}

TEST_F(StoredMapFaults, AReaderThatMeetsACommitReadsACommittedState) {
  commit(1);
  bool met = false;
  set_disk_fault([&](DiskCall call, const fs::path& file) {
    if (!met && call == DiskCall::kOpen && file.filename() == "sensed.1.tree") {
      met = true;
      commit(2);
    }
    return 0;
  });
  expect_state(2, "while it was read");
  EXPECT_TRUE(met);
}

TEST_F(StoredMapFaults, AFirstRunThatFailsLeavesNoFolder) {
  { const MapFolder folder(folder_); }
  EXPECT_FALSE(fs::exists(folder_));
  set_disk_fault([](DiskCall call, const fs::path&) { return call == DiskCall::kFlush ? ENOSPC : 0; });
  EXPECT_NE(refusal([&] { commit(1); }), "no refusal");
  EXPECT_FALSE(fs::exists(folder_));
  set_disk_fault([](DiskCall call, const fs::path& file) {
    return call == DiskCall::kRename && file.filename() == "map.json.part" ? EIO : 0;
  });
  EXPECT_NE(refusal([&] { commit(1); }), "no refusal");
  EXPECT_FALSE(fs::exists(folder_));
  fs::create_directory(folder_);
  { const MapFolder folder(folder_); }
  EXPECT_TRUE(fs::exists(folder_)) << "it was there before";
}

// Files that are not those of the map
// ------------------------------------------------------------------------------------

TEST_F(StoredMapFaults, ATreeUnderTheNameOfAnotherIsNoticedAndTheMapIsNotWrittenTo) {
  commit(1);
  fs::copy_file(folder_ / "sensed.1.tree", folder_ / "state.1.tree", fs::copy_options::overwrite_existing);
  const StoredMap map = open_map(folder_);
  ASSERT_EQ(map.damages.size(), 1U);
  EXPECT_THAT(to_text(map.damages[0]), HasSubstr("not the file that was committed"));
  EXPECT_TRUE(map.damages[0].whole_file);
  expect_untouched("cannot be read whole");
}

TEST_F(StoredMapFaults, ATreeOfAnotherMapOrGenerationIsNoticedAndTheMapIsNotWrittenTo) {
  const fs::path other = folder_.string() + "_other";
  fs::remove_all(other);
  {
    MapFacts facts = small_facts();
    MapFolder(other).commit(facts, small_trees(5));
  }
  commit(1);
  const std::string before = bytes_in(folder_ / "sensed.1.tree");
  put_bytes(folder_ / "sensed.1.tree", bytes_in(other / "sensed.1.tree"));
  fs::remove_all(other);
  expect_untouched("not the file that was committed");
  put_bytes(folder_ / "sensed.1.tree", before);
  commit(2);
  put_bytes(folder_ / "sensed.2.tree", before);
  expect_untouched("another generation, 1");
}

TEST_F(StoredMapFaults, AMapOfWhichATreeIsMissingIsNotWrittenTo) {
  commit(1);
  fs::remove(folder_ / "state.1.tree");
  expect_untouched("state.1.tree");
}

TEST_F(StoredMapFaults, AFileWithADamagedBlockStaysBesideItsSuccessor) {
  commit(1);
  std::string bytes = bytes_in(folder_ / "sensed.1.tree");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  put_bytes(folder_ / "sensed.1.tree", bytes);
  commit(2);
  expect_state(2, "healed");
  EXPECT_EQ(bytes_in(folder_ / "sensed.1.tree.damaged"), bytes);
  EXPECT_FALSE(fs::exists(folder_ / "sensed.1.tree"));
}

TEST_F(StoredMapFaults, AMapOfAnEarlierVersionOfTheProgramHasNoSealsAndIsContinued) {
  commit(1);
  for (const char* name : {"map.json", "map.json.copy"}) rewrite(name, [](auto& map) { map.erase("seals"); });
  expect_state(1, "without seals");
  const std::string state = bytes_in(folder_ / "state.1.tree");
  put_bytes(folder_ / "state.1.tree", bytes_in(folder_ / "sensed.1.tree"));
  const StoredMap map = open_map(folder_);
  ASSERT_FALSE(map.damages.empty());
  EXPECT_THAT(to_text(map.damages[0]), HasSubstr("a confidence is above 20"));
  put_bytes(folder_ / "state.1.tree", state);
  commit(2);
  expect_state(2, "continued");
}

// Records
// ---------------------------------------------------------------------------------------------------------------

TEST_F(StoredMapFaults, ADamagedCopyOfTheRecordIsNoticed) {
  commit(1);
  commit(2);
  const std::string copy = bytes_in(folder_ / "map.json.copy");
  for (const std::string& damaged : {std::string(), copy.substr(0, 40), std::string("absent")}) {
    if (damaged == "absent") {
      fs::remove(folder_ / "map.json.copy");
    } else {
      put_bytes(folder_ / "map.json.copy", damaged);
    }
    const StoredMap map = open_map(folder_);
    EXPECT_EQ(map.facts.generation, 2U);
    ASSERT_EQ(map.damages.size(), 1U) << damaged;
    EXPECT_EQ(map.damages[0].file, "map.json.copy");
  }
  put_bytes(folder_ / "map.json.copy", copy);
  rewrite("map.json.copy", [](auto& map) { map["datum"] = "LAT"; });
  EXPECT_THAT(to_text(open_map(folder_).damages.at(0)), HasSubstr("differs from map.json"));
  commit(3);
  expect_state(3, "and the next commit replaces it");
}

TEST_F(StoredMapFaults, ANewerMapBesideAnOldCopyIsNotOverwritten) {
  commit(1);
  const std::string old = bytes_in(folder_ / "map.json.copy");
  commit(2);
  const std::string record = bytes_in(folder_ / "map.json");
  put_bytes(folder_ / "map.json.copy", old);
  rewrite("map.json", [](auto& map) { map["version"] = 2; });
  EXPECT_THAT(refusal([&] { open_map(folder_); }), HasSubstr("version 2"));
  expect_untouched("version 2");
  put_bytes(folder_ / "map.json", record.substr(0, record.size() / 2));
  expect_untouched("a newer state of the map may be lost");
  fs::remove(folder_ / "map.json");
  expect_untouched("a newer state of the map may be lost");
  fs::remove(folder_ / "map.json.copy");
  expect_untouched("commit record is lost");
}

TEST_F(StoredMapFaults, ValuesOfARecordThatNoMapHasAreRefused) {
  commit(1);
  const Contents before = contents_of(folder_);
  const auto refused = [&](const char* key, const nlohmann::ordered_json& value) {
    rewrite("map.json", [&](auto& map) { map[key] = value; });
    EXPECT_THAT(refusal([&] { open_map(folder_); }), HasSubstr("commit record")) << key << value;
    expect_untouched("commit record");
    put_bytes(folder_ / "map.json", before.at("map.json"));
  };
  refused("generation", UINT64_MAX);
  refused("generation", 0);
  refused("generation", -1);
  refused("levels", 24);
  refused("levels", 1e300);
  refused("pixel_m", 1e-300);
  refused("pixel_m", nullptr);
  refused("north_west_corner_m", {1e300, 0});
  refused("epoch_ns", INT64_MIN);
  refused("files", {{"prior", "../a"}, {"sensed", "sensed.1.tree"}, {"state", "state.1.tree"}});
  refused("files", {{"prior", "prior.1.tree"}, {"sensed", "prior.1.tree"}, {"state", "state.1.tree"}});
  refused("files", {{"prior", "prior.1.tree"}});
  refused("visits",
          {{{"input", "a"}, {"first_ns", 1.5}, {"last_ns", 0}, {"counts", nlohmann::ordered_json::object()}}});
  rewrite("map.json", [](auto& map) { map["datum"] = nullptr; });
  expect_untouched("commit record is incomplete");
  put_bytes(folder_ / "map.json", std::string(100000, '[') + std::string(100000, ']'));
  EXPECT_EQ(open_map(folder_).damages.size(), 1U) << "deeper than any record; the copy is read";
}

// Links
// -----------------------------------------------------------------------------------------------------------------

TEST_F(StoredMapFaults, ALinkInTheFolderIsNotFollowedWhenWriting) {
  const fs::path letters = folder_.string() + "_letters";
  put_bytes(letters, "Dear captain,\n");
  commit(1);
  for (const char* name : {"sensed.2.tree.part", "map.json.part", "map.json.copy", "objects.sqlite", "lock"}) {
    const Contents before = contents_of(folder_);
    fs::remove(folder_ / name);
    fs::create_symlink(letters, folder_ / name);
    EXPECT_THAT(refusal([&] { commit(2); }), HasSubstr("is a link")) << name;
    EXPECT_EQ(bytes_in(letters), "Dear captain,\n") << name;
    fs::remove(folder_ / name);
    if (before.contains(name)) put_bytes(folder_ / name, before.at(name));
  }
  fs::create_hard_link(letters, folder_ / "sensed.2.tree.part");
  commit(2);
  expect_state(2, "beside a hard link");
  EXPECT_EQ(bytes_in(letters), "Dear captain,\n");
  fs::remove(letters);
}

}  // namespace
}  // namespace isobath
