#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/map/depth/depth_pixel.hpp>
#include <isobath/map/depth/region_quadtree.hpp>
#include <set>
#include <thread>
#include <tuple>

namespace isobath {
namespace {

using Values = std::vector<std::uint32_t>;

Values read_all(const RegionQuadtree& tree) {
  Values values(std::size_t(tree.side()) * std::size_t(tree.side()));
  tree.read(tree.square(), values.data(), tree.side());
  return values;
}

RegionQuadtree tree_of(int levels, const Values& values) {
  const int side = 1 << levels;
  return RegionQuadtree::from_raster(levels, values, side, side, 0);
}

// A hilly bottom on steps of 10 units: large and small leaves.
Values terraces(int side) {
  Values values;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      values.push_back(
          10 * static_cast<std::uint32_t>(std::lround(20 + 5 * std::sin(0.05 * row) + 4 * std::cos(0.07 * column))));
    }
  }
  return values;
}

// Every internal node, by its square: the ancestors of all leaves.
std::set<std::tuple<int, int, int>> internal_squares(const RegionQuadtree& tree) {
  std::set<std::tuple<int, int, int>> squares;
  tree.for_each_leaf(tree.square(), [&](std::uint32_t, const PixelWindow& leaf) {
    for (int side = 2 * leaf.width; side <= tree.side(); side *= 2) {
      squares.emplace(leaf.column & -side, leaf.row & -side, side);
    }
  });
  return squares;
}

bool meets(const std::tuple<int, int, int>& square, const PixelWindow& window) {
  const auto [column, row, side] = square;
  const PixelWindow part = overlap({column, row, side, side}, window);
  return part.width > 0 && part.height > 0;
}

// ledger: S1-16 S1-12
TEST(RegionQuadtree, AFreshMapIsOneNodeOfTheValueOutside) {
  const RegionQuadtree tree(20, 7);
  EXPECT_EQ(tree.statistics().leaves, 1);
  EXPECT_EQ(tree.statistics().words, 1);
  EXPECT_EQ(tree.statistics().bytes, 0);
  EXPECT_EQ(tree.at({123456, 654321}), 7);
  EXPECT_EQ(tree.at({-1, 0}), 7);
  EXPECT_EQ(tree.at({0, 1 << 20}), 7);
}

// ledger: S1-16 S1-17
TEST(RegionQuadtree, UnexploredWaterCostsNoMoreThanThePathToWhatIsKnown) {
  RegionQuadtree tree(20, DepthPixel::word_of_state(6, 0, 0));
  tree.fill({700000, 3, 1, 1}, 9);
  EXPECT_EQ(tree.statistics().internal_nodes, 20);
  EXPECT_EQ(tree.at({700000, 3}), 9);
  EXPECT_EQ(tree.at({700001, 3}), DepthPixel::word_of_state(6, 0, 0));
}

// ledger: S1-D06 S1-12 S1-E01
TEST(RegionQuadtree, SixInternalNodesOfNineteenLeavesAreTwentyFiveWords) {
  // 8 x 8: the root, two of its quadrants and three of theirs are split.
  RegionQuadtree tree(3);
  tree.fill({0, 0, 1, 1}, 1);  // root, NW, NW of NW
  tree.fill({3, 1, 1, 1}, 2);  // NE of NW
  tree.fill({6, 7, 1, 1}, 3);  // SE, SE of SE
  const auto s = tree.statistics();
  EXPECT_EQ(s.internal_nodes, 6);
  EXPECT_EQ(s.leaves, 19);
  EXPECT_EQ(s.words, 25);
  std::multiset<std::vector<std::string>> rows;  // the table: a row of four descriptors an internal node
  for (std::uint32_t block = 0; block < tree.pool().end(); ++block) {
    std::vector<std::string> row;
    for (std::uint32_t d : tree.pool().block(block)) {
      row.push_back(RegionQuadtree::is_leaf(d) ? std::to_string(d >> 1) : "link");
    }
    rows.insert(row);
  }
  using Row = std::vector<std::string>;
  EXPECT_THAT(rows, testing::UnorderedElementsAre(Row{"link", "0", "0", "link"}, Row{"link", "link", "0", "0"},
                                                  Row{"1", "0", "0", "0"}, Row{"0", "0", "0", "2"},
                                                  Row{"0", "0", "0", "link"}, Row{"0", "0", "3", "0"}));
}

// ledger: S1-11
TEST(RegionQuadtree, EqualLeavesMergeUntilOneIsLeft) {
  RegionQuadtree tree(4);
  for (int row = 0; row < 16; ++row) {
    for (int column = 0; column < 16; ++column) tree.fill({column, row, 1, 1}, 5);
  }
  EXPECT_EQ(tree.statistics().leaves, 1);
  EXPECT_EQ(tree.leaf_at({9, 9}).window, tree.square());
  EXPECT_EQ(tree.leaf_at({9, 9}).value, 5);
}

