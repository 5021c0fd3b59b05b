// Voxel maps larger than memory: whatever was spilled, when and how often, they answer as a map without bound does; and
// what a killed program, a full disk or a flipped bit leaves is right or is refused.
#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <isobath/map/voxel/voxel_file.hpp>
#include <map>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tests/support/sanitized.hpp>
#include <thread>
#include <unistd.h>
#include <vector>

namespace isobath {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

/// Everything that a map says: of each layer, block and voxel, the evidence and the revision.
struct Content {
  std::map<std::string, std::map<std::array<int, 4>, int>> evidence;
  std::map<std::string, std::map<std::array<int, 3>, std::uint64_t>> revisions;
  bool operator==(const Content&) const = default;
};

Content content_of(const VoxelMap& map) {
  Content all;
  for (const std::string& sensor : map.sensors()) {
    map.find_layer(sensor)->for_each(0, [&](const VoxelBlocks::Block& b) {
      const std::array<int, 3> corner{b.corner.x(), b.corner.y(), b.corner.z()};
      EXPECT_TRUE(all.revisions[sensor].emplace(corner, b.revision).second) << "a block is visited once";
      for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
        if (b.evidence[i] != kUnseen) all.evidence[sensor][{corner[0], corner[1], corner[2], i}] = b.evidence[i];
      }
    });
  }
  return all;
}

