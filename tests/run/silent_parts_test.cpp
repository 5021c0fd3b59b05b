// A part of the vehicle that falls silent in a mission and comes back.
#include <algorithm>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <isobath/mission/safety/fault_table.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/scenario/scenario.hpp>

namespace isobath {
namespace {

constexpr double kSilentFrom_s = 20, kSilentFor_s = 8, kCycle_s = 0.6;

/// A part of a fault of a scene, and the row of the fault table that says that it is silent.
struct Silence {
  const char* source;
  Fault fault;
  double SafetyConfig::*limit_s;  ///< after its last word
};

LoopResult silenced(const char* source, const Configuration& configuration) {
  const std::string scene = fmt::format(
      "[scene]\ntitle = \"Silence\"\nduration_s = 45\n[vehicle]\nstart = [0, 0, 5]\nspeed = 1\n[[sonar]]\n"
      "preset = \"micron\"\n[mission]\ntitle = \"Ahead\"\n[[mission_point]]\nnorth = 60\ndepth_m = 5\n[[fault]]\n"
      "source = \"{}\"\nkind = \"off\"\nat_s = {}\nfor_s = {}\n",
      source, kSilentFrom_s, kSilentFor_s);
  LoopRequest request;
  request.configuration = configuration;
  return run_closed_loop(parse_scenario(scene, "silence.toml"), request);
}

// The sonar, and the reports of the vehicle's health: the Safety Officer notices the silence within the limit of the
// part and a cycle, and it is over when the part speaks again. ledger: S1-05
TEST(SilentParts, AreNoticedWithinTheirLimitAndWellWhenTheySpeakAgain) {
  const Configuration configuration;
  const SafetyConfig& limits = configuration.safety;
  for (const Silence& part : {Silence{"sonar", Fault::kSonarSilent, &SafetyConfig::sonar_silent_s},
                              Silence{"health", Fault::kHealthSilent, &SafetyConfig::health_silent_s}}) {
    const std::string fault = to_text(part.fault);
    std::vector<double> raised, over;
    for (const Decision& d : silenced(part.source, configuration).decisions) {
      if (d.agent != "safety officer") continue;
      EXPECT_THAT(d.reason, testing::StartsWith(fault + ":")) << part.source;
      (d.what == "over" ? over : raised).push_back(to_seconds(d.time));
    }
    ASSERT_FALSE(raised.empty()) << fault;
    ASSERT_EQ(over.size(), 1u) << fault;
    EXPECT_GT(raised.front(), kSilentFrom_s) << fault;
    EXPECT_LE(raised.front(), kSilentFrom_s + limits.*part.limit_s + kCycle_s) << fault;
    EXPECT_GT(over.front(), kSilentFrom_s + kSilentFor_s) << fault;
    EXPECT_LE(over.front(), kSilentFrom_s + kSilentFor_s + limits.clear_after_s + kCycle_s) << fault;
  }
}

}  // namespace
}  // namespace isobath