// ledger: S1-11
TEST(RegionQuadtree, AnIslandNeedsFewerNodesThanPixels) {
  const int side = 256;
  Values island(side * side, 0);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      island[row * side + column] = std::hypot(row - 120, column - 140) < 60 ? 1 : 0;
    }
  }
  const RegionQuadtree tree = tree_of(8, island);
  const auto s = tree.statistics();
  EXPECT_LT(s.leaves + s.internal_nodes, side * side / 20);
  EXPECT_EQ(tree.leaf_at({140, 120}).value, 1);
  EXPECT_GE(tree.leaf_at({140, 120}).window.width, 8);
  EXPECT_EQ(read_all(tree), island);
}

// ledger: S1-15
TEST(RegionQuadtree, ARasterBecomesATreeWithoutANodeThatDoesNotStay) {
  const Values values = terraces(128);
  const RegionQuadtree tree = tree_of(7, values);
  EXPECT_EQ(tree.pool().allocations(), tree.statistics().internal_nodes);
  EXPECT_EQ(tree.pool().free_count(), 0);
  EXPECT_EQ(tree.statistics().internal_nodes, internal_squares(tree).size());
  RegionQuadtree by_pixel(7);
  for (int row = 0; row < 128; ++row) {
    for (int column = 0; column < 128; ++column) by_pixel.fill({column, row, 1, 1}, values[row * 128 + column]);
  }
  EXPECT_TRUE(tree == by_pixel);
  EXPECT_EQ(read_all(tree), values);
  EXPECT_GT(by_pixel.pool().allocations(), tree.pool().allocations()) << "this way makes nodes that merge later";
}

// ledger: S1-15
TEST(RegionQuadtree, PixelsBeyondTheRasterAreOutside) {
  const Values values(10 * 5, 3);
  const auto tree = RegionQuadtree::from_raster(4, values, 10, 5, 8);
  EXPECT_EQ(tree.pool().allocations(), tree.statistics().internal_nodes);
  for (int row = -1; row < 17; ++row) {
    for (int column = -1; column < 17; ++column) {
      const bool on = row >= 0 && row < 5 && column >= 0 && column < 10;
      EXPECT_EQ(tree.at({column, row}), on ? 3 : 8);
    }
  }
}

// ledger: S1-34
TEST(RegionQuadtree, ReadingAWindowVisitsOnlyTheNodesThatOverlapIt) {
  const RegionQuadtree tree = tree_of(8, terraces(256));
  for (const PixelWindow window : {PixelWindow{37, 91, 50, 30}, {0, 0, 1, 1}, {128, 128, 128, 128}, {255, 0, 1, 256}}) {
    Values out(std::size_t(window.width) * std::size_t(window.height));
    const std::size_t visited = tree.read(window, out.data(), window.width);
    std::size_t overlapping = 0;
    for (const auto& square : internal_squares(tree)) overlapping += meets(square, window);
    tree.for_each_leaf(window, [&](std::uint32_t, const PixelWindow&) { ++overlapping; });
    EXPECT_EQ(visited, overlapping);
    EXPECT_LT(visited, (tree.statistics().leaves + tree.statistics().internal_nodes) / 2);
  }
}

// ledger: S1-34
TEST(RegionQuadtree, WindowsReachBeyondTheSquareAndKeepTheRestOfTheArray) {
  RegionQuadtree tree(3, 9);
  tree.fill({0, 0, 8, 8}, 4);
  Values out(12 * 14, 77);
  tree.read({-2, 6, 12, 4}, out.data() + 14, 14);
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 14; ++column) {
      const bool window = row >= 1 && row < 5 && column < 12;
      const bool square = row >= 1 && row < 3 && column >= 2 && column < 10;
      EXPECT_EQ(out[row * 14 + column], square ? 4 : window ? 9 : 77);
    }
  }
}

