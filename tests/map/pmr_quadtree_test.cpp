#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/map/features/pmr_quadtree.hpp>
#include <map>
#include <numbers>
#include <rapidcheck/gtest.h>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Segment = PmrQuadtree::Segment;

SearchEffort effort_at(const PmrQuadtree& tree, const Vector2d& point) {
  SearchEffort effort;
  EXPECT_TRUE(tree.nearest(point, &effort));
  return effort;
}

// ledger: S1-22
TEST(PmrQuadtree, TheFifthSegmentOfABlockSplitsItOnce) {
  PmrQuadtree tree({0, 0}, 16);
  for (std::uint64_t id = 0; id < 4; ++id) tree.insert({id, {1, 1 + 0.1 * double(id)}, {2, 1 + 0.1 * double(id)}});
  EXPECT_EQ(effort_at(tree, {1, 1}).nodes, 1) << "one leaf";
  tree.insert({4, {1, 2}, {2, 2}});  // all five in the south-west quadrant
  EXPECT_EQ(effort_at(tree, {1, 1}).nodes, 2);
  EXPECT_EQ(effort_at(tree, {1, 1}).objects, 5) << "the child is not split by the same insertion";
  tree.insert({5, {1, 2.5}, {2, 2.5}});
  EXPECT_EQ(effort_at(tree, {1, 1}).nodes, 3);
  tree.insert({6, {15, 15}, {15, 15}});  // elsewhere: nothing splits
  EXPECT_EQ(effort_at(tree, {1, 1}).nodes, 3);
  EXPECT_EQ(effort_at(tree, {15, 15}).nodes, 2);
}

// ledger: S1-22
TEST(PmrQuadtree, ALeafListsEverySegmentThatCrossesIt) {
  PmrQuadtree tree({0, 0}, 16, 1);
  tree.insert({1, {1, 1}, {15, 15}});
  tree.insert({2, {2, 14}, {3, 14}});
  for (const Vector2d& on_diagonal : {Vector2d(4, 4), Vector2d(12, 12)}) {
    EXPECT_EQ(tree.nearest(on_diagonal)->id, 1);
    EXPECT_EQ(effort_at(tree, on_diagonal).nodes, 2) << "the root and the leaf at hand";
  }
  // The diagonal lies in SW and NE and touches the corners of the others; closed blocks count it there, too.
  EXPECT_EQ(effort_at(tree, {2.5, 14}).nodes, 2);
  EXPECT_EQ(effort_at(tree, {2.5, 14}).objects, 2);
}

TEST(PmrQuadtree, ManySegmentsThroughOnePointEndAtTheGreatestDepth) {
  PmrQuadtree tree({0, 0}, 100, 4, 6);
  for (std::uint64_t id = 0; id < 60; ++id) {
    const double angle = 0.05 * double(id);
    tree.insert({id, {33, 33}, {33 + 20 * std::cos(angle), 33 + 20 * std::sin(angle)}});
  }
  EXPECT_EQ(effort_at(tree, {33, 33}).nodes, 7) << "the root and six levels";
  EXPECT_EQ(effort_at(tree, {33, 33}).objects, 60);
  EXPECT_EQ(tree.nearest({33, 33})->id, 0);
  EXPECT_EQ(tree.in_window({Vector2d(33, 33), Vector2d(33, 33)}).size(), 60);
}

// ledger: S1-22
TEST(PmrQuadtree, OnlyThePartInsideTheSquareCounts) {
  PmrQuadtree tree({0, 0}, 10);
  EXPECT_EQ(tree.insert({1, {-5, 5}, {5, 5}}), TreeEdit::kDone);
  EXPECT_EQ(tree.insert({2, {-5, 1}, {-1, 9}}), TreeEdit::kOutside);
  EXPECT_EQ(tree.insert({3, {-2, 9}, {9, -2.5}}), TreeEdit::kDone);
  EXPECT_EQ(tree.insert({3, {1, 1}, {2, 2}}), TreeEdit::kKnownId);
  EXPECT_EQ(tree.insert({4, {1, 1}, {2, INFINITY}}), TreeEdit::kOutside);
  EXPECT_EQ(tree.insert({5, {15, 8}, {8, 15}}), TreeEdit::kOutside) << "its box meets the square, it does not";
  EXPECT_EQ(tree.nearest({-3, 5})->foot, Vector2d(0, 5));
  EXPECT_EQ(tree.nearest({-3, 5})->distance, 3);
}

// ledger: S1-23
TEST(PmrQuadtree, TheFootPointIsTheClampedProjection) {
  PmrQuadtree tree({0, 0}, 10);
  EXPECT_FALSE(tree.nearest({1, 1}));
  tree.insert({1, {2, 2}, {6, 2}});
  EXPECT_EQ(tree.nearest({3, 4})->foot, Vector2d(3, 2));
  EXPECT_EQ(tree.nearest({3, 4})->distance, 2);
  EXPECT_EQ(tree.nearest({9, 6})->foot, Vector2d(6, 2));
  EXPECT_EQ(tree.nearest({9, 6})->distance, 5);
  tree.insert({2, {9, 9}, {9, 9}});  // a point
  EXPECT_EQ(tree.nearest({10, 10})->foot, Vector2d(9, 9));
}

