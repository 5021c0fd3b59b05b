#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/map/features/pr_quadtree.hpp>
#include <map>
#include <rapidcheck/gtest.h>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Object = PrQuadtree::Object;

// ledger: S1-20
TEST(PrQuadtree, ABlockSplitsWhileItHoldsMoreThanOnePoint) {
  PrQuadtree tree({0, 0}, 16);
  EXPECT_EQ(tree.insert({1, {1, 1}}), TreeEdit::kDone);
  EXPECT_EQ(tree.internal_nodes(), 0);
  EXPECT_EQ(tree.insert({2, {9, 9}}), TreeEdit::kDone);
  EXPECT_EQ(tree.internal_nodes(), 1);
  EXPECT_EQ(tree.insert({3, {1, 3}}), TreeEdit::kDone);  // 16 -> 8 -> 4 -> 2: apart
  EXPECT_EQ(tree.internal_nodes(), 3);
}

// ledger: S1-20
TEST(PrQuadtree, CoincidentPointsShareABucketAtTheGreatestDepth) {
  PrQuadtree tree({-500, -500}, 1000, 20);
  for (std::uint64_t id = 0; id < 5; ++id) ASSERT_EQ(tree.insert({id, {3, 4}}), TreeEdit::kDone);
  EXPECT_EQ(tree.internal_nodes(), 20);
  EXPECT_THAT(tree.in_window({Vector2d(3, 4), Vector2d(3, 4)}), testing::ElementsAre(0, 1, 2, 3, 4));
}

// Two points are apart if and only if blocks split down to the level that parts them; as deep as side / 2^level goes.
// ledger: S1-20
TEST(PrQuadtree, NeighboursAMillimetreApartEndInDifferentLeaves) {
  PrQuadtree tree({0, 0}, 1024, 32);
  tree.insert({1, {100.0001, 100}});
  tree.insert({2, {100.0011, 100}});
  EXPECT_LT(tree.internal_nodes(), 32) << "apart before the greatest depth, where points share a leaf";
  EXPECT_GE(tree.internal_nodes(), 20) << "1024 m / 2^20 is a millimetre";
  EXPECT_THAT(tree.in_window({Vector2d(100, 99), Vector2d(100.0006, 101)}), testing::ElementsAre(1));
}

TEST(PrQuadtree, EditsThatCannotBeDoneSayWhy) {
  PrQuadtree tree({0, 0}, 10);
  EXPECT_EQ(tree.insert({1, {0, 10}}), TreeEdit::kDone);  // edges belong to it
  EXPECT_EQ(tree.insert({1, {5, 5}}), TreeEdit::kKnownId);
  EXPECT_EQ(tree.insert({2, {5, 10.1}}), TreeEdit::kOutside);
  EXPECT_EQ(tree.insert({2, {5, std::nan("")}}), TreeEdit::kOutside);
  EXPECT_THAT(tree.in_window({Vector2d(0, 0), Vector2d(10, 10)}), testing::ElementsAre(1));
  EXPECT_THAT(tree.in_window({Vector2d(5, 5), Vector2d(5, 5)}), testing::IsEmpty());
}

// ledger: S1-20 S1-21 S1-25 S2-33
RC_GTEST_PROP(PrQuadtreeProperty, FindsWhatAListFindsAfterAnyInsertions, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  const bool on_grid = *rc::gen::arbitrary<bool>();  // many coincide, many lie on the edges of blocks
  const auto position = [&]() -> Vector2d {
    if (on_grid) return {double(random.index(9)) - 4, double(random.index(9)) - 4};
    return {random.uniform(-4, 4), random.uniform(-4, 4)};
  };
  PrQuadtree tree({-4, -4}, 8, 10);
  std::map<std::uint64_t, Object> plain;
  for (int i = 0; i < 120; ++i) {
    const std::uint64_t id = random.index(90);
    const Object object{id, position(), static_cast<std::uint32_t>(random.index(4))};
    const bool known = plain.contains(id);
    RC_ASSERT(tree.insert(object) == (known ? TreeEdit::kKnownId : TreeEdit::kDone));
    plain.emplace(id, object);
    if (i % 10 != 0) continue;
    const double reach = random.index(2) == 0 ? double(random.index(6)) : random.uniform(0, 6);
    const std::uint32_t kinds = random.index(2) == 0 ? kEveryKind : 1 + static_cast<std::uint32_t>(random.index(3));
    const Vector2d p = 1.5 * position();
    const AlignedBox2d window(p - Vector2d(reach, 3), p + Vector2d(3, reach));
    std::vector<std::uint64_t> inside;
    for (const auto& e : plain) {
      const bool meant = kinds == kEveryKind || (e.second.kinds & kinds) != 0;
      if (meant && window.contains(e.second.position)) inside.push_back(e.first);
    }
    RC_ASSERT(tree.in_window(window, kinds) == inside);
    std::vector<std::pair<double, std::uint64_t>> near;  // by distance, then by id
    for (const auto& e : plain) {
      const bool meant = kinds == kEveryKind || (e.second.kinds & kinds) != 0;
      if (meant) near.emplace_back((e.second.position - p).norm(), e.first);
    }
    std::sort(near.begin(), near.end());
    const auto nearest = tree.nearest(p, kinds);
    RC_ASSERT(nearest.has_value() == !near.empty());
    if (nearest) {
      RC_ASSERT(std::pair(nearest->distance, nearest->id) == near.front());
    }
    std::vector<std::pair<double, std::uint64_t>> reached;
    for (const auto& found : tree.within(p, reach, kinds)) reached.emplace_back(found.distance, found.id);
    near.erase(std::find_if(near.begin(), near.end(), [&](const auto& one) { return one.first > reach; }), near.end());
    RC_ASSERT(reached == near);
  }
  PrQuadtree again({-4, -4}, 8, 10);  // the shape is that of what is in it
  for (const auto& e : plain) again.insert(e.second);
  RC_ASSERT(again.internal_nodes() == tree.internal_nodes());
}

// ledger: S1-21
TEST(PrQuadtree, ASearchOfTheNearestVisitsFewNodes) {
  Random random(3);
  PrQuadtree tree({0, 0}, 1000);
  for (std::uint64_t id = 0; id < 10'000; ++id) tree.insert({id, {random.uniform(0, 1000), random.uniform(0, 1000)}});
  for (int i = 0; i < 50; ++i) {
    SearchEffort nearest, within;
    const Vector2d p(random.uniform(-100, 1100), random.uniform(-100, 1100));
    ASSERT_TRUE(tree.nearest(p, kEveryKind, &nearest));
    EXPECT_LT(tree.within(p, 20, kEveryKind, &within).size(), 100u);
    EXPECT_LT(nearest.nodes, tree.internal_nodes() / 20);
    EXPECT_LT(within.nodes, tree.internal_nodes() / 20);
    EXPECT_LT(nearest.objects, 500u);
  }
}

}  // namespace
}  // namespace isobath
