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
using Found = PrQuadtree::Found;

std::vector<std::uint64_t> ids(const std::vector<Found>& found) {
  std::vector<std::uint64_t> all;
  for (const Found& f : found) all.push_back(f.id);
  return all;
}

// ledger: S1-20
TEST(PrQuadtree, ABlockSplitsWhileItHoldsMoreThanOnePoint) {
  PrQuadtree tree({0, 0}, 16);
  EXPECT_EQ(tree.insert({1, {1, 1}}), TreeEdit::kDone);
  EXPECT_EQ(tree.internal_nodes(), 0);
  EXPECT_EQ(tree.insert({2, {9, 9}}), TreeEdit::kDone);
  EXPECT_EQ(tree.internal_nodes(), 1);
  EXPECT_EQ(tree.insert({3, {1, 3}}), TreeEdit::kDone);  // 16 -> 8 -> 4 -> 2: apart
  EXPECT_EQ(tree.internal_nodes(), 3);
  EXPECT_EQ(tree.erase(3), TreeEdit::kDone);
  EXPECT_EQ(tree.internal_nodes(), 1);
  EXPECT_EQ(tree.erase(2), TreeEdit::kDone);
  EXPECT_EQ(tree.internal_nodes(), 0);
}

// ledger: S1-20
TEST(PrQuadtree, CoincidentPointsShareABucketAtTheGreatestDepth) {
  PrQuadtree tree({-500, -500}, 1000, 20);
  for (std::uint64_t id = 0; id < 5; ++id) ASSERT_EQ(tree.insert({id, {3, 4}}), TreeEdit::kDone);
  EXPECT_EQ(tree.internal_nodes(), 20);
  EXPECT_THAT(ids(tree.within({0, 0}, 5)), testing::ElementsAre(0, 1, 2, 3, 4));
  EXPECT_EQ(tree.nearest({0, 0})->id, 0);
  for (std::uint64_t id : {2, 0, 4, 1}) {
    EXPECT_EQ(tree.erase(id), TreeEdit::kDone);
    EXPECT_EQ(tree.internal_nodes(), tree.size() > 1 ? 20 : 0);
  }
  EXPECT_EQ(tree.nearest({0, 0})->id, 3);
}

// Two points are apart if and only if blocks split down to the level that parts them; as deep as side / 2^level goes.
// ledger: S1-20
TEST(PrQuadtree, NeighboursAMillimetreApartEndInDifferentLeaves) {
  PrQuadtree tree({0, 0}, 1024, 32);
  tree.insert({1, {100.0001, 100}});
  tree.insert({2, {100.0011, 100}});
  SearchEffort effort;
  EXPECT_EQ(tree.nearest({100.0001, 100}, kEveryKind, &effort)->id, 1);
  EXPECT_EQ(effort.objects, 1);
  EXPECT_LE(tree.internal_nodes(), 32);
}

TEST(PrQuadtree, EditsThatCannotBeDoneSayWhy) {
  PrQuadtree tree({0, 0}, 10);
  EXPECT_EQ(tree.insert({1, {0, 10}}), TreeEdit::kDone);  // edges belong to it
  EXPECT_EQ(tree.insert({1, {5, 5}}), TreeEdit::kKnownId);
  EXPECT_EQ(tree.insert({2, {5, 10.1}}), TreeEdit::kOutside);
  EXPECT_EQ(tree.insert({2, {5, std::nan("")}}), TreeEdit::kOutside);
  EXPECT_EQ(tree.erase(2), TreeEdit::kUnknownId);
  EXPECT_EQ(tree.move(2, {5, 5}), TreeEdit::kUnknownId);
  EXPECT_EQ(tree.move(1, {-1, 5}), TreeEdit::kOutside);
  EXPECT_EQ(tree.object(1)->position, Vector2d(0, 10));
  EXPECT_EQ(tree.size(), 1);
  EXPECT_FALSE(tree.object(2));
  EXPECT_FALSE(PrQuadtree({0, 0}, 1).nearest({0, 0}));
}

// ledger: S1-21
TEST(PrQuadtree, TheNearestOtherVehicleIsFoundByItsKind) {
  constexpr std::uint32_t kVehicle = 1;
  constexpr std::uint32_t kBuoy = 2;
  PrQuadtree tree({0, 0}, 1000);
  tree.insert({7, {10, 0}, kBuoy});
  tree.insert({8, {30, 40}, kVehicle});
  tree.insert({9, {300, 0}, kVehicle | kBuoy});
  tree.insert({10, {1, 1}, 0});
  EXPECT_EQ(tree.nearest({0, 0}, kVehicle)->id, 8);
  EXPECT_EQ(tree.nearest({0, 0}, kVehicle)->distance, 50);
  EXPECT_EQ(tree.nearest({0, 0})->id, 10) << "every kind, and none";
  EXPECT_THAT(ids(tree.within({0, 0}, 300, kBuoy)), testing::ElementsAre(7, 9));
  tree.move(9, {0, 2});
  EXPECT_EQ(tree.nearest({0, 0}, kVehicle)->id, 9);
  EXPECT_FALSE(tree.nearest({0, 0}, 4));
}

