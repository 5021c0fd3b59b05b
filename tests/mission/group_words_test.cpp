// Packets of a group: what goes in comes out, and nothing else is a packet.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/mission/messages/group_words.hpp>

namespace isobath {
namespace {

GroupStatus some_status(Random& random) {
  GroupStatus s;
  s.from = static_cast<std::uint8_t>(random.index(8));
  s.number = static_cast<std::uint16_t>(random.index(65536));
  s.place_W = {0.5 * (static_cast<double>(random.index(60000)) - 30000),
               -0.5 * static_cast<double>(random.index(30000))};
  s.lanes = static_cast<std::uint8_t>(random.index(kMaxLanes + 1));
  if (s.lanes > 0 && random.uniform() < 0.5) s.lane = static_cast<std::uint8_t>(random.index(s.lanes));
  s.stations = static_cast<std::uint8_t>(random.index(256));
  s.backwards = random.uniform() < 0.5;
  if (random.uniform() < 0.5) s.leader = static_cast<std::uint8_t>(random.index(8));
  s.version = static_cast<std::uint16_t>(random.index(65536));
  s.over = random.uniform() < 0.5;
  s.ready = random.uniform() < 0.5;
  if (random.uniform() < 0.5) s.begin_s = static_cast<std::uint16_t>(random.index(65536));
  for (std::size_t k = 0; k < s.lanes; ++k) s.done |= LaneBits{random.uniform() < 0.5} << k;
  s.no_way = random.uniform() < 0.5;
  if (random.uniform() < 0.5) {
    s.ask = PassageAsk{static_cast<std::uint8_t>(random.index(kMaxPassages)),
                       static_cast<std::uint8_t>(random.index(256)), random.uniform() < 0.5};
  }
  s.turns.resize(random.index(3) * random.index(kMaxPassages / 2));
  for (PassageTurn& turn : s.turns) {
    turn = {static_cast<std::uint8_t>(random.index(kMaxPassages)), static_cast<std::uint8_t>(random.index(8)),
            static_cast<std::uint8_t>(random.index(256))};
  }
  s.obstacles.resize(random.index(kMostTold + 1));
  for (ObstacleWord& o : s.obstacles) {
    o.key = static_cast<std::uint8_t>(random.index(256));
    o.centre_W = {0.5 * static_cast<double>(random.index(30000)), -0.5 * static_cast<double>(random.index(30000))};
    o.radius_m = 0.25 * static_cast<double>(random.index(256));
    o.sigma_m = 0.25 * static_cast<double>(random.index(256));
  }
  return s;
}

GroupPlan some_plan(Random& random) {
  GroupPlan p;
  p.from = static_cast<std::uint8_t>(random.index(8));
  p.version = static_cast<std::uint16_t>(random.index(65536));
  p.ascending = random.uniform() < 0.5;
  p.owner.resize(random.index(kMaxLanes + 1));
  for (std::size_t k = 0; k < p.owner.size(); ++k) {
    p.done |= LaneBits{random.uniform() < 0.5} << k;
    if (random.uniform() < 0.8) p.owner[k] = static_cast<std::uint8_t>(random.index(8));
  }
  return p;
}

// ledger: S2-51
TEST(GroupWords, ComeBackAsTheyWere) {
  Random random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const GroupStatus status = some_status(random);
    const auto read = group_word_of(to_bytes(status));
    ASSERT_TRUE(read);
    EXPECT_EQ(std::get<GroupStatus>(*read), status);
    const GroupPlan plan = some_plan(random);
    const auto read_plan = group_word_of(to_bytes(plan));
    ASSERT_TRUE(read_plan);
    EXPECT_EQ(std::get<GroupPlan>(*read_plan), plan);
  }
}

// ledger: S2-51
TEST(GroupWords, AreSmallEnoughForASlowModem) {
  GroupStatus status;
  status.lanes = 20;
  GroupPlan plan;
  plan.owner.resize(20, std::uint8_t{1});
  EXPECT_LE(to_bytes(status).size(), 26u);
  EXPECT_LE(to_bytes(plan).size(), 24u);
  status.obstacles.resize(3);
  EXPECT_LE(to_bytes(status).size(), 47u);
  status.ask = PassageAsk{};
  status.turns.resize(1);
  EXPECT_LE(to_bytes(status).size(), 52u);
}

// A packet with any byte changed or cut off is none. ledger: S2-51
TEST(GroupWords, OfDamagedBytesAreNone) {
  Random random(4);
  for (const FrameBytes& bytes : {to_bytes(some_status(random)), to_bytes(some_plan(random))}) {
    EXPECT_TRUE(is_of_group(bytes));
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      EXPECT_FALSE(group_word_of(std::span(bytes).first(i)));
      for (int bit = 0; bit < 8; ++bit) {
        FrameBytes changed = bytes;
        changed[i] = static_cast<std::uint8_t>(changed[i] ^ (1 << bit));
        EXPECT_FALSE(group_word_of(changed));
      }
    }
  }
}

TEST(GroupWords, NumbersThatWrapAreNewer) {
  EXPECT_TRUE(newer(2, 1));
  EXPECT_FALSE(newer(1, 2));
  EXPECT_FALSE(newer(7, 7));
  EXPECT_TRUE(newer(0, 65535));
  EXPECT_FALSE(newer(65535, 0));
}

}  // namespace
}  // namespace isobath
