// The suite of encounters: which situation a seed has, and that its bodies meet the vehicle of the run.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/evaluation/evaluation_suite.hpp>
#include <tests/support/data.hpp>

namespace isobath::encounter_suite {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

class EncounterSuite : public testing::Test {
 protected:
  const Suite suite_ = load_suite(test::source_folder() / "suites" / "encounters.toml");
  const std::vector<Scenario> scenes_ = load_scenes(suite_);
};

TEST_F(EncounterSuite, TakesTheSituationsInTurn) {
  EXPECT_EQ(suite_.about.runs, 40);
  EXPECT_EQ(suite_.about.seed, 0);
  for (const std::uint64_t seed : {0u, 6u, 39u, 54u}) {
    const EncounterSituation& situation = encounter_situations()[seed];
    const SuiteRun run = make_run(suite_, scenes_, seed);
    EXPECT_EQ(run.scenario.scene.bodies.size(), situation.size());
    EXPECT_THAT(run.conditions, HasSubstr("; encounters: " + to_text(situation)));
    EXPECT_EQ(make_run(suite_, scenes_, seed + 55).scenario.scene.bodies.size(), situation.size());
  }
}

TEST_F(EncounterSuite, MeetsTheVehicleOnItsWayFromItsDrawnStart) {
  for (std::uint64_t seed = 0; seed < 55; ++seed) {
    const SuiteRun run = make_run(suite_, scenes_, seed);
    const Vector2d start = run.scenario.scene.vehicle.start.head<2>();
    const Vector2d way = run.scenario.mission.points[0].north_east - start;
    for (const Body& body : run.scenario.scene.bodies) {
      const Vector2d first(body.path[1], body.path[2]);
      double nearest = INFINITY;
      for (double t = 0; t < 60; t += 0.05) {
        const Vector2d own = start + 1.5 * t * way.normalized();
        nearest = std::min(nearest, (first + displacement(body, t).head<2>() - own).norm());
      }
      EXPECT_LT(nearest, 0.5) << body.name << " of seed " << seed;
    }
  }
}

/// A body on collision course stays on its bearing: where no sonar looks, it is never seen.
TEST_F(EncounterSuite, SeesAllRound) {
  const Scene& scene = scenes_[0].scene;
  for (int bearing = -180; bearing < 180; ++bearing) {
    EXPECT_TRUE(std::ranges::any_of(scene.sonars, [&](const SonarConfig& sonar) {
      const double off = std::abs((Angle::degrees(bearing) - sonar.heading).wrapped().degrees());
      return off <= sonar.sector.degrees() / 2;
    })) << bearing;
  }
}

}  // namespace
}  // namespace isobath::encounter_suite
