// A vehicle passes two barges; the machinery of one is heard, and a pump sounds where the sonar shows nothing.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/geometry/polygon.hpp>
#include <isobath/run/run.hpp>
#include <tests/support/data.hpp>
#include <tests/support/mission_runs.hpp>

namespace isobath::machinery_run_test {
namespace {

using Eigen::Vector2d;
using Origin = Contact::Origin;

Scenario first_leg() {
  Scenario scenario = test::scenario_of("machinery");
  scenario.mission.points.resize(1);
  scenario.mission.points[0].north_east = {58, 0};  // past the working barge, 91 s
  return scenario;
}

LoopResult sail(const Scenario& scenario, int seed = 101) {
  LoopRequest request;
  request.configuration.simulation.seed = seed;
  return run_closed_loop(scenario, request);
}

const Contact* at_frequency(const std::vector<Contact>& contacts, double frequency_hz) {
  const auto found = std::find_if(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return std::abs(contact.frequency_hz - frequency_hz) < 1;
  });
  return found == contacts.end() ? nullptr : &*found;
}

double distance_from_body(const Scenario& scenario, const std::string& name, const Vector2d& p) {
  for (const TrueBody& body : outlines_of(World(scenario.scene))) {
    if (body.name == name) return distance_from(body.outline, p);
  }
  return 1e9;
}

// ledger: S4-54
TEST(MachineryRuns, EachSoundBelongsToTheRightObstacleOrToNone) {
  const Scenario scenario = first_leg();
  const LoopResult result = sail(scenario);
  EXPECT_EQ(result.report.phase, MissionPhase::kFinished);
  ASSERT_TRUE(result.contacts);
  const std::vector<Contact>& contacts = result.contacts->contacts;
  ASSERT_EQ(contacts.size(), 2U) << "the faint pump is not heard";
  const Contact* generator = at_frequency(contacts, 120);
  ASSERT_TRUE(generator);
  EXPECT_EQ(generator->origin, Origin::kObstacle);
  EXPECT_GT(generator->probability, 0.95);
  EXPECT_LT(distance_from_body(scenario, "working barge", generator->nearest), 3);
  EXPECT_GT(distance_from_body(scenario, "silent barge", generator->nearest), 10);
  const Contact* pump = at_frequency(contacts, 63);
  ASSERT_TRUE(pump);
  EXPECT_EQ(pump->origin, Origin::kNone);
  EXPECT_EQ(pump->attached_after, 0U) << "at no time was it attached to an obstacle";
  ASSERT_TRUE(pump->place);
  const Vector2d off = pump->place->mean - Vector2d(40, -90);
  EXPECT_LT(off.dot(pump->place->covariance.inverse() * off), 18);
  const std::size_t told = test::find_decision(result.decisions, "passive array", "sound");
  ASSERT_LT(told, result.decisions.size()) << "a decision tells of it";
}

// Without the array the same mission makes the same decisions, less those on sounds. ledger: S4-54
TEST(MachineryRuns, TheArrayChangesNothingElse) {
  Scenario scenario = first_leg();
  scenario.mission.points[0].north_east = {20, 0};
  std::vector<Decision> with = sail(scenario).decisions;
  scenario.scene.hydrophones.on = false;
  const LoopResult without = sail(scenario);
  EXPECT_FALSE(without.contacts);
  std::erase_if(with, [](const Decision& decision) { return decision.agent == "passive array"; });
  ASSERT_EQ(with.size(), without.decisions.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(with[i].time, without.decisions[i].time);
    EXPECT_EQ(with[i].reason, without.decisions[i].reason);
  }
}

// ledger: S4-54
TEST(MachineryRuns, AReplayOfTheLogHearsTheSame) {
  const std::filesystem::path folder = test::scratch_folder(), log = folder / "run.mcap";
  RunRequest request;
  request.input = test::source_folder() / "scenarios" / "machinery.toml";
  request.out = folder / "first";
  request.record = log;
  request.configuration.simulation.duration_s = 40;
  const RunOutcome first = run(request);
  ASSERT_TRUE(first.contacts);
  EXPECT_TRUE(std::filesystem::exists(request.out / "contacts.geojson"));
  RunRequest replay;
  replay.input = log;
  replay.mission = request.input;
  replay.out = folder / "again";
  const RunOutcome again = run(replay);
  ASSERT_TRUE(again.contacts);
  ASSERT_EQ(first.contacts->contacts.size(), again.contacts->contacts.size());
  EXPECT_GE(first.contacts->contacts.size(), 2U);
  EXPECT_EQ(first.contacts->bearings, again.contacts->bearings);
  for (std::size_t i = 0; i < first.contacts->contacts.size(); ++i) {
    const Contact &a = first.contacts->contacts[i], &b = again.contacts->contacts[i];
    EXPECT_EQ(a.frequency_hz, b.frequency_hz);
    EXPECT_EQ(a.bearings, b.bearings);
    EXPECT_EQ(a.none, b.none);
    EXPECT_EQ(a.probability, b.probability);
    EXPECT_EQ(a.likeliest, b.likeliest);
    EXPECT_EQ(a.changes, b.changes);
  }
}

}  // namespace
}  // namespace isobath::machinery_run_test
