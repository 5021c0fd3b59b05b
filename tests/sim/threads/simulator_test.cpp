// A whole simulation: one clock, one seed, faults, commands, and the scenes of the papers.
#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <isobath/sim/simulator.hpp>
#include <set>
#include <stdexcept>
#include <tests/sim/worlds.hpp>
#include <tests/support/data.hpp>

namespace isobath::simulator_test {
namespace {

using testing::HasSubstr;

const std::string kSimple = R"(
[scene]
duration_s = 10
[bottom]
kind = "flat"
depth = 12
[vehicle]
start = [0, 0, 3]
speed = 1.5
[[waypoint]]
north = 6
depth = 3
[[waypoint]]
north = 6
east = 40
depth = 3
[[sonar]]
preset = "micron"
[[sonar]]
preset = "altimeter"
[[cylinder]]
name = "pole"
centre = [14, 3, 6]
radius = 0.3
length = 12
)";

struct Heard {
  std::vector<Ping> pings;
  std::vector<RangeReading> ranges;
  std::vector<Navigation> fixes;
  std::vector<Health> health;
  std::vector<EchoTruth> echoes;
  std::vector<TrueMotion> motion;
  std::uint64_t digest = 0;  ///< of everything, in its order

  void mix(std::uint64_t value) { digest = Random(digest ^ value).bits(); }
  void mix(Time time) { mix(static_cast<std::uint64_t>(time.time_since_epoch().count())); }
  void mix(double value) { mix(std::bit_cast<std::uint64_t>(value)); }
};

Heard heard(Simulator& simulator) {
  Heard all;
  while (auto event = simulator.next()) {
    all.mix(event->index());
    if (auto* ping = std::get_if<Ping>(&*event)) {
      all.mix(ping->time);
      for (int b = 0; b < ping->fan->beams(); ++b) {
        for (int k = 0; k < ping->window.bins; ++k) all.mix(static_cast<double>(ping->intensity(b, k)));
      }
      all.pings.push_back(*ping);
    } else if (auto* reading = std::get_if<RangeReading>(&*event)) {
      all.mix(reading->range_m.value_or(-1));
      all.ranges.push_back(*reading);
    } else if (auto* fix = std::get_if<Navigation>(&*event)) {
      all.mix(fix->X_WB.translation.sum());
      all.fixes.push_back(*fix);
    } else if (auto* health = std::get_if<Health>(&*event)) {
      all.health.push_back(*health);
    } else if (auto* echoes = std::get_if<EchoTruth>(&*event)) {
      for (const EchoLabel label : echoes->labels) all.mix(std::uint64_t{label.code()});
      all.echoes.push_back(*echoes);
    } else {
      all.motion.push_back(std::get<TrueMotion>(*event));
    }
  }
  return all;
}

Heard run(const std::string& toml, SimulationConfig config = {}, int threads = 1) {
  Simulator simulator(parse_scene(toml, "scene.toml"), config, threads);
  return heard(simulator);
}

std::string problem_of(const std::string& toml) {
  try {
    Simulator simulator(parse_scene(toml, "scene.toml"), {});
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

TEST(Simulator, EverySourceKeepsItsOwnRate) {
  const Heard all = run(kSimple);
  EXPECT_EQ(all.pings.size(), 101u);  // 10 Hz, both ends
  EXPECT_EQ(all.ranges.size(), 51u);
  EXPECT_EQ(all.fixes.size(), 101u);
  EXPECT_EQ(all.motion.size(), 101u);
  EXPECT_EQ(all.health.size(), 11u);
  EXPECT_EQ(all.echoes.size(), all.pings.size() + all.ranges.size());
  for (std::size_t i = 1; i < all.pings.size(); ++i) {
    EXPECT_EQ(all.pings[i].time - all.pings[i - 1].time, seconds(0.1));
  }
}

TEST(Simulator, IsAFunctionOfSceneAndSeedOnAnyNumberOfThreads) {
  const std::uint64_t one = run(kSimple).digest;
  EXPECT_EQ(run(kSimple).digest, one);
  EXPECT_EQ(run(kSimple, {}, 2).digest, one);
  EXPECT_NE(run(kSimple, {.seed = 5}).digest, one);
  EXPECT_EQ(run(kSimple, {.seed = 1}).digest, one) << "the scene's own seed";
}

TEST(Simulator, TheVehicleFollowsItsWaypointsAndTheAltimeterItsAltitude) {
  const Heard all = run(kSimple);
  const Eigen::Vector3d end = all.motion.back().state.X_WB.translation;
  EXPECT_NEAR(end.x(), 6, 2.5);
  EXPECT_GT(end.y(), 4);
  for (const TrueMotion& m : all.motion) EXPECT_NEAR(*m.altitude_m, 12 - m.state.X_WB.translation.z(), 1e-3);
  for (const RangeReading& r : all.ranges) {
    ASSERT_TRUE(r.range_m);
    EXPECT_NEAR(*r.range_m, 9.3, 0.45) << "the beam is 30 degrees wide, the strongest speckle anywhere in it";
  }
}

// ledger: S6-57
TEST(Simulator, ACommandTakesTheVehicleOffItsWaypoints) {
  Simulator simulator(parse_scene(kSimple, "scene.toml"), {});
  simulator.command({Angle::degrees(-90), 5, 1.0});
  const Heard all = heard(simulator);
  const TrueMotion& end = all.motion.back();
  EXPECT_NEAR(end.state.X_WB.rotation.heading().wrapped().degrees(), -90, 1);
  EXPECT_LT(end.state.X_WB.translation.y(), -6);
  EXPECT_NEAR(end.state.X_WB.translation.z(), 5, 0.1);
}

TEST(Simulator, FaultsBeginWithTimeOrWithAnEventAndStrikeTheirSourceAlone) {
  const Heard off = run(kSimple + "[[fault]]\nsource = \"sonar\"\nkind = \"off\"\nat_s = 5\n");
  EXPECT_EQ(off.pings.size(), 50u);
  EXPECT_EQ(off.ranges.size(), 51u);
  const Heard late = run(kSimple + "[[fault]]\nsource = \"altimeter\"\nkind = \"off\"\nwhen = \"waypoint 1\"\n");
  EXPECT_EQ(late.pings.size(), 101u);
  EXPECT_GT(late.ranges.size(), 8u);
  EXPECT_LT(late.ranges.size(), 25u) << "the first way-point is 6 m away";
  const Heard near = run(kSimple + "[[fault]]\nsource = \"sonar\"\nkind = \"off\"\nwhen = \"near pole\"\n");
  EXPECT_GT(near.pings.size(), 10u);
  EXPECT_LT(near.pings.size(), 60u);
}

TEST(Simulator, TheVehicleReportsLeakAndBatteryAndFeelsALostThruster) {
  const Heard leak = run(kSimple + "[[fault]]\nsource = \"vehicle\"\nkind = \"leak\"\nat_s = 4\n");
  EXPECT_FALSE(leak.health[3].leak);
  EXPECT_TRUE(leak.health[5].leak);
  EXPECT_EQ(leak.health[5].state, HealthState::kDegraded);
  const Heard flat = run(kSimple + "[[fault]]\nsource = \"vehicle\"\nkind = \"battery\"\nat_s = 4\namount = 0.6\n");
  EXPECT_NEAR(static_cast<double>(flat.health[3].battery_share), 1, 1e-3);
  EXPECT_NEAR(static_cast<double>(flat.health[5].battery_share), 0.4, 1e-3);
  const Heard weak =
      run(kSimple + "[[fault]]\nsource = \"thruster\"\nkind = \"thruster_loss\"\nat_s = 2\namount = 1\n");
  EXPECT_LT(weak.motion.back().state.X_WB.translation.x(), 5);
}

/// What the host says of one part: when, and in which state.
std::vector<std::pair<double, HealthState>> said_of(const Heard& all, const std::string& source) {
  std::vector<std::pair<double, HealthState>> said;
  for (const Health& health : all.health) {
    if (health.source == source) said.emplace_back(to_seconds(health.time), health.state);
  }
  return said;
}

TEST(Simulator, TheHostSaysWhatHasFailedAtOnceAndOnceThatItIsWell) {
  const std::string navigated = kSimple + "[navigation]\nkind = \"sensors\"\n";
  for (const auto& [source, kind] : {std::pair<std::string, std::string>("depth", "off"),
                                     {"altimeter", "off"},
                                     {"disk", "off"},
                                     {"thruster.1", "thruster_loss"}}) {
    const std::string amount = kind == "off" ? "" : "amount = 0.5\n";
    const Heard all = run(navigated + "[[fault]]\nsource = \"" + source + "\"\nkind = \"" + kind +
                          "\"\nat_s = 3\nfor_s = 4\n" + amount);
    const auto said = said_of(all, source);
    ASSERT_GE(said.size(), 3u) << source;
    const HealthState bad = kind == "off" ? HealthState::kLost : HealthState::kDegraded;
    EXPECT_EQ(said.front().second, bad) << source;
    EXPECT_GE(said.front().first, 3) << source;
    EXPECT_LE(said.front().first, 4.5) << source << ": five periods of 0.2 s at most";
    for (std::size_t i = 1; i + 1 < said.size(); ++i) {
      EXPECT_NEAR(said[i].first - said[i - 1].first, 1, 0.03) << source;
    }
    EXPECT_EQ(said.back().second, HealthState::kOk) << source;
    EXPECT_NEAR(said.back().first, 7, 0.3) << source;
    EXPECT_EQ(said_of(all, "vehicle").size(), 11u) << source << ": the vehicle's own reports go on";
  }
  EXPECT_EQ(run(navigated).health.size(), 11u) << "nothing to say of what works";
}

TEST(Simulator, AHostWhoseReportsAreLostSaysNothingUntilTheyComeAgain) {
  const Heard all = run(kSimple + "[[fault]]\nsource = \"health\"\nkind = \"off\"\nat_s = 3\nfor_s = 4\n" +
                        "[[fault]]\nsource = \"disk\"\nkind = \"off\"\nat_s = 4\nfor_s = 5\n");
  for (const Health& health : all.health) {
    EXPECT_TRUE(health.time < Time(seconds(3)) || health.time >= Time(seconds(7))) << to_seconds(health.time);
  }
  EXPECT_EQ(said_of(all, "vehicle").size(), 11u - 4u);
  ASSERT_FALSE(said_of(all, "disk").empty());
  EXPECT_NEAR(said_of(all, "disk").front().first, 7, 0.1) << "what has failed meanwhile is said as soon as it can be";
}

TEST(Simulator, AJumpOfTheClockMovesWhatTheVehicleSaysAndNotTheTruth) {
  const Heard all = run(kSimple + "[[fault]]\nsource = \"vehicle\"\nkind = \"clock_jump\"\nat_s = 5\namount = -3\n");
  bool backwards = false;
  for (std::size_t i = 1; i < all.pings.size(); ++i) backwards = backwards || all.pings[i].time < all.pings[i - 1].time;
  EXPECT_TRUE(backwards);
  for (std::size_t i = 1; i < all.motion.size(); ++i) EXPECT_GT(all.motion[i].time, all.motion[i - 1].time);
}

TEST(Simulator, ABodyInsideTheVehicleAndAStartBelowTheBottomAreRefusedWithTheirPlace) {
  EXPECT_THAT(problem_of("[scene]\n[vehicle]\nstart = [0, 0, 3]\n[[sphere]]\ncentre = [0.2, 0, 3]\n"),
              HasSubstr("scene.toml:4:1: sphere: sphere 1 is inside the vehicle"));
  EXPECT_THAT(
      problem_of("[scene]\n[bottom]\nkind = \"flat\"\ndepth = 2\n[vehicle]\nstart = [0, 0, 3]\n"),
      HasSubstr("scene.toml:5:1: vehicle.start: the vehicle starts 3.0 m deep, where the bottom is 2.0 m deep"));
}

// The scenes of the papers -------------------------------------------------------------------------------------------

Scene scene_of(const std::string& name) {
  const auto file = test::source_folder() / ("scenarios/" + name + ".toml");
  return parse_scene(test::scene_text(name), file.string());
}

const Body& body(const Scene& scene, const std::string& name) {
  for (const Body& b : scene.bodies) {
    if (b.name == name) return b;
  }
  throw std::out_of_range(name);
}

class EveryScenario : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, EveryScenario,
                         testing::Values("coral_reef", "bridge", "polygon_room", "crossing_traffic", "tank", "hull",
                                         "hull_water"),
                         [](const auto& name) { return std::string(name.param); });

TEST_P(EveryScenario, RunsAndSaysWhatItIs) {
  Simulator simulator(scene_of(GetParam()), {.duration_s = 1});
  EXPECT_GT(simulator.scene().about.text.size(), 40u);
  const Heard all = heard(simulator);
  EXPECT_GT(all.pings.size() + all.ranges.size(), 1u);
  for (const Ping& ping : all.pings) EXPECT_EQ(check(ping), PingFault::kNone);
}

// ledger: S6-60 S6-D04
TEST(Scenarios, ReefTopsAreShallowerThanFiveMetresOverABottomOfSevenToTwentyFive) {
  const Scene scene = scene_of("coral_reef");
  for (const char* name : {"reef north", "reef east", "reef south", "coral head"}) {
    const auto& top = std::get<Sphere>(body(scene, name).shape);
    EXPECT_LT(top.centre.z() - top.radius, 5) << name;
  }
  const World world(scene);
  for (double north = -60; north <= 80; north += 10) {
    for (double east = -40; east <= 60; east += 10) {
      EXPECT_GT(world.bottom_depth(north, east).value_or(0), 7);
      EXPECT_LT(world.bottom_depth(north, east).value_or(99), 25);
    }
  }
}

// ledger: S5-38 S5-D01
TEST(Scenarios, TheBridgeShowsABandAtThirtyMetresAheadAndBedSurfaceAndObstacleVertically) {
  Simulator simulator(scene_of("bridge"), {.duration_s = 0.5});
  const Heard all = heard(simulator);
  const auto of = [&all](const std::string& sonar) {
    return std::find_if(all.echoes.begin(), all.echoes.end(), [&](const EchoTruth& t) { return t.sonar == sonar; });
  };
  const auto target = [&simulator](EchoLabel label) { return simulator.world().name(label.target()); };
  const EchoTruth& level = *of("horizontal");
  int beams_with_berm = 0, pylons = 0;
  for (int b = 0; b < level.beams; ++b) {
    bool berm = false, pylon = false;
    for (int k = 0; k < level.bins; ++k) {
      const EchoLabel label = level.labels[static_cast<std::size_t>(b * level.bins + k)];
      const double r = (k + 0.5) * 0.1;
      berm = berm || (target(label).starts_with("berm") && r > 26 && r < 45);
      pylon = pylon || (target(label).starts_with("pylon") && r > 44 && r < 60);
    }
    beams_with_berm += berm;
    pylons += pylon;
  }
  EXPECT_GT(beams_with_berm, level.beams / 2) << "a band across the field";
  EXPECT_GT(pylons, 8);
  const EchoTruth& vertical = *of("vertical");
  bool bed = false, surface = false, obstacle = false;
  for (const EchoLabel label : vertical.labels) {
    bed = bed || label.target() == kBottom;
    surface = surface || label.target() == kSurface;
    obstacle = obstacle || target(label).starts_with("berm");
  }
  EXPECT_TRUE(bed && surface && obstacle);
}

// ledger: S4-31 S4-32 S4-34 S4-35
TEST(Scenarios, TheRoomIsScannedInTurnsOf144BeamsWhileTheVehicleDivesInASine) {
  Simulator simulator(scene_of("polygon_room"), {.duration_s = 60});
  const Heard all = heard(simulator);
  std::set<double> bearings;
  for (const Ping& ping : all.pings) bearings.insert(ping.fan->azimuth[0].degrees());
  EXPECT_EQ(bearings.size(), 144u);
  double shallow = 1e9, deep = 0;
  for (const TrueMotion& m : all.motion) {
    shallow = std::min(shallow, m.state.X_WB.translation.z());
    deep = std::max(deep, m.state.X_WB.translation.z());
  }
  EXPECT_NEAR(deep - shallow, 4, 1.2);
}

// ledger: S3-D01 S3-D05
TEST(Scenarios, TrafficCrossesTheWayOfTheVehicle) {
  const Scene scene = scene_of("crossing_traffic");
  World world(scene);
  int crossing = 0;
  for (const WorldBody& b : world.bodies()) {
    if (!b.moves) continue;
    const double before = b.box.center().y();
    const double after = before + displacement(*b.body, 90).y();
    crossing += before * after <= 0 || std::abs(after) <= 6;  // to the other side, or stopped within 5 m of the way
  }
  EXPECT_GE(crossing, 3);
}

}  // namespace
}  // namespace isobath::simulator_test
