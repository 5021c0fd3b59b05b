// Voxels against plain arithmetic: a map of std::map, lines of sight by cutting each cube, Bayes' rule by hand.
#include <algorithm>
#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/map/voxel/voxel_map.hpp>
#include <map>
#include <set>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

double log_odds_of(double p) { return std::log(p / (1 - p)); }

VoxelIndex random_voxel(Random& random, int reach) {
  VoxelIndex v;
  for (int a = 0; a < 3; ++a) v[a] = static_cast<int>(random.index(2 * reach + 1)) - reach;
  return v;
}

Vector3d random_point(Random& random, double reach) {
  Vector3d p;
  for (int a = 0; a < 3; ++a) p[a] = random.uniform(-reach, reach);
  return p;
}

using Key = std::array<int, 3>;
Key key(const VoxelIndex& v) { return {v.x(), v.y(), v.z()}; }

// ledger: S5-13 S5-15
TEST(VoxelBlocks, HoldWhatAPlainMapHolds) {
  Random random(1);
  VoxelBlocks blocks({-3000, 5000});
  std::map<Key, int> plain;
  for (int i = 0; i < 20'000; ++i) {
    const VoxelIndex v = random_voxel(random, 40);
    const int more = static_cast<int>(random.index(3001)) - 1500;
    blocks.add(v, static_cast<LogOdds16>(more));
    const auto [at, added] = plain.emplace(key(v), 0);
    at->second = std::clamp(at->second + more, -3000, 5000);
  }
  for (int i = -41; i <= 41; ++i) {
    for (int j = -41; j <= 41; ++j) {
      for (int k = -41; k <= 41; ++k) {
        const auto found = plain.find({i, j, k});
        ASSERT_EQ(blocks.at({i, j, k}), found == plain.end() ? kUnseen : found->second) << i << " " << j << " " << k;
      }
    }
  }
}

// ledger: S5-13
TEST(VoxelBlocks, AreMadeWhereSomethingIsSaidAndNowhereElse) {
  VoxelBlocks blocks;
  EXPECT_EQ(blocks.at({3, -4, 5}), kUnseen);
  EXPECT_EQ(blocks.blocks(), 0u) << "reading makes none";
  blocks.add({-1, 0, 15}, 10);
  blocks.add({-16, 15, 0}, 10);
  EXPECT_EQ(blocks.blocks(), 1u) << "the corners of one block";
  blocks.add({-17, 15, 0}, 10);
  EXPECT_EQ(blocks.blocks(), 2u);
  const int far = VoxelBlocks::kFarthest - 1;
  blocks.add({far, -far, far}, 7);
  EXPECT_EQ(blocks.at({far, -far, far}), 7);
  EXPECT_FALSE(VoxelBlocks::holds({VoxelBlocks::kFarthest, 0, 0}));
  EXPECT_EQ(blocks.at({-1, 0, 15}), 10);
}

// ledger: S5-15
TEST(VoxelBlocks, AMillionUpdatesStayWithinTheBounds) {
  VoxelBlocks blocks;
  for (int i = 0; i < 1'000'000; ++i) blocks.add({0, 0, 0}, 1000);
  EXPECT_EQ(blocks.at({0, 0, 0}), blocks.bounds().most);
  EXPECT_NEAR(1 / (1 + std::exp(-to_log_odds(blocks.at({0, 0, 0})))), 0.999, 1e-5);
  for (int i = 0; i < 1'000'000; ++i) blocks.add({0, 0, 0}, -1000);
  EXPECT_EQ(blocks.at({0, 0, 0}), blocks.bounds().least);
}

TEST(VoxelBlocks, EvidenceIsRoundedToTheNearestStepAndSaturates) {
  EXPECT_EQ(to_evidence(0.847), 867);
  EXPECT_EQ(to_evidence(-0.405), -415);
  EXPECT_EQ(to_evidence(1e9), 32767);
  EXPECT_EQ(to_evidence(-1e9), -32767) << "not kUnseen";
  EXPECT_NEAR(to_log_odds(to_evidence(1.2345)), 1.2345, kEvidenceUnit / 2);
}

