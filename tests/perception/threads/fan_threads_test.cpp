// The kernel of fans on several threads and on every instruction set that the processor has.
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <tests/perception/fan_looks.hpp>
#include <tests/support/vector_targets.hpp>

namespace isobath {
namespace {

using Rule = FanMapperConfig::Rule;
using namespace test;

// ledger: S5-60
TEST(FanMapper, GivesTheSameBitsOnAnyThreadsAndProcessor) {
  const auto mapped = [](Rule rule, int threads) {
    Random random(5);
    VoxelBlocks map;
    FanMapper mapper(by(rule, 3), 0.25, odds(0.05));
    for (int n = 0; n < 5; ++n) {
      const Look look = noisy_fan(random);
      mapper.update(look.ping, look.decisions, pose(20.0 * n, 3.0 * n, -10, {0.3 * n, 0, 4}), map, threads);
    }
    return contents(map);
  };
  for (const Rule rule : {Rule::kMarginal, Rule::kAspects}) {
    const auto one = mapped(rule, 1);
    EXPECT_GT(one.size(), 10'000u);
    EXPECT_EQ(mapped(rule, 2), one);
    EXPECT_EQ(mapped(rule, 3), one);
    const auto targets = test::vector_targets();
    EXPECT_GE(targets.size(), 2u);
    for (const char* target : targets) {
      test::use_vector_target(target);
      EXPECT_EQ(mapped(rule, 1), one) << target;
    }
    test::use_vector_target("");
  }
  EXPECT_THROW(test::use_vector_target("abacus"), Error);
}

}  // namespace
}  // namespace isobath
