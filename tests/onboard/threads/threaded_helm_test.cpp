// Mapping and agents in threads of their own: what must hold whoever is faster. Under the thread sanitizer these are
// the missions that show races; $ISOBATH_LIVE_SECONDS lengthens the voyage.
#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <isobath/display/decision_json.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/onboard/onboard.hpp>
#include <latch>
#include <tests/support/mission_runs.hpp>

namespace isobath {
namespace {

double voyage_s() {
  const char* wished = std::getenv("ISOBATH_LIVE_SECONDS");
  return wished ? std::atof(wished) : 60;
}

/// Lanes to and fro between poles, as long as is asked for.
Scenario lanes(double duration_s) {
  std::string text = fmt::format(R"(
[scene]
title = "lanes between poles"
duration_s = {}
[bottom]
kind = "flat"
depth = 12
[vehicle]
start = [0, 0, 4]
speed = 1.5
[mission]
title = "lanes"
speed = 1.5
[[sonar]]
preset = "micron"
[[cylinder]]
name = "pole"
centre = [40, 3, 6]
radius = 0.3
length = 12
)",
                                 duration_s);
  for (int i = 0; i < static_cast<int>(duration_s / 60) + 1; ++i) {
    for (const auto& [north, east] : {std::pair(80, 0), {80, 20}, {0, 20}, {0, 0}}) {
      text += fmt::format("[[mission_point]]\nname = \"{}-{}-{}\"\nnorth = {}\neast = {}\ndepth_m = 4\n", i, north,
                          east, north, east);
    }
  }
  return parse_scenario(text, "lanes");
}

/// To the end of the scenario's time.
LoopResult sail_live(const Scenario& scenario) {
  LoopRequest request;
  request.live = true;
  request.stop_when_done = false;
  return run_closed_loop(scenario, request);
}

std::string all(const LoopResult& result) {
  std::string text;
  for (const Decision& d : result.decisions) text += decision_json(d) + "\n";
  return text;
}

// ledger: S2-12 S6-31 S6-42
TEST(ThreadedHelm, SailsItsLanesAndKeepsClearOfThePole) {
  const LoopResult result = sail_live(lanes(voyage_s()));
  EXPECT_LT(result.contact_s, 0) << result.contact_with;
  EXPECT_EQ(result.report.phase, MissionPhase::kUnderWay) << result.report.why;
  EXPECT_GT(result.counts.pings, 8 * voyage_s());
  EXPECT_GT(result.length_m, 0.8 * 1.5 * (voyage_s() - 25));
  EXPECT_TRUE(std::none_of(result.decisions.begin(), result.decisions.end(), [](const Decision& d) {
    return d.what.find("lost") != std::string::npos;
  })) << "no agent is taken for hung that is merely slower";
}

struct LostAgent {
  const char* agent;
  FaultKind kind;
  friend std::ostream& operator<<(std::ostream& out, const LostAgent& lost) {
    return out << lost.agent << ", " << to_text(lost.kind);
  }
};
class LostAgents : public testing::TestWithParam<LostAgent> {};

// An agent that dies or hangs in its thread takes no other with it: the watchdog says so, the others bring the vehicle
// to the surface.
// ledger: S6-33 S6-34 S6-39 S2-28
TEST_P(LostAgents, InTheirOwnThreadsBringTheVehicleToTheSurface) {
  constexpr double kLost_s = 20;
  Scenario scenario = lanes(70);
  FaultConfig fault;
  fault.source = std::string("agent.") + GetParam().agent;
  fault.kind = GetParam().kind;
  fault.at_s = kLost_s;
  scenario.scene.faults = {fault};
  const LoopResult result = sail_live(scenario);
  const std::string why = std::string(GetParam().agent) + (fault.kind == FaultKind::kStuck ? " hangs" : " died");
  const auto said = std::find_if(result.decisions.begin(), result.decisions.end(),
                                 [&](const Decision& d) { return d.reason.find(why) != std::string::npos; });
  ASSERT_NE(said, result.decisions.end()) << all(result);
  EXPECT_LT(to_seconds(said->time), kLost_s + 2) << all(result);
  const auto surfaces = std::find_if(result.decisions.begin(), result.decisions.end(),
                                     [](const Decision& d) { return d.what == "surface"; });
  EXPECT_NE(surfaces, result.decisions.end()) << all(result);
  EXPECT_LT(result.track.back().state.X_WB.translation.z(), 1) << all(result);
  EXPECT_LT(result.contact_s, 0) << result.contact_with;
}

INSTANTIATE_TEST_SUITE_P(
    InLiveMode, LostAgents,
    testing::Values(LostAgent{"navigator", FaultKind::kOff}, LostAgent{"navigator", FaultKind::kStuck},
                    LostAgent{"pilot", FaultKind::kStuck}, LostAgent{"safety officer", FaultKind::kOff}),
    [](const auto& one) {
      std::string name = std::string(one.param.agent) + (one.param.kind == FaultKind::kStuck ? "_hangs" : "_dies");
      std::replace(name.begin(), name.end(), ' ', '_');
      return name;
    });

// ledger: S6-33
TEST(ThreadedHelm, GoesOnWithoutAnAgentThatIsNotNeeded) {
  Scenario scenario = lanes(30);
  FaultConfig fault;
  fault.source = "agent.chart room";
  fault.at_s = 10;
  scenario.scene.faults = {fault};
  const LoopResult result = sail_live(scenario);
  EXPECT_EQ(result.report.phase, MissionPhase::kUnderWay) << all(result);
  EXPECT_NE(all(result).find("the chart room died: killed; the mission goes on without it"), std::string::npos)
      << all(result);
}

// ledger: S6-33
TEST(ThreadedHelm, EndsWhileAllAreAtWork) {
  const Scenario scenario = lanes(10);
  const auto helm = make_threaded_helm(setup_of(scenario), {});
  SimulatedSource source(scenario.scene, {}, 1);
  DepthModel depths({}, {});
  Onboard onboard({}, depths, {.helm = helm.get(), .live = true});
  for (int i = 0; i < 200; ++i) {
    auto event = source.next();
    ASSERT_TRUE(event);
    onboard.on_event(std::move(*event));
  }
}

/// Holds mapping at its first ping until it is let go, and counts what is mapped.
class HeldMapping : public OnboardObserver {
 public:
  void on_mapped(Time, const Pipeline&, const DepthModel&, const VoxelModel&) override {
    if (mapped++ == 0) {
      in.count_down();
      go.wait();
    }
  }
  std::latch in{1}, go{1};
  int mapped = 0;
};

// ledger: S6-31
TEST(LiveOnboard, AFullQueueLosesItsOldestPingAndNothingElse) {
  DepthModel depths({}, {});
  HeldMapping held;
  Onboard onboard({}, depths, {.live = true});
  onboard.show_to(held);
  onboard.on_event(Navigation{});
  held.in.wait();
  for (std::size_t i = 0; i < Onboard::kLongestQueue; ++i) {
    if (i % 2 == 0) {
      onboard.on_event(Ping{});
    } else {
      onboard.on_event(Health{});
    }
  }
  for (int i = 0; i < 3; ++i) onboard.on_event(Navigation{});
  held.go.count_down();
  onboard.settle();
  EXPECT_EQ(onboard.lost_pings(), 3u);
  EXPECT_EQ(held.mapped, 1 + static_cast<int>(Onboard::kLongestQueue));
}

class Failing : public OnboardObserver {
 public:
  void on_mapped(Time, const Pipeline&, const DepthModel&, const VoxelModel&) override { throw Error("no such map"); }
};

TEST(LiveOnboard, WhatMappingThrowsTheThreadThatSettlesGets) {
  DepthModel depths({}, {});
  Failing failing;
  Onboard onboard({}, depths, {.live = true});
  onboard.show_to(failing);
  onboard.on_event(Navigation{});
  EXPECT_THROW(onboard.settle(), Error);
  EXPECT_THROW(onboard.on_event(Navigation{}), Error);
}

}  // namespace
}  // namespace isobath