/// How long a segment is inside of a voxel, by cutting it with the three slabs.
double length_within(const Vector3d& from, const Vector3d& to, const VoxelIndex& v) {
  double enter = 0, leave = 1;
  for (int a = 0; a < 3; ++a) {
    const double way = to[a] - from[a];
    if (way == 0) {
      if (from[a] < v[a] || from[a] >= v[a] + 1) return 0;
      continue;
    }
    const double one = (v[a] - from[a]) / way, other = (v[a] + 1 - from[a]) / way;
    enter = std::max(enter, std::min(one, other));
    leave = std::min(leave, std::max(one, other));
  }
  return std::max(0.0, leave - enter) * (to - from).norm();
}

// Every voxel that the line meets is missed once, the last is hit, and no other is touched.
TEST(VoxelBlocks, ARayPassesEveryVoxelThatItMeets) {
  ISOBATH_NOT_SANITIZED();
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Vector3d from = random_point(random, 12);
    Vector3d to = random_point(random, 12);
    if (i % 5 == 0) to[i % 3] = from[i % 3];  // along a plane of the axes
    if (i % 35 == 0) to[(i + 1) % 3] = from[(i + 1) % 3];
    VoxelBlocks blocks;
    const std::int64_t passed = blocks.insert_ray(from, to, -100, 1000);
    const VoxelIndex last = to.array().floor().cast<int>();
    int met = 0;
    for (int x = -14; x <= 14; ++x) {
      for (int y = -14; y <= 14; ++y) {
        for (int z = -14; z <= 14; ++z) {
          const VoxelIndex v(x, y, z);
          const double length = length_within(from, to, v);
          const LogOdds16 e = blocks.at(v);
          met += e != kUnseen;
          if (v == last) {
            ASSERT_EQ(e, 1000);
          } else if (length > 1e-9) {
            ASSERT_EQ(e, -100) << v.transpose() << " ray " << i;
          } else if (e != kUnseen) {
            ASSERT_GT(length_within(from, to + 1e-9 * Vector3d::Ones(), v) + length, -1.0);
          }
        }
      }
    }
    ASSERT_EQ(met, passed + 1) << "six-connected";
  }
}

TEST(VoxelBlocks, ARayThatIsNoneIsRefused) {
  VoxelBlocks blocks;
  EXPECT_EQ(blocks.insert_ray({NAN, 0, 0}, {1, 1, 1}, -1, 1), 0);
  EXPECT_EQ(blocks.insert_ray({0, 0, 0}, {0, INFINITY, 1}, -1, 1), 0);
  EXPECT_EQ(blocks.insert_ray({0, 0, 0}, {0, 0, 1e9}, -1, 1), 0);
  EXPECT_EQ(blocks.blocks(), 0u);
  EXPECT_EQ(blocks.insert_ray({0.2, 0.2, 0.2}, {0.8, 0.8, 0.8}, -1, 1), 0) << "nothing is passed within one voxel";
  EXPECT_EQ(blocks.at({0, 0, 0}), 1);
  EXPECT_EQ(blocks.insert_ray({0.5, 0.5, 0.5}, {3.5, 0.5, 0.5}, -1, 0), 3) << "one that met nothing";
  EXPECT_EQ(blocks.at({3, 0, 0}), kUnseen);
}

// ledger: S5-14
TEST(VoxelBlocks, TheOrderOfReadingsDoesNotMatter) {
  Random random(3);
  std::vector<std::pair<VoxelIndex, LogOdds16>> readings;
  for (int i = 0; i < 3000; ++i) {
    const VoxelIndex v = random_voxel(random, 3);
    readings.emplace_back(v, static_cast<LogOdds16>(static_cast<int>(random.index(101)) - 50));
  }
  VoxelBlocks forth, back;
  for (const auto& [v, e] : readings) forth.add(v, e);
  std::reverse(readings.begin(), readings.end());
  for (const auto& [v, e] : readings) back.add(v, e);
  for (const auto& [v, e] : readings) ASSERT_EQ(forth.at(v), back.at(v));
}