// ledger: S1-35
TEST(RegionQuadtree, AnArrayIsWrittenBackWithEachNodeLocatedOnce) {
  RegionQuadtree tree = tree_of(8, terraces(256));
  const PixelWindow window{41, 67, 90, 75};  // aligned to nothing
  const auto before = internal_squares(tree);
  Values values(90 * 75);
  Random random(5);
  for (auto& v : values) v = static_cast<std::uint32_t>(random.index(3));
  RegionQuadtree unordered = tree;
  const std::size_t located = tree.write(window, {values.data(), 90});
  EXPECT_EQ(located, std::count_if(before.begin(), before.end(), [&](const auto& s) { return meets(s, window); }));
  std::vector<int> order(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  for (std::size_t i = order.size(); i-- > 1;) std::swap(order[i], order[random.index(i + 1)]);
  for (int i : order) unordered.fill({window.column + i % 90, window.row + i / 90, 1, 1}, values[i]);
  EXPECT_TRUE(tree == unordered);
}

// ledger: S1-30 S1-35
TEST(RegionQuadtree, OnlyChangedPixelsAreWrittenAndOnlyTheirPagesAreCloned) {
  RegionQuadtree tree(9);
  Values values(512 * 512);
  Random random(2);
  for (auto& v : values) v = static_cast<std::uint32_t>(random.index(1000));
  tree.write(tree.square(), {values.data(), 512});
  const RegionQuadtree snapshot = tree;
  const auto pages = snapshot.pool().pages();
  tree.write(tree.square(), {values.data(), 512});
  EXPECT_EQ(tree.pool().shared_pages(snapshot.pool()), pages) << "nothing has changed";
  std::vector<std::uint8_t> changed(512 * 512, 0);
  Values garbage(512 * 512, 0xffffffff);  // no value, and not meant
  changed[100 * 512 + 200] = 1;
  garbage[100 * 512 + 200] = 5000;
  tree.write(tree.square(), {garbage.data(), 512, changed.data(), 512});
  EXPECT_EQ(tree.pool().shared_pages(snapshot.pool()), pages - 1);
  EXPECT_EQ(tree.at({200, 100}), 5000);
  EXPECT_EQ(read_all(snapshot), values);
  values[100 * 512 + 200] = 5000;
  EXPECT_EQ(read_all(tree), values);
}

// ledger: S1-11
TEST(RegionQuadtree, BlocksThatMergeAreUsedAgain) {
  RegionQuadtree tree(8);
  const Values rough = [] {
    Values v(256 * 256);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = static_cast<std::uint32_t>(i);
    return v;
  }();
  for (int i = 0; i < 3; ++i) {
    tree.write(tree.square(), {rough.data(), 256});
    EXPECT_EQ(tree.pool().end(), 21845);  // (4^8 - 1) / 3
    tree.fill(tree.square(), 1);
    EXPECT_EQ(tree.statistics().words, 1);
    EXPECT_EQ(tree.pool().free_count(), 21845);
  }
}

TEST(RegionQuadtree, LeavesComeFromNorthWestToSouthEastClippedToTheWindow) {
  RegionQuadtree tree(2);
  tree.fill({3, 3, 1, 1}, 6);
  std::vector<std::pair<std::uint32_t, PixelWindow>> leaves;
  tree.for_each_leaf({1, 1, 3, 3}, [&](std::uint32_t v, const PixelWindow& w) { leaves.emplace_back(v, w); });
  EXPECT_THAT(leaves,
              testing::ElementsAre(std::pair(0U, PixelWindow{1, 1, 1, 1}), std::pair(0U, PixelWindow{2, 1, 2, 1}),
                                   std::pair(0U, PixelWindow{1, 2, 1, 2}), std::pair(0U, PixelWindow{2, 2, 1, 1}),
                                   std::pair(0U, PixelWindow{3, 2, 1, 1}), std::pair(0U, PixelWindow{2, 3, 1, 1}),
                                   std::pair(6U, PixelWindow{3, 3, 1, 1})));
}

TEST(RegionQuadtree, EqualityIsOfTheContentsNotOfTheOrderOfStorage) {
  RegionQuadtree a(5);
  RegionQuadtree b(5);
  a.fill({1, 2, 1, 1}, 3), a.fill({30, 7, 1, 1}, 4);
  b.fill({30, 7, 1, 1}, 4), b.fill({9, 9, 1, 1}, 1), b.fill({1, 2, 1, 1}, 3), b.fill({9, 9, 1, 1}, 0);
  EXPECT_TRUE(a == b);
  b.fill({9, 9, 1, 1}, 1);
  EXPECT_FALSE(a == b);
  EXPECT_FALSE(RegionQuadtree(4) == RegionQuadtree(5));
}

// ledger: S1-31
TEST(RegionQuadtree, SnapshotsAreReadInOtherThreadsWhileTheMapIsWrittenOn) {
  RegionQuadtree tree = tree_of(6, terraces(64));
  std::vector<std::thread> readers;
  std::vector<Values> expected;
  std::vector<Values> seen(16);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    expected.push_back(read_all(tree));
    readers.emplace_back([snapshot = tree, &out = seen[i]] {
      const RegionQuadtree copy = snapshot;  // readers may copy what they have
      out = read_all(copy);
    });
    tree.fill({static_cast<int>(i), static_cast<int>(2 * i), 20, 11}, static_cast<std::uint32_t>(i));
    tree.fill({63, static_cast<int>(i), 1, 1}, 1000);
  }
  for (auto& reader : readers) reader.join();
  EXPECT_EQ(seen, expected);
}

TEST(RegionQuadtreeDeathTest, ValuesHave31Bits) {
  RegionQuadtree tree(2);
  const Values values(16, 0x80000000);
  EXPECT_DEATH(tree.fill({0, 0, 1, 1}, 0x80000000), "");
  EXPECT_DEATH(tree.write(tree.square(), {values.data(), 4}), "");
  EXPECT_DEATH((void)tree.leaf_at({4, 0}), "");
}

}  // namespace
}  // namespace isobath