// ledger: S1-21 S1-25
TEST(PrQuadtree, ASearchVisitsAFewOfAllNodes) {
  PrQuadtree tree({0, 0}, 1000);
  Random random(4);
  for (std::uint64_t id = 0; id < 10000; ++id) tree.insert({id, {random.uniform(0, 1000), random.uniform(0, 1000)}});
  const std::size_t nodes = 4 * tree.internal_nodes() + 1;
  for (int i = 0; i < 100; ++i) {
    SearchEffort effort;
    ASSERT_TRUE(tree.nearest({random.uniform(0, 1000), random.uniform(0, 1000)}, kEveryKind, &effort));
    EXPECT_LT(effort.nodes, nodes / 200);
    EXPECT_LT(effort.objects, 20);
  }
}

/// The slow, obvious list.
struct Plain {
  std::map<std::uint64_t, Object> objects;

  [[nodiscard]] std::vector<std::pair<double, std::uint64_t>> by_distance(const Vector2d& p,
                                                                          std::uint32_t kinds) const {
    std::vector<std::pair<double, std::uint64_t>> all;
    for (const auto& entry : objects) {
      const Object& o = entry.second;
      if (kinds == kEveryKind || (o.kinds & kinds) != 0) all.emplace_back((o.position - p).norm(), o.id);
    }
    std::sort(all.begin(), all.end());
    return all;
  }
};

void check(const PrQuadtree& tree, const Plain& plain, const Vector2d& p, double radius, std::uint32_t kinds) {
  const auto expected = plain.by_distance(p, kinds);
  const auto nearest = tree.nearest(p, kinds);
  RC_ASSERT(nearest.has_value() == !expected.empty());
  if (nearest) RC_ASSERT(std::pair(nearest->distance, nearest->id) == expected.front());
  const auto some = tree.nearest(p, 5, kinds);
  RC_ASSERT(some.size() == std::min<std::size_t>(5, expected.size()));
  for (std::size_t i = 0; i < some.size(); ++i) RC_ASSERT(std::pair(some[i].distance, some[i].id) == expected[i]);
  const auto within = tree.within(p, radius, kinds);
  const auto beyond = std::find_if(expected.begin(), expected.end(), [&](const auto& e) { return e.first > radius; });
  RC_ASSERT(within.size() == std::size_t(beyond - expected.begin()));
  for (std::size_t i = 0; i < within.size(); ++i) RC_ASSERT(within[i].id == expected[i].second);
  const AlignedBox2d window(p - Vector2d(radius, 3), p + Vector2d(3, radius));
  std::vector<std::uint64_t> inside;
  for (const auto& e : plain.objects) {
    const bool meant = kinds == kEveryKind || (e.second.kinds & kinds) != 0;
    if (meant && window.contains(e.second.position)) inside.push_back(e.first);
  }
  RC_ASSERT(tree.in_window(window, kinds) == inside);
}

// ledger: S1-20 S1-21
RC_GTEST_PROP(PrQuadtreeProperty, FindsWhatAListFindsAfterAnyEdits, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  const bool on_grid = *rc::gen::arbitrary<bool>();  // many coincide, many lie on the edges of blocks
  const auto position = [&]() -> Vector2d {
    if (on_grid) return {double(random.index(9)) - 4, double(random.index(9)) - 4};
    return {random.uniform(-4, 4), random.uniform(-4, 4)};
  };
  PrQuadtree tree({-4, -4}, 8, 10);
  Plain plain;
  for (int i = 0; i < 120; ++i) {
    const std::uint64_t id = random.index(60);
    const Object object{id, position(), static_cast<std::uint32_t>(random.index(4))};
    const bool known = plain.objects.contains(id);
    switch (random.index(4)) {
      case 0: RC_ASSERT((tree.erase(id) == TreeEdit::kDone) == known), plain.objects.erase(id); break;
      case 1:
        RC_ASSERT((tree.move(id, object.position) == TreeEdit::kDone) == known);
        if (known) plain.objects[id].position = object.position;
        break;
      default:
        RC_ASSERT((tree.insert(object) == TreeEdit::kDone) == !known);
        plain.objects.emplace(id, object);
        break;
    }
    RC_ASSERT(tree.size() == plain.objects.size());
    if (i % 10 != 0) continue;
    const Vector2d p = 1.5 * position();
    check(tree, plain, p, random.index(2) == 0 ? double(random.index(6)) : random.uniform(0, 6),
          random.index(2) == 0 ? kEveryKind : 1 + static_cast<std::uint32_t>(random.index(3)));
  }
  PrQuadtree again({-4, -4}, 8, 10);  // the shape is that of what is in it
  for (const auto& e : plain.objects) again.insert(e.second);
  RC_ASSERT(again.internal_nodes() == tree.internal_nodes());
}

}  // namespace
}  // namespace isobath