// By any whole voxels, with what is older left where it is. ledger: S5-13 S6-53
TEST(VoxelBlocks, MoveWhatIsNewAndLeaveWhatIsOld) {
  Random random(11);
  for (int round = 0; round < 12; ++round) {
    const VoxelIndex by = random_voxel(random, round < 6 ? 5 : 90);
    VoxelBlocks blocks({-3000, 5000});
    std::map<Key, int> old_evidence, new_evidence;
    blocks.begin(1);
    for (int i = 0; i < 3000; ++i) {
      const VoxelIndex v = random_voxel(random, 40);
      const int more = static_cast<int>(random.index(2001)) - 1000;
      blocks.add(v, static_cast<LogOdds16>(more));
      old_evidence[key(v)] = std::clamp(old_evidence[key(v)] + more, -3000, 5000);
    }
    blocks.begin(2);
    for (int i = 0; i < 3000; ++i) {
      const VoxelIndex v = random_voxel(random, 20) + VoxelIndex(-10, 30, 5);
      const int more = static_cast<int>(random.index(2001)) - 1000;
      blocks.add(v, static_cast<LogOdds16>(more));
      new_evidence[key(v)] += more;
    }
    // A block moves as a whole: what was in it before, too.
    const auto block_of = [](const Key& v) { return Key{v[0] >> 4, v[1] >> 4, v[2] >> 4}; };
    std::set<Key> moved_blocks;
    for (const auto& [v, e] : new_evidence) moved_blocks.insert(block_of(v));
    std::map<Key, int> expected, moved;
    for (const auto& [v, e] : old_evidence) (moved_blocks.count(block_of(v)) ? moved : expected)[v] = e;
    for (const auto& [v, e] : new_evidence) moved[v] = blocks.at({v[0], v[1], v[2]});
    for (const auto& [v, e] : moved) {
      int& at = expected[{v[0] + by.x(), v[1] + by.y(), v[2] + by.z()}];
      at = std::clamp(at + e, -3000, 5000);
    }
    blocks.begin(3);
    blocks.move(by, 1);
    std::size_t seen = 0;
    blocks.for_each(0, [&](const VoxelBlocks::Block& b) {
      for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
        if (b.evidence[i] == kUnseen) continue;
        const auto found = expected.find(key(b.corner + VoxelBlocks::place_of(i)));
        ASSERT_NE(found, expected.end());
        ASSERT_EQ(b.evidence[i], found->second);
        ++seen;
      }
    });
    EXPECT_EQ(seen, expected.size()) << "by " << by.transpose();
  }
  VoxelBlocks far;
  far.add({VoxelBlocks::kFarthest - 40, 0, 0}, 5);
  far.move({100, 0, 0}, 0);
  EXPECT_EQ(far.blocks(), 0u) << "beyond the end of all maps";
}

TEST(VoxelBlocks, WhatLeavesTheWindowIsShownAndForgotten) {
  Random random(4);
  VoxelBlocks blocks;
  std::map<Key, LogOdds16> plain;
  for (int i = 0; i < 4000; ++i) {
    const VoxelIndex v = random_voxel(random, 200);
    const auto e = static_cast<LogOdds16>(1 + random.index(100));
    if (plain.emplace(key(v), e).second) blocks.add(v, e);
  }
  const std::size_t before = blocks.blocks();
  const VoxelIndex least(-50, -200, 0), most(100, 30, 200);
  std::size_t shown = 0;
  const std::size_t gone = blocks.keep_within(least, most, [&](const VoxelBlocks::Block&) { ++shown; });
  EXPECT_EQ(gone, shown);
  EXPECT_EQ(blocks.blocks(), before - gone);
  EXPECT_GT(gone, 100u);
  for (const auto& [at, e] : plain) {
    const VoxelIndex v(at[0], at[1], at[2]);
    const VoxelIndex corner = v.unaryExpr([](int c) { return c & ~(VoxelBlocks::kSide - 1); });
    const bool kept =
        ((corner.array() + VoxelBlocks::kSide - 1) >= least.array()).all() && (corner.array() <= most.array()).all();
    ASSERT_EQ(blocks.at(v), kept ? e : kUnseen);
  }
  const std::size_t bytes = blocks.bytes();
  for (int i = 0; i < 200; ++i) blocks.add({1000 + 16 * i, 0, 0}, 1);
  EXPECT_EQ(blocks.bytes(), bytes) << "their room is used again";
}

