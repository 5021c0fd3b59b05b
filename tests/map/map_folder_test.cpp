// A map on disk: opened again as it was, whatever happens to the program or to a bit.
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <set>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// An empty folder of its own, gone at the end.
class MapFolderTest : public testing::Test {
 protected:
  MapFolderTest() : folder_(fs::temp_directory_path() / ("isobath_map_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
  }
  ~MapFolderTest() override { fs::remove_all(folder_); }
  fs::path folder_;
};

constexpr int kLevels = 10;

MapFacts facts() {
  MapFacts facts;
  facts.origin = GeoOrigin{52.34, 12.99};
  facts.area = {{{256, -256}, 0.5}, kLevels};
  facts.epoch = Time(std::chrono::hours(24 * 365 * 55));
  facts.datum = "water surface";
  facts.priors = {"lake.shp"};
  return facts;
}

DepthPixel pixel_of(std::uint64_t seed, int column, int row) {
  Random random(seed * 1000003 + static_cast<std::uint64_t>(column) * 1024 + static_cast<std::uint64_t>(row));
  return {DepthPixel::word_of_depth(0.01 * static_cast<double>(random.index(3000))),
          DepthPixel::word_of_state(static_cast<int>(random.index(21)), kSensed, 3)};
}

/// A map whose every pixel within a square follows from `seed`.
DepthTrees trees_of(std::uint64_t seed, int side = 192) {
  DepthTrees trees(kLevels);
  DepthTile tile;
  for (int row = 0; row < side; row += DepthTile::kSide) {
    for (int column = 0; column < side; column += DepthTile::kSide) {
      for (int i = 0; i < DepthTile::kPixels; ++i) {
        tile.pixels[static_cast<std::size_t>(i)] =
            pixel_of(seed, column + i % DepthTile::kSide, row + i / DepthTile::kSide);
      }
      tile.changed.fill(~0U);
      trees.write_tile({column / DepthTile::kSide, row / DepthTile::kSide}, tile);
    }
  }
  return trees;
}

// ledger: S1-26
TEST_F(MapFolderTest, a_map_is_read_back_as_it_was_written) {
  MapFacts written = facts();
  written.visits.push_back({"log.sum", Time(seconds(10)), Time(seconds(99)), {{"range readings", 31}}});
  const DepthTrees trees = trees_of(1);
  {
    MapFolder folder(folder_);
    EXPECT_FALSE(folder.holds_map());
    folder.commit(written, trees);
    EXPECT_EQ(written.generation, 1U);
    folder.commit(written, trees);
  }
  const StoredMap map = open_map(folder_);
  EXPECT_EQ(map.facts.generation, 2U);
  EXPECT_EQ(map.facts.origin, written.origin);
  EXPECT_EQ(map.facts.area.levels, kLevels);
  EXPECT_EQ(map.facts.area.grid.corner_m, written.area.grid.corner_m);
  EXPECT_EQ(map.facts.epoch, written.epoch);
  EXPECT_EQ(map.facts.datum, "water surface");
  EXPECT_EQ(map.facts.priors, written.priors);
  ASSERT_EQ(map.facts.visits.size(), 1U);
  EXPECT_EQ(map.facts.visits[0].counts.at("range readings"), 31U);
  EXPECT_TRUE(map.trees.state() == trees.state());
  EXPECT_TRUE(map.trees.sensed() == trees.sensed());
  EXPECT_TRUE(map.damages.empty());
  std::size_t tree_files = 0;
  for (const auto& entry : fs::directory_iterator(folder_)) tree_files += entry.path().extension() == ".tree" ? 1 : 0;
  EXPECT_EQ(tree_files, 3U) << "the files of earlier generations are gone";
}

// ledger: S1-13
TEST_F(MapFolderTest, the_prior_keeps_its_file_for_all_missions) {
  MapFacts written = facts();
  MapFolder folder(folder_);
  folder.commit(written, trees_of(1));
  const auto prior = fs::last_write_time(folder_ / "prior.1.tree");
  folder.commit(written, trees_of(2));
  EXPECT_EQ(fs::last_write_time(folder_ / "prior.1.tree"), prior);
  EXPECT_TRUE(fs::exists(folder_ / "sensed.2.tree"));
}

TEST_F(MapFolderTest, one_program_writes_at_a_time) {
  const MapFolder first(folder_);
  EXPECT_THROW(MapFolder second(folder_), Error);
}

/// Commits one generation after the other until it is killed; tells each that was committed.
[[noreturn]] void commit_for_ever(const fs::path& path, int tell) {
  MapFolder folder(path);
  MapFacts written = folder.holds_map() ? open_map(path).facts : facts();
  for (;;) {
    folder.commit(written, trees_of(written.generation + 1, 64));
    if (::write(tell, &written.generation, sizeof(written.generation)) < 0) ::_exit(1);
  }
}

// ledger: S1-26
TEST_F(MapFolderTest, killed_at_any_of_200_instants_it_opens_at_a_committed_state) {
  Random random(7);
  std::uint64_t committed = 0;
  std::chrono::duration<double> commit_takes{};
  for (int i = 0; i < 200; ++i) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::pipe(ends.data()), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        commit_for_ever(folder_, ends[1]);
      } catch (...) {
        ::_exit(1);
      }
    }
    ::close(ends[1]);
    if (i == 0) {
      // How long a commit takes here only chooses the instants; no verdict depends on it.
      const auto begun = std::chrono::steady_clock::now();
      ASSERT_GT(::read(ends[0], &committed, sizeof(committed)), 0);
      commit_takes = std::chrono::steady_clock::now() - begun;
    }
    if (i > 0) std::this_thread::sleep_for(random.uniform() * 2 * commit_takes);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    std::uint64_t generation = 0;
    while (::read(ends[0], &generation, sizeof(generation)) > 0) committed = generation;
    ::close(ends[0]);
    const StoredMap map = open_map(folder_);
    ASSERT_TRUE(map.damages.empty()) << map.damages.front().reason;
    ASSERT_GE(map.facts.generation, committed) << "what was committed is there";
    ASSERT_LE(map.facts.generation, committed + 1) << "and nothing that nobody committed";
    committed = map.facts.generation;
    const DepthTrees expected = trees_of(committed, 64);
    ASSERT_TRUE(map.trees.sensed() == expected.sensed());
    ASSERT_TRUE(map.trees.state() == expected.state());
  }
  EXPECT_GT(committed, 0U) << "some got through";
}

