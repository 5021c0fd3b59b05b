#include <cmath>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/map/depth/tree_file.hpp>
#include <iterator>
#include <tests/support/tree_file_bytes.hpp>

namespace isobath::tree_file_test {
namespace {

namespace fs = std::filesystem;
using test::TreeFileBytes;
using Values = std::vector<std::uint32_t>;

constexpr std::uint32_t kLost = 999999;

class TreeFileTest : public testing::Test {
 protected:
  TreeFileTest() : folder_(fs::path(testing::TempDir()) / ("tree_file_" + std::string(name()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~TreeFileTest() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path file() const { return folder_ / "depth.tree"; }
  static const char* name() { return testing::UnitTest::GetInstance()->current_test_info()->name(); }

 private:
  fs::path folder_;
};

Values read_all(const RegionQuadtree& tree) {
  Values values(std::size_t(tree.side()) * std::size_t(tree.side()));
  tree.read(tree.square(), values.data(), tree.side());
  return values;
}

// Rough enough that most leaves are a pixel or four.
RegionQuadtree bottom(int levels, std::uint64_t seed = 1) {
  Random random(seed);
  const int side = 1 << levels;
  Values values;
  for (int i = 0; i < side * side; ++i) {
    values.push_back(
        5000 + 10 * static_cast<std::uint32_t>(8 * std::sin(0.03 * (i % side)) + 8 * std::cos(0.02 * (i / side)) + 20) +
        static_cast<std::uint32_t>(random.index(2)));
  }
  return RegionQuadtree::from_raster(levels, values, side, side, 17);
}

TreeFileBytes bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {{std::istreambuf_iterator<char>(in), {}}};
}

TreeFileBytes written(const fs::path& file, const RegionQuadtree& tree) {
  write_tree_file(file, tree, 3, "{}");
  return bytes_of(file);
}

TreeFile parse(const TreeFileBytes& file) { return parse_tree_file(file.bytes, nullptr, "a.tree", kLost); }

Error error_of(const TreeFileBytes& file) {
  try {
    parse(file);
  } catch (const Error& e) {
    return e;
  }
  return Error("no error");
}

// The tree is sound: what it holds can be read, merged away and built up, and no block is lost or used twice.
void expect_sound(RegionQuadtree tree) {
  const Values before = read_all(tree);
  const auto rebuilt = RegionQuadtree::from_raster(tree.levels(), before, tree.side(), tree.side(), tree.outside());
  EXPECT_TRUE(tree == rebuilt);
  EXPECT_EQ(tree.statistics().words, rebuilt.statistics().words);
  const std::uint32_t blocks = tree.pool().end();
  tree.fill(tree.square(), 1);
  EXPECT_EQ(tree.pool().free_count(), blocks);
  Values distinct(before.size());  // needs every block there is: one that is free twice would show
  for (std::size_t i = 0; i < distinct.size(); ++i) distinct[i] = static_cast<std::uint32_t>(i);
  tree.write(tree.square(), {distinct.data(), tree.side()});
  EXPECT_EQ(read_all(tree), distinct);
}

// ledger: S1-26
TEST_F(TreeFileTest, AMapComesBackAsItWas) {
  for (int levels : {0, 3, 8}) {
    RegionQuadtree tree = bottom(levels);
    tree.fill({3, 2, 100, 50}, 4);  // leaves free blocks
    write_tree_file(file(), tree, 1234567890123, R"({"epoch": "2024-05-01", "name": "Müritz"})");
    const TreeFile opened = open_tree_file(file(), kLost);
    EXPECT_TRUE(opened.tree == tree);
    EXPECT_TRUE(opened.sound());
    EXPECT_THAT(opened.lost, testing::IsEmpty());
    EXPECT_EQ(opened.generation, 1234567890123);
    EXPECT_EQ(opened.metadata, R"({"epoch": "2024-05-01", "name": "Müritz"})");
    EXPECT_EQ(opened.tree.outside(), 17);
    EXPECT_EQ(opened.tree.pool().free_count(), tree.pool().free_count());
    expect_sound(opened.tree);
    EXPECT_FALSE(fs::exists(file().string() + ".part"));
  }
}

// ledger: S1-26 S1-12
TEST_F(TreeFileTest, ALargeMapStaysInTheFileUntilAPageIsWrittenTo) {
  const RegionQuadtree tree = bottom(10);
  write_tree_file(file(), tree, 1, "");
  ASSERT_GT(fs::file_size(file()), 4 << 20);
  TreeFile opened = open_tree_file(file(), kLost);
  const std::uint32_t pages = opened.tree.pool().pages();
  EXPECT_EQ(opened.tree.pool().mapped_pages(), pages);
  opened.tree.fill({500, 500, 1, 1}, 1);
  EXPECT_EQ(opened.tree.pool().mapped_pages(), pages - 1);
  write_tree_file(file(), opened.tree, 2, "");  // over the file that is mapped
  EXPECT_EQ(opened.tree.at({500, 500}), 1);
  EXPECT_EQ(opened.tree.at({501, 777}), tree.at({501, 777}));
  const TreeFile again = open_tree_file(file(), kLost);
  EXPECT_TRUE(again.tree == opened.tree);
  EXPECT_EQ(again.generation, 2);
}

// ledger: S1-26
TEST_F(TreeFileTest, AWriteThatFailsLeavesTheOldMap) {
  const RegionQuadtree tree = bottom(5);
  write_tree_file(file(), tree, 1, "");
  fs::create_directory(file().string() + ".part");
  try {
    write_tree_file(file(), RegionQuadtree(5), 2, "");
    ADD_FAILURE() << "a folder cannot be written";
  } catch (const Error& e) {
    EXPECT_THAT(e.where().file, testing::EndsWith("depth.tree.part"));
  }
  EXPECT_TRUE(open_tree_file(file(), kLost).tree == tree);
  EXPECT_THROW(write_tree_file(file().parent_path() / "none" / "a.tree", tree, 1, ""), Error);
  EXPECT_THROW(write_tree_file(file(), tree, 1, std::string(kMaxTreeMetadata + 1, ' ')), Error);
}

TEST_F(TreeFileTest, WhatIsNotAMapIsRefused) {
  EXPECT_THROW(open_tree_file(file(), kLost), Error);
  EXPECT_THROW(open_tree_file(file().parent_path(), kLost), Error);
  std::ofstream(file()).flush();
  EXPECT_THROW(open_tree_file(file(), kLost), Error);
}

// ledger: S1-26
TEST_F(TreeFileTest, EveryFlippedBitOfTheHeaderIsFound) {
  const TreeFileBytes good = written(file(), bottom(4));
  for (std::size_t bit = 0; bit < 8 * (TreeFileBytes::kHeader + 2); ++bit) {
    TreeFileBytes bad = good;
    bad.bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    const Error e = error_of(bad);
    EXPECT_EQ(e.where().file, "a.tree") << "bit " << bit;
    EXPECT_TRUE(e.where().byte.has_value()) << "bit " << bit;
  }
}

TEST_F(TreeFileTest, FilesOfOthersAreToldApart) {
  const TreeFileBytes good = written(file(), bottom(4));
  TreeFileBytes bad = good;
  bad.put(TreeFileBytes::kOrder, 0x04030201);
  EXPECT_THAT(error_of(bad).what(), testing::HasSubstr("other byte order"));
  bad = good;
  bad.put(TreeFileBytes::kVersion, 2);
  EXPECT_THAT(error_of(bad).what(), testing::HasSubstr("version 2"));
  bad = good;
  bad.bytes[0] = 'x';
  EXPECT_THAT(error_of(bad).what(), testing::HasSubstr("not a quadtree file"));
  bad = good;
  bad.put(TreeFileBytes::kLevels, 25);
  bad.seal();
  EXPECT_THAT(error_of(bad).what(), testing::HasSubstr("0 .. 24"));
  bad = good;
  bad.put(TreeFileBytes::kBlocks, 5000);
  bad.seal();
  EXPECT_THAT(error_of(bad).what(), testing::HasSubstr("contradict"));
  bad = good;
  bad.bytes.push_back(0);
  EXPECT_THAT(error_of(bad).what(), testing::HasSubstr("appended"));
}

TEST_F(TreeFileTest, AFileThatWasCutOffIsRefusedAtEveryLength) {
  const TreeFileBytes good = written(file(), bottom(4));
  for (std::size_t size = 1; size < good.bytes.size(); size += size < 100 ? 1 : 331) {
    const TreeFileBytes cut{{good.bytes.begin(), good.bytes.begin() + static_cast<std::ptrdiff_t>(size)}};
    const Error e = error_of(cut);
    EXPECT_THAT(e.what(), testing::HasSubstr("cut off"));
    EXPECT_EQ(e.where().byte, size);
  }
}

// ledger: S1-26
TEST_F(TreeFileTest, AFlippedBitCostsTheSquaresOfItsPageAndNothingElse) {
  const RegionQuadtree tree = bottom(9);
  const Values truth = read_all(tree);
  const TreeFileBytes good = written(file(), tree);
  const std::size_t pages = good.word(TreeFileBytes::kPages);
  ASSERT_GT(pages, 30);
  for (std::size_t page = 0; page < pages; page += 13) {
    TreeFileBytes bad = good;
    bad.bytes[good.page(page) + 37 * page % TreeFileBytes::kPage] ^= 16;
    const TreeFile opened = parse(bad);
    EXPECT_THAT(opened.damaged_pages,
                testing::ElementsAre(TreeFile::Damage{static_cast<std::uint32_t>(page), good.page(page)}));
    EXPECT_THAT(opened.lost, testing::Not(testing::IsEmpty()));
    Values expected = truth;
    std::size_t lost = 0;
    for (const PixelWindow& w : opened.lost) {
      for (int i = 0; i < w.width * w.height; ++i)
        expected[std::size_t((w.row + i / w.width) * 512 + w.column + i % w.width)] = kLost;
      lost += std::size_t(w.width) * std::size_t(w.height);
    }
    EXPECT_EQ(read_all(opened.tree), expected);
    EXPECT_LT(lost, truth.size() / 10) << "page " << page;
    expect_sound(opened.tree);
  }
}

TEST_F(TreeFileTest, TheTopOfTheTreeSurvivesThePageItStandsIn) {
  const RegionQuadtree tree = bottom(9);
  TreeFileBytes bad = written(file(), tree);
  const std::uint32_t root_page = (tree.root() >> 1) / BlockPool::kBlocksPerPage;
  bad.bytes[bad.page(root_page) + 100] ^= 1;
  std::size_t lost = 0;
  for (const PixelWindow& w : parse(bad).lost) lost += std::size_t(w.width) * std::size_t(w.height);
  EXPECT_LT(lost, 512 * 512 / 10);
  bad.bytes[bad.crown()] ^= 1;  // and without the crown all is lost, and said to be
  const TreeFile without = parse(bad);
  EXPECT_THAT(without.lost, testing::ElementsAre(tree.square()));
  EXPECT_EQ(without.tree.at({77, 78}), kLost);
  expect_sound(without.tree);
}

// Files made with malice: all checksums are right.
class TreeFileLinks : public TreeFileTest {
 protected:
  // A chain: block 0 is the deepest of 8.
  TreeFileBytes chain() {
    RegionQuadtree tree(8);
    tree.fill({0, 0, 1, 1}, 1);
    return written(file(), tree);
  }
};

TEST_F(TreeFileLinks, LeadingNowhereAreLostSquares) {
  TreeFileBytes bad = chain();
  const std::uint32_t root = bad.word(TreeFileBytes::kRoot) >> 1;
  bad.put(bad.block(root) + 4, 2 * 1000000);
  bad.seal();
  const TreeFile opened = parse(bad);
  EXPECT_THAT(opened.bad_links, testing::ElementsAre(TreeFile::Damage{0, bad.block(root) + 4}));
  EXPECT_THAT(opened.lost, testing::ElementsAre(PixelWindow{128, 0, 128, 128}));
  EXPECT_EQ(opened.tree.at({128, 0}), kLost);
  EXPECT_EQ(opened.tree.at({0, 0}), 1);
  expect_sound(opened.tree);
}

TEST_F(TreeFileLinks, InCirclesAndTwiceToOneBlockAreFollowedOnce) {
  TreeFileBytes bad = chain();
  const std::uint32_t root = bad.word(TreeFileBytes::kRoot);
  for (std::uint32_t block = 0; block < 8; ++block) {
    bad.put(bad.block(block) + 12, root);                                      // a circle
    if (block > 0) bad.put(bad.block(block) + 8, bad.word(bad.block(block)));  // two parents' quadrants
  }
  bad.seal();
  const TreeFile opened = parse(bad);
  EXPECT_EQ(opened.bad_links.size(), 15);
  EXPECT_EQ(opened.tree.at({0, 0}), 1);
  expect_sound(opened.tree);
}

TEST_F(TreeFileLinks, BelowPixelsAreBad) {
  TreeFileBytes bad = chain();
  bad.put(TreeFileBytes::kLevels, 7);
  bad.seal();
  const TreeFile opened = parse(bad);
  EXPECT_EQ(opened.bad_links.size(), 1);
  EXPECT_THAT(opened.lost, testing::ElementsAre(PixelWindow{0, 0, 1, 1}));
  expect_sound(opened.tree);
}

// Blocks that merge as they are read, each linked four times from the one above: 4^8 ways to the lowest.
TEST_F(TreeFileLinks, ToBlocksThatMergeAreFollowedOnceToo) {
  TreeFileBytes bad = chain();
  std::uint32_t node = bad.word(TreeFileBytes::kRoot);
  while ((node & 1U) == 0) {
    const std::size_t at = bad.block(node >> 1);
    const std::uint32_t child = bad.word(at);
    for (std::size_t q = 1; q < 4; ++q) bad.put(at + 4 * q, child);
    node = child;
  }
  bad.seal();
  const TreeFile opened = parse(bad);
  EXPECT_EQ(opened.bad_links.size(), 7 * 3);
  EXPECT_EQ(opened.tree.leaf_at({0, 0}).window, (PixelWindow{0, 0, 2, 2}));
  expect_sound(opened.tree);
}

TEST_F(TreeFileLinks, OfFreeBlocksThatAreInUseAreNotBelieved) {
  RegionQuadtree tree(6);
  for (int i = 0; i < 64; i += 3) tree.fill({i, i, 1, 1}, 1);
  tree.fill({0, 0, 40, 40}, 2);
  tree.fill({62, 62, 1, 1}, RegionQuadtree::kLargestValue);  // its block reads as the end of a list
  const TreeFileBytes good = written(file(), tree);
  const std::uint32_t count = good.word(TreeFileBytes::kFreeCount);
  const std::uint32_t head = good.word(TreeFileBytes::kFreeHead);
  const std::uint32_t second = good.word(good.block(head));
  std::uint32_t last_but_one = head;
  for (std::uint32_t i = 2; i < count; ++i) last_but_one = good.word(good.block(last_but_one));
  std::uint32_t in_use = 0;
  while (good.word(good.block(in_use)) != BlockPool::kNone || in_use == good.word(good.block(last_but_one))) ++in_use;
  ASSERT_GT(count, 4);
  const auto expect_repaired = [&](std::size_t at, std::uint32_t wrong, std::uint32_t free_count) {
    TreeFileBytes bad = good;
    bad.put(at, wrong);
    bad.put(TreeFileBytes::kFreeCount, free_count);
    bad.seal();
    const TreeFile opened = parse(bad);
    EXPECT_TRUE(opened.tree == tree);
    EXPECT_EQ(opened.tree.pool().free_count(), count);
    expect_sound(opened.tree);
  };
  for (const std::uint32_t wrong : {tree.root() >> 1, head, 0xfffffffU, BlockPool::kNone}) {
    expect_repaired(good.block(head), wrong, count);
  }
  expect_repaired(good.block(last_but_one), in_use, count);
  expect_repaired(TreeFileBytes::kFreeHead, second, count - 1);  // one is missing
}

}  // namespace
}  // namespace isobath::tree_file_test