class VoxelFiles : public testing::Test {
 protected:
  VoxelFiles() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~VoxelFiles() override { fs::remove_all(folder_); }
  fs::path folder_ = fs::path(testing::TempDir()) /
                     (std::string("voxel_file_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::path file_ = folder_ / "voxels.sqlite";
};

/// One ping's worth: rays about a place that wanders out and back, of one or the other sonar.
void hear_ping(VoxelMap& map, Random& random, int step) {
  map.advance();
  VoxelBlocks& layer = map.layer(step % 3 == 0 ? "upright" : "flat");
  const int way = step % 80 < 40 ? step % 40 : 40 - step % 40;
  const Vector3d at(3.7 * way, -2.1 * way, 20 + 0.3 * way);
  for (int i = 0; i < 12; ++i) {
    Vector3d to = at;
    for (int a = 0; a < 3; ++a) to[a] += random.uniform(-40, 40);
    const auto miss = static_cast<LogOdds16>(-static_cast<int>(random.index(400)));
    layer.insert_ray(at, to, miss, 867);
  }
}

// ledger: S5-13 S5-27
TEST_F(VoxelFiles, BoundMemoryAndLoseNothing) {
  ISOBATH_NOT_SANITIZED();
  for (const std::size_t budget : {std::size_t{0}, std::size_t{100'000}, std::size_t{600'000}}) {
    SCOPED_TRACE(budget);
    VoxelMap all, bounded;
    bounded.spill_to(file_);
    Random draws(5), same_draws(5), questions(6);
    std::size_t max_spilled = 0;
    for (int step = 0; step < 90; step += 7) {  // out and back; each spill is a commit that waits for the disk
      hear_ping(all, draws, step);
      hear_ping(bounded, same_draws, step);
      bounded.spill_beyond(budget);
      std::size_t held = 0;
      for (const std::string& s : bounded.sensors()) {
        held += bounded.find_layer(s)->blocks() - bounded.find_layer(s)->spilled();
      }
      EXPECT_LE(held * 8192, budget);
      max_spilled = std::max(max_spilled, bounded.spilled());
      for (int q = 0; q < 100; ++q) {
        const VoxelIndex v(static_cast<int>(questions.index(240)) - 50, static_cast<int>(questions.index(240)) - 140,
                           static_cast<int>(questions.index(120)) - 40);
        ASSERT_EQ(bounded.log_odds(v), all.log_odds(v));
        ASSERT_EQ(bounded.is_seen(v), all.is_seen(v));
      }
    }
    EXPECT_GT(max_spilled, 100u);
    EXPECT_TRUE(content_of(bounded) == content_of(all));
    EXPECT_EQ(bounded.changed_after(0), all.changed_after(0));
    EXPECT_EQ(bounded.changed_after(11), all.changed_after(11));
    std::uint64_t seen = 0;
    for_each_seen(bounded, [&](const VoxelIndex& v) { seen += bounded.space(v) == all.space(v) ? 1 : 1'000'000'000; });
    std::uint64_t expected = 0;
    for_each_seen(all, [&](const VoxelIndex&) { ++expected; });
    EXPECT_EQ(seen, expected);
    EXPECT_GT(bounded.spilled(), 0u) << "reading has brought nothing back for good";
    fs::remove(file_);
    EXPECT_NO_THROW(bounded = VoxelMap());
    fs::remove(file_);
  }
}

// The blocks of a window stay, the others go to the file: as in a map that keeps all.
TEST_F(VoxelFiles, KeepAWindowInMemoryAndTheWorldOnDisk) {
  VoxelMap all, window;
  window.spill_to(file_);
  Random draws(7), same_draws(7);
  std::size_t max_held = 0;
  for (int step = 0; step < 60; ++step) {
    hear_ping(all, draws, step);
    hear_ping(window, same_draws, step);
    const int way = step % 80 < 40 ? step % 40 : 40 - step % 40;
    window.spill_outside(Vector3d(3.7 * way, -2.1 * way, 20 + 0.3 * way) * window.voxel_m(), Vector3d::Constant(10));
    for (const char* s : {"flat", "upright"}) {
      const VoxelBlocks* layer = window.find_layer(s);
      if (layer) max_held = std::max(max_held, layer->blocks() - layer->spilled());
    }
  }
  EXPECT_LE(max_held, 6u * 6 * 6) << "80 voxels and a block at either end";
  EXPECT_GT(window.spilled(), 50u);
  EXPECT_TRUE(content_of(window) == content_of(all));
}

// What is forgotten is forgotten in the file too, and the block is made anew where it is touched.
TEST_F(VoxelFiles, ForgetOnDiskWhatIsForgotten) {
  VoxelMap all, bounded;
  bounded.spill_to(file_);
  Random draws(8), same_draws(8);
  for (int step = 0; step < 50; ++step) {
    hear_ping(all, draws, step);
    hear_ping(bounded, same_draws, step);
    if (step % 7 == 3) bounded.spill_beyond(50'000);
    if (step % 10 == 9) {
      const Vector3d at(3, -2, 5);
      EXPECT_EQ(bounded.keep_within(at, {8, 8, 8}), all.keep_within(at, {8, 8, 8}));
    }
  }
  EXPECT_TRUE(content_of(bounded) == content_of(all));
  bounded.save();
  EXPECT_TRUE(content_of(bounded) == content_of(all));
  const Vector3d far(1000, 0, 0);
  EXPECT_EQ(bounded.keep_within(far, {8, 8, 8}), all.keep_within(far, {8, 8, 8}));
  EXPECT_EQ(bounded.layer("flat").blocks() + bounded.layer("upright").blocks(), 0u);
  EXPECT_TRUE(bounded.changed_after(0).empty());
  bounded = VoxelMap();
  VoxelMap again;
  again.spill_to(file_);
  EXPECT_EQ(again.spilled(), 0u);
  EXPECT_THAT(again.sensors(), testing::UnorderedElementsAre("flat", "upright"));
}

// Wherever its blocks are, a map moves as one in memory does, and its file forgets the places of before.
// ledger: S5-13 S6-53
TEST_F(VoxelFiles, MoveAsAMapInMemoryDoes) {
  VoxelMap all, bounded;
  bounded.spill_to(file_);
  Random draws(18), same_draws(18);
  std::uint64_t after = 0;
  for (int step = 0; step < 60; ++step) {
    hear_ping(all, draws, step);
    hear_ping(bounded, same_draws, step);
    if (step % 5 == 3) bounded.spill_beyond(60'000);
    if (step % 13 == 7) bounded.save();
    if (step % 20 == 19) {
      const VoxelIndex by(3 * step, 7, -step);
      EXPECT_GT(bounded.spilled(), 0u);
      all.advance();
      bounded.advance();
      all.move(by, after);
      bounded.move(by, after);
      after = all.revision() - 8;
      EXPECT_TRUE(content_of(bounded) == content_of(all)) << step;
    }
  }
  bounded.save();
  const Content content = content_of(bounded);
  bounded = VoxelMap();
  VoxelMap again;
  again.spill_to(file_);
  EXPECT_TRUE(content_of(again) == content);
}

TEST_F(VoxelFiles, OpenAgainAndGoOn) {
  VoxelMap all;
  Random draws(9), same_draws(9);
  for (int step = 0; step < 30; ++step) hear_ping(all, draws, step);
  {
    VoxelMap first;
    first.spill_to(file_);
    for (int step = 0; step < 15; ++step) {
      hear_ping(first, same_draws, step);
      first.spill_beyond(200'000);
    }
    first.save();
  }
  VoxelMap second;
  second.spill_to(file_);
  EXPECT_EQ(second.revision(), 16u);
  for (int step = 15; step < 30; ++step) {
    hear_ping(second, same_draws, step);
    second.spill_beyond(200'000);
  }
  EXPECT_TRUE(content_of(second) == content_of(all));
}

TEST_F(VoxelFiles, AreReadByManyThreadsAtOnce) {
  VoxelMap all, bounded;
  bounded.spill_to(file_);
  Random draws(10), same_draws(10);
  for (int step = 0; step < 20; ++step) {
    hear_ping(all, draws, step);
    hear_ping(bounded, same_draws, step);
  }
  bounded.spill_beyond(100'000);
  std::array<int, 4> wrong{};
  std::vector<std::thread> readers;
  for (std::size_t r = 0; r < wrong.size(); ++r) {
    readers.emplace_back([&, r] {
      Random random(100 + r);
      for (int i = 0; i < 1500; ++i) {
        VoxelIndex v;
        for (int a = 0; a < 3; ++a) v[a] = static_cast<int>(random.index(100)) - 40;
        wrong[r] += bounded.log_odds(v) == all.log_odds(v) && bounded.is_seen(v) == all.is_seen(v) ? 0 : 1;
      }
    });
  }
  for (std::thread& t : readers) t.join();
  EXPECT_THAT(wrong, testing::Each(0));
}

// Corners, negative ones and the farthest there are, come back from their numbers.
TEST_F(VoxelFiles, NumberBlocksOneToOne) {
  Random random(11);
  constexpr int kMax = VoxelBlocks::kFarthest - 1;
  std::vector<VoxelIndex> places{{kMax, -kMax, 0}, {-kMax, kMax, -1}, {0, 0, 0}, {-1, -16, -17}, {15, 16, 17}};
  for (int i = 0; i < 1000; ++i) {
    VoxelIndex v;
    for (int a = 0; a < 3; ++a) v[a] = static_cast<int>(random.index(2 * kMax + 1)) - kMax;
    places.push_back(v);
  }
  for (const VoxelIndex& v : places) {
    const VoxelIndex corner = VoxelBlocks::corner_of(VoxelBlocks::key_of(v));
    for (int a = 0; a < 3; ++a) ASSERT_EQ(corner[a], 16 * static_cast<int>(std::floor(v[a] / 16.0))) << v.transpose();
  }
}

// Damage -------------------------------------------------------------------------------------------------------------

void execute(const fs::path& file, const std::string& sql) {
  sqlite3* connection = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &connection), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(connection);
  sqlite3_close(connection);
}

void write_small_map(const fs::path& file) {
  VoxelMap map;
  map.spill_to(file);
  for (int i = 0; i < 40; ++i) {
    map.layer("a").add({20 * i, 3, -5}, static_cast<LogOdds16>(10 * i + 1));
    map.layer("a").add({20 * i + 1, 4, -5}, static_cast<LogOdds16>(-i));
  }
  map.save();
}

TEST_F(VoxelFiles, ThatAreNotAsTheyWereWrittenAreRefused) {
  const auto problem_with = [&](const std::string& sql) -> std::string {
    fs::remove(file_);
    write_small_map(file_);
    execute(file_, sql);
    VoxelMap map;
    try {
      map.spill_to(file_);
      map.layer("a").for_each(0, [](const VoxelBlocks::Block&) {});
      for (int i = 0; i < 40; ++i) {
        if (map.layer("a").at({20 * i, 3, -5}) != 10 * i + 1) return "another map";
      }
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  };
  EXPECT_EQ(problem_with("SELECT 1"), "");
  EXPECT_THAT(problem_with("UPDATE block SET revision = 7"), HasSubstr("checksum does not match"));
  EXPECT_THAT(problem_with("UPDATE block SET crc32 = crc32 + 1 WHERE place = (SELECT max(place) FROM block)"),
              HasSubstr("checksum does not match"));
  EXPECT_THAT(problem_with("UPDATE block SET evidence = (SELECT evidence FROM block ORDER BY place LIMIT 1)"),
              HasSubstr("checksum does not match"));
  EXPECT_THAT(problem_with("UPDATE block SET place = place + 1 WHERE place = (SELECT max(place) FROM block)"),
              HasSubstr("checksum does not match"))
      << "in another place";
  EXPECT_THAT(problem_with("UPDATE block SET evidence = x'00ff'"), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(problem_with("UPDATE block SET evidence = substr(evidence, 1, length(evidence) - 6)"),
              HasSubstr("cannot be unpacked"));
  EXPECT_THAT(problem_with("UPDATE map SET voxel_m = 0.5"), HasSubstr("is a map of voxels of 0.5 m"));
  EXPECT_THAT(problem_with("UPDATE map SET most = 30000"), HasSubstr("evidence from -7066 to 30000"));
  EXPECT_THAT(problem_with("DROP TABLE block"), HasSubstr("tables that do not belong to"));
}

// A flipped byte anywhere is found when the file is opened or when the block is read, or has hit nothing that counts.
TEST_F(VoxelFiles, NeverOpenAsAnotherMap) {
  write_small_map(file_);
  std::string bytes;
  {
    std::ifstream in(file_, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  Random random(12);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::string damaged = bytes;
    const std::size_t at = random.index(bytes.size());
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random.index(8)));
    std::ofstream(file_, std::ios::binary | std::ios::trunc) << damaged;
    VoxelMap map;
    try {
      map.spill_to(file_);
      for (int k = 0; k < 40; ++k) {
        const VoxelIndex v(20 * k, 3, -5);
        if (!map.find_layer("a")) break;  // the layer's name is another
        const LogOdds16 e = map.layer("a").at(v);
        ASSERT_EQ(e, 10 * k + 1) << "byte " << at;
      }
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr("voxels.sqlite"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 20);
}

TEST_F(VoxelFiles, AreNotMixedWithAMapThatHoldsVoxels) {
  write_small_map(file_);
  VoxelMap map;
  map.layer("b").add({0, 0, 0}, 5);
  EXPECT_THAT([&] { map.spill_to(file_); }, ThrowsMessage<Error>(HasSubstr("already holds voxels")));
  EXPECT_EQ(map.layer("b").at({0, 0, 0}), 5);
  map.spill_to(folder_ / "other.sqlite");
  EXPECT_THAT([&] { map.spill_to(folder_ / "third.sqlite"); }, ThrowsMessage<Error>(HasSubstr("already has a file")));
  VoxelMap second;
  EXPECT_THAT([&] { second.spill_to(folder_ / "other.sqlite"); }, ThrowsMessage<Error>(HasSubstr("close that first")));
  std::ofstream(folder_ / "text.sqlite") << std::string(5000, 'x');
  EXPECT_THROW(second.spill_to(folder_ / "text.sqlite"), Error);
  EXPECT_THROW(second.spill_to(folder_ / "no_folder" / "voxels.sqlite"), Error);
}

// No room on the disk: one clear line, and the map is as it was, in memory and in the file.
TEST_F(VoxelFiles, WithoutRoomOnTheDiskLoseNothing) {
  VoxelMap all, bounded;
  bounded.spill_to(file_);
  Random draws(13), same_draws(13);
  for (int step = 0; step < 12; ++step) {
    hear_ping(all, draws, step);
    hear_ping(bounded, same_draws, step);
    if (step == 5) bounded.spill_beyond(100'000);
  }
  const std::size_t spilled = bounded.spilled();
  rlimit room{};
  getrlimit(RLIMIT_FSIZE, &room);
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit full{fs::file_size(file_) + 8192, room.rlim_max};
  setrlimit(RLIMIT_FSIZE, &full);
  std::string problem;
  try {
    bounded.spill_beyond(0);
  } catch (const Error& e) {
    problem = e.what();
  }
  setrlimit(RLIMIT_FSIZE, &room);
  std::signal(SIGXFSZ, before);
  EXPECT_THAT(problem, HasSubstr("voxels.sqlite: cannot be"));
  EXPECT_GE(bounded.spilled(), spilled);
  EXPECT_TRUE(content_of(bounded) == content_of(all));
  EXPECT_GT(bounded.spill_beyond(0), 0u) << "there is room again";
  EXPECT_TRUE(content_of(bounded) == content_of(all));
}

/// A child that maps and spills tells of each spill, and is killed after one of them at an instant of its own.
int spills_before_the_kill(const fs::path& file, int wanted) {
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) return -1;
  const pid_t child = fork();
  if (child == 0) {
    VoxelMap map;
    map.spill_to(file);
    Random draws(14);
    for (int step = 0; step < 1000; ++step) {
      hear_ping(map, draws, step);
      map.spill_beyond(100'000);
      const char done = 1;
      if (::write(pipe[1], &done, 1) != 1) _exit(1);
    }
    _exit(0);
  }
  ::close(pipe[1]);
  int spills = 0;
  char done = 0;
  while (spills < wanted && ::read(pipe[0], &done, 1) == 1) ++spills;
  kill(child, SIGKILL);
  while (::read(pipe[0], &done, 1) == 1) ++spills;  // told before the signal came
  ::close(pipe[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return spills;
}

TEST_F(VoxelFiles, OfAKilledProgramHoldTheBlocksOfItsLastSpill) {
  for (const int wanted : {1, 4, 9, 17}) {
    fs::remove(file_);
    const int spills = spills_before_the_kill(file_, wanted);
    ASSERT_GE(spills, wanted);
    VoxelMap left;
    left.spill_to(file_);
    const Content found = content_of(left);

    // Every block as it was at the revision that it says, by a map without bound; none that had to be there is missing.
    VoxelMap all;
    Random draws(14);
    std::size_t checked = 0;
    for (int step = 0; step <= spills; ++step) {
      hear_ping(all, draws, step);
      for (const auto& [sensor, revisions] : found.revisions) {
        for (const auto& [corner, revision] : revisions) {
          if (revision != all.revision()) continue;
          ++checked;
          for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
            const VoxelIndex v = VoxelIndex(corner[0], corner[1], corner[2]) + VoxelBlocks::place_of(i);
            ASSERT_EQ(left.find_layer(sensor)->at(v), all.find_layer(sensor)->at(v));
          }
        }
      }
    }
    std::size_t blocks = 0, needed = 0;
    for (const auto& [sensor, revisions] : found.revisions) blocks += revisions.size();
    EXPECT_EQ(checked, blocks);
    for (const std::string& sensor : all.sensors()) needed += all.find_layer(sensor)->blocks();
    EXPECT_GE(blocks + 100'000 / 8192 + 200, needed) << "what memory held, and the update after the last spill";
  }
}

}  // namespace
}  // namespace isobath
