// The law of dependent looks against its closed form and against a hidden state carried beside it.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/angle.hpp>
#include <isobath/base/random.hpp>
#include <isobath/perception/aspect_law.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

AspectConfig config_of(double visibility, double renewal) {
  AspectConfig config;
  config.visibility = visibility;
  config.renewal = renewal;
  config.no_echo_weight = 1;
  config.max_log_odds = 30;
  return config;
}

// n looks that hear nothing from one direction: ln(1 - a + a (1 - p)^n), and never below ln(1 - a). ledger: S5-14
TEST(AspectLaw, LetsSilenceFromOneDirectionTendToWhatDoesNotEchoThere) {
  for (const double a : {0.2, 0.6, 0.9}) {
    const AspectLaw law(config_of(a, 0));
    double evidence = 0;
    for (int n = 1; n <= 40; ++n) {
      evidence += law.silence(0.8, 0) * law.share(evidence);
      ASSERT_NEAR(evidence, std::log(1 - a + a * std::pow(0.2, n)), 1e-9) << a << " after " << n;
    }
    EXPECT_NEAR(evidence, std::log(1 - a), 1e-9);
  }
}

// Any order of echoes and silence, beside the probability of the hidden state carried from look to look.
TEST(AspectLaw, KnowsFromTheEvidenceAloneWhetherTheVoxelEchoes) {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    const double a = random.uniform(0.1, 0.9);
    const AspectLaw law(config_of(a, 0));
    double evidence = 0, heard = a, silent = 1 - a;  // P(looks and state | occupied) / P(looks | empty)
    for (int n = 0; n < 12; ++n) {
      ASSERT_NEAR(law.answering(evidence), heard / (heard + silent), 1e-9);
      if (random.uniform() < 0.5) {
        const double ratio = random.uniform(1, 8);
        evidence += law.echo(evidence, ratio, 0);
        heard *= ratio;
      } else {
        evidence += law.silence(0.8, 0) * law.share(evidence);
        heard *= 0.2;
      }
      ASSERT_NEAR(evidence, std::log(heard + silent), 1e-9) << "round " << round << " look " << n;
    }
  }
}

TEST(AspectLaw, CountsSilenceFullyAgainstWhatHasEchoedAndLittleAgainstWhatNeverDid) {
  const AspectLaw law(config_of(0.6, 0.1));
  EXPECT_NEAR(law.answering(6), 0.96, 1e-12) << "k of the looks are from a new direction";
  EXPECT_NEAR(law.answering(-6), 0.06, 1e-12);
  EXPECT_LT(law.silence(0.8, 0) * law.share(6), std::log(0.25));
  EXPECT_GT(law.silence(0.8, 0) * law.share(6), std::log(0.22));
  EXPECT_GT(law.silence(0.8, 0) * law.share(-6), std::log(0.94));
}

// ledger: S5-31
TEST(AspectLaw, LetsEchoesFromOneDirectionRaiseTheEvidenceToItsLimitAndThenByTheTurnAlone) {
  AspectConfig config;
  const AspectLaw law(config);
  double evidence = 0;
  for (int n = 0; n < 100; ++n) evidence += law.echo(evidence, 5, 0);
  EXPECT_DOUBLE_EQ(evidence, config.max_log_odds);
  const double whole = law.echo(evidence, 5, 1);
  EXPECT_NEAR(whole, std::log1p(4 * law.answering(evidence)), 1e-12);
  EXPECT_NEAR(law.echo(evidence, 5, 0.25), 0.25 * whole, 1e-12);
  EXPECT_EQ(law.echo(evidence, 0.5, 1), 0) << "an echo never speaks against the voxel";
}

TEST(AspectLaw, MeasuresTheTurnOfTheLineOfSight) {
  AspectConfig config;
  config.turn_deg = 10;
  const AspectLaw law(config);
  EXPECT_EQ(law.turned(Vector3d(20, 0, 0), Vector3d(1, 0, 0), 0.5), 0) << "straight towards it";
  const double degree = Angle::degrees(1).radians();
  EXPECT_NEAR(law.turned(Vector3d(0, 20, 0), Vector3d(20 * degree, 0, 0), 0.5), 0.1, 1e-12);
  EXPECT_EQ(law.turned(Vector3d(0, 1, 0), Vector3d(1, 0, 0), 0.5), 1) << "no more than one new direction";
}

}  // namespace
}  // namespace isobath