// The instant is a byte of a file, not a time: the system ends the writer (SIGXFSZ) where a file would grow past it.
// ledger: S1-26
TEST_F(MapFolderTest, killed_while_it_writes_it_opens_at_the_state_before) {
  MapFacts written = facts();
  MapFolder(folder_).commit(written, trees_of(1, 64));
  std::set<std::uintmax_t> instants = {0, 1, 4096};
  for (const auto& file : fs::directory_iterator(folder_)) {
    if (file.file_size() > 0) instants.insert({file.file_size() / 2, file.file_size() - 1});
  }
  const std::uintmax_t largest = *instants.rbegin();
  for (const std::uintmax_t bytes : instants) {
    const pid_t child = ::fork();
    if (child == 0) {
      const rlimit limit{bytes, bytes};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      try {
        MapFolder(folder_).commit(written, trees_of(2, 64));
      } catch (...) {
        ::_exit(1);
      }
      ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ) << bytes << " of " << largest << ": not killed";
    const StoredMap map = open_map(folder_);
    ASSERT_TRUE(map.damages.empty()) << bytes << ": " << map.damages.front().reason;
    EXPECT_EQ(map.facts.generation, 1U) << bytes;
    EXPECT_TRUE(map.trees.sensed() == trees_of(1, 64).sensed()) << bytes;
    EXPECT_TRUE(map.trees.state() == trees_of(1, 64).state()) << bytes;
  }
}

void flip_bit(const fs::path& file, std::uint64_t byte) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(byte));
  const int was = stream.get();
  stream.seekp(static_cast<std::streamoff>(byte));
  stream.put(static_cast<char>(was ^ 0x10));
}