// Several sensors ----------------------------------------------------------------------------------------------------

// The paper's example, with its two likelihoods the right way round. ledger: S5-14 S5-17 S5-E01 S5-E12
TEST(VoxelMap, AReadingIsBayesRule) {
  VoxelMapConfig config;
  config.prior = 0.6;
  VoxelMap map(config);
  map.layer("horizontal").add({0, 0, 0}, to_evidence(std::log(0.2 / 0.4)));
  EXPECT_NEAR(map.probability({0, 0, 0}), 3.0 / 7, 2e-4);
  EXPECT_NEAR(map.probability({9, 0, 0}), 0.6, 2e-4) << "the prior, where nobody looked";
  map.layer("horizontal").add({0, 0, 0}, to_evidence(std::log(0.3 / 0.3)));
  EXPECT_NEAR(map.probability({0, 0, 0}), 3.0 / 7, 2e-4) << "what is as likely either way says nothing";
}

// ledger: S5-28 S5-29 S5-E13
TEST(VoxelMap, PoolsSensorsAsOneJudgeOfAllTheirReadingsWould) {
  EXPECT_EQ(VoxelMap().probability({0, 0, 0}), 0.5);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    VoxelMapConfig config;
    config.prior = random.uniform(0.05, 0.95);
    VoxelMap map(config);
    double joint = log_odds_of(config.prior);
    const int sensors = 1 + static_cast<int>(random.index(4));
    for (int s = 0; s < sensors; ++s) {
      const double ratio = std::exp(random.uniform(-3, 3));
      map.layer("sensor " + std::to_string(s)).add({1, 1, 1}, to_evidence(std::log(ratio)));
      joint += std::log(ratio);
    }
    EXPECT_NEAR(map.log_odds({1, 1, 1}), joint, kEvidenceUnit * (sensors + 1) / 2);
  }
  VoxelMap map;
  map.layer("a").add({0, 0, 0}, to_evidence(log_odds_of(0.7)));
  map.layer("b").add({0, 0, 0}, to_evidence(log_odds_of(0.35)));
  EXPECT_NEAR(map.probability({0, 0, 0}), 0.5568, 3e-4);
  VoxelMapConfig config;
  config.prior = 0.2;
  VoxelMap scarce(config);
  scarce.layer("a").add({0, 0, 0}, to_evidence(std::log(0.7 / 0.3)));
  scarce.layer("b").add({0, 0, 0}, to_evidence(std::log(0.2 / 0.5)));
  EXPECT_NEAR(scarce.probability({0, 0, 0}), 0.1892, 2e-4) << "the printed rule gives 0.0551";
}

// ledger: S5-27 S5-30
TEST(VoxelMap, ASensorJoinsAndLeavesTheOthersAlone) {
  VoxelMap map;
  map.layer("horizontal").add({0, 0, 0}, 700);
  const double before = map.probability({0, 0, 0});
  EXPECT_EQ(map.find_layer("side"), nullptr);
  VoxelBlocks& side = map.layer("side");
  side.add({0, 0, 0}, 900);
  side.add({5, 0, 0}, 900);
  EXPECT_GT(map.probability({0, 0, 0}), before);
  EXPECT_THAT(map.sensors(), testing::ElementsAre("horizontal", "side"));
  EXPECT_TRUE(map.is_seen({5, 0, 0}));
  EXPECT_EQ(map.find_layer("side"), &side);
  EXPECT_EQ(map.find_layer("horizontal")->at({0, 0, 0}), 700);
  EXPECT_EQ(map.find_layer("horizontal")->at({5, 0, 0}), kUnseen);
}