// ledger: S1-23 S1-25
TEST(PmrQuadtree, EachSegmentIsTestedOnce) {
  // Twenty chords of a circle: from its centre all are nearest, and each lies in many leaves that must be looked at.
  PmrQuadtree tree({0, 0}, 100, 1, 7);
  const auto corner = [](std::uint64_t i) {
    const double angle = 0.1 * std::numbers::pi * double(i);
    return Vector2d(50 + 40 * std::cos(angle), 50 + 40 * std::sin(angle));
  };
  for (std::uint64_t id = 0; id < 20; ++id) tree.insert({id, corner(id), corner(id + 1)});
  for (std::uint64_t id = 20; id < 40; ++id) tree.insert({id, corner(id) * 1.01, corner(id + 1) * 1.01});
  const SearchEffort effort = effort_at(tree, {50, 50});
  EXPECT_LE(effort.objects, 40);
  EXPECT_GT(effort.nodes, 40);
}

// ledger: S1-23 S1-25
TEST(PmrQuadtree, ASearchVisitsAFewOfAllNodes) {
  PmrQuadtree tree({0, 0}, 100);
  for (std::uint64_t id = 0; id < 50; ++id) tree.insert({id, {0, 2.0 * double(id)}, {100, 2.0 * double(id) + 1}});
  const SearchEffort effort = effort_at(tree, {50, 50});
  EXPECT_LT(effort.objects, 15);
  EXPECT_LT(effort.nodes, 50) << "fewer than there are segments";
}

// Distance from a point to a segment by ternary search: no projection in it.
double distance_to(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  double low = 0;
  double high = 1;
  const auto at = [&](double t) { return (a + t * (b - a) - p).norm(); };
  for (int i = 0; i < 100; ++i) {
    const double left = low + (high - low) / 3;
    const double right = high - (high - low) / 3;
    (at(left) < at(right) ? high : low) = at(left) < at(right) ? right : left;
  }
  return at(0.5 * (low + high));
}

// Whether a segment meets a rectangle: an end inside, or a crossing of an edge (exact for coordinates of few bits).
bool meets(const Segment& s, const AlignedBox2d& box) {
  if (box.contains(s.a) || box.contains(s.b)) return true;
  const auto side = [](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    const double cross = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
    return cross > 0 ? 1 : cross < 0 ? -1 : 0;
  };
  const auto on = [&](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return side(a, b, c) == 0 && AlignedBox2d(a.cwiseMin(b), a.cwiseMax(b)).contains(c);
  };
  const std::array<Vector2d, 4> corner{box.min(), Vector2d(box.min().x(), box.max().y()), box.max(),
                                       Vector2d(box.max().x(), box.min().y())};
  for (int i = 0; i < 4; ++i) {
    const Vector2d& c = corner[i];
    const Vector2d& d = corner[(i + 1) % 4];
    if (side(s.a, s.b, c) * side(s.a, s.b, d) < 0 && side(c, d, s.a) * side(c, d, s.b) < 0) return true;
    if (on(s.a, s.b, c) || on(c, d, s.a) || on(c, d, s.b)) return true;
  }
  return false;
}

using Plain = std::map<std::uint64_t, Segment>;

void check(const PmrQuadtree& tree, const Plain& plain, const Vector2d& p) {
  std::vector<std::pair<double, std::uint64_t>> expected;
  for (const auto& e : plain) expected.emplace_back(distance_to(e.second.a, e.second.b, p), e.first);
  std::sort(expected.begin(), expected.end());
  const auto nearest = tree.nearest(p);
  RC_ASSERT(nearest.has_value() == !expected.empty());
  if (nearest) {
    const Segment& s = plain.at(nearest->id);
    RC_ASSERT(std::abs(nearest->distance - expected.front().first) < 1e-6);
    RC_ASSERT(std::abs((nearest->foot - p).norm() - nearest->distance) < 1e-9);
    RC_ASSERT(distance_to(s.a, s.b, nearest->foot) < 1e-6);
  }
  const AlignedBox2d window(p - Vector2d(2, 1), p + Vector2d(3, 5));
  std::vector<std::uint64_t> inside;
  for (const auto& e : plain) {
    if (meets(e.second, window)) inside.push_back(e.first);
  }
  RC_ASSERT(tree.in_window(window) == inside);
}

// ledger: S1-22 S1-23 S1-25 S2-33
RC_GTEST_PROP(PmrQuadtreeProperty, FindsWhatAListFindsAfterAnyInsertions, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  const int threshold = *rc::gen::element(1, 2, 4, 8);
  const int levels = *rc::gen::element(0, 3, 9);
  // Coordinates are eighths, so that the window test above is exact; on whole numbers many touch blocks' edges.
  const double unit = *rc::gen::element(1.0, 0.125);
  const auto point = [&]() -> Vector2d {
    const auto steps = static_cast<std::uint64_t>(std::lround(16 / unit)) + 1;
    return {-8 + unit * double(random.index(steps)), -8 + unit * double(random.index(steps))};
  };
  PmrQuadtree tree({-8, -8}, 16, threshold, levels);
  Plain plain;
  for (int i = 0; i < 80; ++i) {
    const std::uint64_t id = random.index(50);
    const bool known = plain.contains(id);
    const Vector2d a = point();
    const Segment s{
        id, a, random.index(3) == 0 ? point() : Vector2d((a + 0.25 * unit * Vector2d(4, -8)).cwiseMax(-8).cwiseMin(8))};
    RC_ASSERT(tree.insert(s) == (known ? TreeEdit::kKnownId : TreeEdit::kDone));
    plain.emplace(id, s);
    if (i % 20 == 19) check(tree, plain, 1.25 * point());
  }
}

}  // namespace
}  // namespace isobath
