#include <cmath>
#include <gmock/gmock.h>
#include <isobath/sonar/cfar.hpp>
#include <numeric>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

std::vector<std::uint64_t> decisions(Cfar& cfar, const std::vector<float>& beam, int first = 0) {
  std::vector<std::uint64_t> hits((beam.size() + 63) / 64, 0);
  cfar.detect(beam.data(), first, static_cast<int>(beam.size()), hits.data());
  return hits;
}

std::vector<int> bins_of(const std::vector<std::uint64_t>& hits) {
  std::vector<int> bins;
  for (int k = 0; k < static_cast<int>(64 * hits.size()); ++k) {
    if (hits[k / 64] >> (k % 64) & 1) bins.push_back(k);
  }
  return bins;
}

// ledger: S6-62 S6-64
TEST(Cfar, FactorsHaveTheirClosedForms) {
  EXPECT_NEAR(ca_cfar_factor(1, 0.1), 9, 1e-12);
  EXPECT_NEAR(ca_cfar_factor(1'000'000, 0.02), -std::log(0.02), 1e-4);
  // Rohling's product as Gamma functions: N! Gamma(alpha + N - k + 1) / ((N - k)! Gamma(alpha + N + 1)).
  for (double f : {0.02, 1e-6}) {
    const double alpha = os_cfar_factor(24, 18, f);
    const double log_f = std::lgamma(25) + std::lgamma(alpha + 7) - std::lgamma(7) - std::lgamma(alpha + 25);
    EXPECT_NEAR(std::exp(log_f) / f, 1, 1e-9);
  }
  // One reference bin: the ordered statistic is the mean.
  EXPECT_NEAR(os_cfar_factor(1, 1, 0.05), ca_cfar_factor(1, 0.05), 1e-9);
}

struct Case {
  bool ordered;
  CfarLaw law;
  friend std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << (c.ordered ? "ordered" : "mean") << ", law " << static_cast<int>(c.law);
  }
};

class CfarRate : public testing::TestWithParam<Case> {};

// Decisions that are 2 (guard + reference) + 1 bins apart share no sample: binomial error counts those only.
// ledger: S6-62 S6-64
TEST_P(CfarRate, IsTheRateAskedForOnFreshNoise) {
  const auto [ordered, law] = GetParam();
  const auto noise = law == CfarLaw::kRayleigh ? test::rayleigh(7) : test::exponential(7);
  CfarConfig config;
  config.law = law;
  constexpr double kRate = 0.02;
  Cfar cfar(config, ordered, kRate);
  Random random(11);
  std::vector<float> beam(60000);
  for (float& z : beam) z = static_cast<float>(noise(random));
  const double rate = static_cast<double>(bins_of(decisions(cfar, beam)).size()) / static_cast<double>(beam.size());
  EXPECT_NEAR(rate, kRate, 4 * std::sqrt(kRate / (static_cast<double>(beam.size()) / 4)));
  int at_the_ends = 0;
  constexpr int kBeams = 3000;
  for (int i = 0; i < kBeams; ++i) {
    const std::vector<float> piece(beam.begin() + 20 * i, beam.begin() + 20 * i + 20);
    at_the_ends += static_cast<int>(decisions(cfar, piece)[0] & 1);
  }
  EXPECT_NEAR(at_the_ends / double(kBeams), kRate, 4 * std::sqrt(kRate / kBeams)) << "first bin: a window on one side";
}

INSTANTIATE_TEST_SUITE_P(BothOnBothLaws, CfarRate,
                         testing::Values(Case{false, CfarLaw::kExponential}, Case{false, CfarLaw::kRayleigh},
                                         Case{true, CfarLaw::kExponential}, Case{true, CfarLaw::kRayleigh}));

TEST(Cfar, OrderedStatisticKeepsBothOfTwoNeighbours) {
  std::vector<float> beam(200, 1);
  beam[100] = beam[110] = 30;
  Cfar ordered(CfarConfig{}, true, 0.001);
  EXPECT_THAT(bins_of(decisions(ordered, beam)), testing::ElementsAre(100, 110));
  beam.assign(200, 0);
  EXPECT_THAT(bins_of(decisions(ordered, beam)), testing::IsEmpty()) << "silence is no echo";
}

TEST(Cfar, DoesNotLookIntoTheBlindZone) {
  std::vector<float> beam(200, 1);
  std::fill_n(beam.begin(), 20, 250.0f);
  beam[24] = 20;
  Cfar cfar(CfarConfig{}, false, 0.001);
  EXPECT_THAT(bins_of(decisions(cfar, beam, 20)), testing::ElementsAre(24));
}

}  // namespace
}  // namespace isobath