// ledger: S5-32 S5-33
TEST(VoxelMap, ThreeClassesForPlanning) {
  VoxelMap map;
  VoxelBlocks& layer = map.layer("a");
  const auto space_of = [&](double p) {
    static int next = 0;
    const VoxelIndex v(++next, 0, 0);
    layer.add(v, to_evidence(log_odds_of(p)));
    return map.space(v);
  };
  EXPECT_EQ(map.space({0, 0, 7}), Space::kUnknown) << "never looked at";
  EXPECT_EQ(space_of(0.98), Space::kOccupied);
  EXPECT_EQ(space_of(0.9798), Space::kUnknown);
  EXPECT_EQ(space_of(0.2), Space::kFree);
  EXPECT_EQ(space_of(0.2003), Space::kUnknown);
  layer.add({0, 5, 0}, to_evidence(log_odds_of(0.98)));
  map.layer("b").add({0, 5, 0}, to_evidence(log_odds_of(0.02)));
  EXPECT_EQ(map.probability({0, 5, 0}), 0.5);
  EXPECT_EQ(map.space({0, 5, 0}), Space::kUnknown) << "two that contradict each other";
  VoxelMapConfig config;
  config.prior = 0.1;
  EXPECT_EQ(VoxelMap(config).space({0, 0, 0}), Space::kUnknown) << "a low prior is no look";
}

TEST(VoxelMap, SaysWhichBlocksHaveChanged) {
  VoxelMap map;
  map.layer("a").add({0, 0, 0}, 5);
  map.layer("b").add({1, 1, 1}, 5);
  map.layer("b").add({-20, 0, 0}, 5);
  EXPECT_THAT(map.changed_after(0), testing::ElementsAre(VoxelIndex(-32, 0, 0), VoxelIndex(0, 0, 0))) << "each once";
  const std::uint64_t seen = map.revision();
  EXPECT_TRUE(map.changed_after(seen).empty());
  map.advance();
  map.layer("a").add({40, 0, 0}, 5);
  map.layer("c").add({0, 40, 0}, 5);
  EXPECT_THAT(map.changed_after(seen), testing::ElementsAre(VoxelIndex(0, 32, 0), VoxelIndex(32, 0, 0)));
}

TEST(VoxelMap, AWindowBoundsItsMemory) {
  VoxelMap map;
  std::size_t most = 0;
  for (int step = 0; step < 400; ++step) {
    const Vector3d at(step, 0, 5);
    for (const double side : {-10.0, 0.0, 10.0}) map.layer("a").add(map.voxel_at(at + Vector3d(0, side, 0)), 5);
    map.keep_within(at, {30, 30, 30});
    most = std::max(most, map.bytes());
  }
  EXPECT_EQ(map.bytes(), most) << "it grew at the start and never again";
  EXPECT_LE(map.find_layer("a")->blocks(), 3u * 9);
  EXPECT_TRUE(map.is_seen(map.voxel_at({399, 10, 5})));
  EXPECT_FALSE(map.is_seen(map.voxel_at({300, 10, 5})));
}

TEST(VoxelMap, AVoxelIsACubeOfTheWorld) {
  const VoxelMap map;
  EXPECT_EQ(map.voxel_at({0.1, -0.1, 0.25}), VoxelIndex(0, -1, 1));
  EXPECT_EQ(map.centre_of({0, -1, 1}), Vector3d(0.125, -0.125, 0.375));
}

TEST(VoxelMap, RefusesWhatIsNoMap) {
  const auto problem = [](auto change) {
    VoxelMapConfig config;
    change(config);
    try {
      VoxelMap map(config);
      return std::string();
    } catch (const Error& e) {
      return std::string(e.what());
    }
  };
  EXPECT_THAT(problem([](VoxelMapConfig& c) { c.voxel_m = 0; }), testing::HasSubstr("voxel_m: a voxel needs a size"));
  EXPECT_THAT(problem([](VoxelMapConfig& c) { c.voxel_m = NAN; }), testing::HasSubstr("voxel_m"));
  EXPECT_THAT(problem([](VoxelMapConfig& c) { c.prior = 1; }), testing::HasSubstr("prior"));
  EXPECT_THAT(problem([](VoxelMapConfig& c) { c.free = 0.99; }), testing::HasSubstr("overlap"));
  EXPECT_EQ(problem([](VoxelMapConfig&) {}), "");
}

}  // namespace
}  // namespace isobath