// ledger: S1-26
TEST_F(MapFolderTest, a_flipped_bit_anywhere_is_reported_and_the_rest_is_read) {
  const DepthTrees trees = trees_of(1);
  MapFacts written = facts();
  MapFolder(folder_).commit(written, trees);
  Random random(3);
  for (const char* name : {"map.json", "prior.1.tree", "sensed.1.tree", "state.1.tree"}) {
    const fs::path file = folder_ / name;
    const std::uint64_t size = fs::file_size(file);
    // Every block of 16 KiB, and the header.
    for (std::uint64_t at = 0; at < size; at += 16384) {
      const std::uint64_t byte = std::min(size - 1, at + random.index(std::min<std::uint64_t>(16384, size - at)));
      flip_bit(file, byte);
      const StoredMap map = open_map(folder_);
      ASSERT_FALSE(map.damages.empty()) << name << ", byte " << byte;
      for (const MapDamage& damage : map.damages) {
        EXPECT_EQ(damage.file, name);
        EXPECT_FALSE(damage.reason.empty());
      }
      int right = 0, wrong = 0;
      for (int row = 0; row < 192; row += 3) {
        for (int column = 0; column < 192; column += 3) {
          const DepthPixel read = map.trees.at({column, row});
          const DepthPixel truth = pixel_of(1, column, row);
          right += read.known() && read.depth_word == truth.depth_word ? 1 : 0;
          wrong += read.known() && read.depth_word != truth.depth_word ? 1 : 0;
        }
      }
      EXPECT_EQ(wrong, 0) << name << ", byte " << byte;
      const bool whole_tree = map.damages.front().pixels_lost == (1U << (2 * kLevels));
      if (!whole_tree) {
        EXPECT_GT(right, 64 * 64 / 4) << name << ", byte " << byte;
      }
      flip_bit(file, byte);
    }
  }
  EXPECT_TRUE(open_map(folder_).damages.empty());
}

int largest_confidence(const DepthTrees& trees) {
  int largest = 0;
  trees.state().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow&) {
    largest = std::max(largest, DepthPixel{0, word}.confidence());
  });
  return largest;
}

TEST_F(MapFolderTest, a_confidence_above_20_is_damage_and_is_not_believed) {
  MapFacts written = facts();
  RegionQuadtree state(kLevels, 0);
  state.fill({0, 0, 512, 512}, DepthPixel::word_of_state(20, kSensed, 3));
  state.fill({8, 8, 4, 4}, DepthPixel::word_of_state(31, kSensed, 3));
  state.fill({600, 600, 1, 1}, DepthPixel::word_of_state(21, 0, 0));
  RegionQuadtree sensed(kLevels, 0);
  sensed.fill({0, 0, 512, 512}, DepthPixel::word_of_depth(7));
  MapFolder(folder_).commit(written, DepthTrees(RegionQuadtree(kLevels, 0), sensed, state));
  const StoredMap map = open_map(folder_);
  ASSERT_EQ(map.damages.size(), 1U);
  EXPECT_EQ(to_text(map.damages[0]), "state.1.tree, block 0 at byte 0: a confidence is above 20; 17 pixels lost");
  EXPECT_EQ(largest_confidence(map.trees), 20);
  EXPECT_EQ(map.trees.at({9, 9}).depth_m(), 7) << "the measured depth counts, with confidence 0";
  EXPECT_EQ(map.trees.at({9, 9}).confidence(), 0);
  EXPECT_FALSE(map.trees.at({600, 600}).known());
}

TEST_F(MapFolderTest, what_is_no_map_is_refused_with_one_line) {
  EXPECT_THROW(open_map(folder_), Error);
  fs::create_directories(folder_);
  for (const char* text : {"", "{}", "[1,2]", "{\"isobath_map\": {}, \"crc32\": 0}", "\xff\xfe"}) {
    std::ofstream(folder_ / "map.json") << text;
    try {
      open_map(folder_);
      ADD_FAILURE() << text;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr("map.json"));
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace isobath
