// The map in three dimensions where the input is not as it should be: positions that jump, fans all round, sonars head
// over, pings that no map can use. What is right is mapped right; what is not is counted, with its reason.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/world/voxel_model.hpp>
#include <limits>
#include <tests/support/echoes.hpp>
#include <tests/support/events.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using testing::Contains;
using testing::Pair;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

/// Pipeline, voxels and the obstacles of the last scan.
class Mapped : public ResultSink {
 public:
  explicit Mapped(const Configuration& configuration = {})
      : model(configuration.voxels), pipeline(configuration, *this) {}
  void on_ping(const PosedPing& posed) override { model.update(posed); }
  void on_vertical_ping(const PosedPing& posed) override { model.update(posed); }
  void on_jump(const Vector3d& by_W) override { model.move_along(by_W); }
  void on_scan(const ScanResult& scan) override {
    last_scan = scan.detection.time;
    obstacles.clear();
    if (!first_scan) first_scan = scan.detection.time;
    for (const Obstacle& o : scan.detection.obstacles) {
      const Pose X_WL = level(scan.detection.X_WB);
      for (const auto& p : o.outline) obstacles.push_back(X_WL * Vector3d(p.x(), p.y(), 0));
    }
  }
  VoxelModel model;
  Pipeline pipeline;
  std::vector<Vector3d> obstacles;  ///< corners of their outlines, in W
  std::optional<Time> first_scan, last_scan;
};

// Positions that jump ------------------------------------------------------------------------------------------------

// For five seconds navigation is wrong by eight metres, then it is put right at once.
constexpr const char* kWallScene = R"(
[scene]
title = "a wall ahead, and a fix on the way"
duration_s = 8
[vehicle]
start = [0, 0, 5]
speed = 1
[navigation]
kind = "truth"
[[waypoint]]
north = 60
depth = 5
[[wall]]
name = "wall"
line = [[26, 14], [26, -14]]
top = 0
bottom = 10
[[sonar]]
preset = "p450_horizontal"
range_m = 50
bins = 150
[[fault]]
source = "navigation"
kind = "jump"
amount = 8
for_s = 5
)";
constexpr double kWall = 26;

struct WallSeen {
  int voxels_at_it = 0, voxels_elsewhere = 0;
  int scans = 0, scans_with_another = 0;  ///< after the fix: of the plan view
  PipelineCounts counts;
  std::uint64_t moved = 0;
};

WallSeen wall_seen(double off_m, double jump_m) {
  Scenario scenario = parse_scenario(kWallScene, "wall.toml");
  scenario.scene.faults.front().amount = off_m;
  SimulatedSource source(scenario.scene, {}, 1);
  Configuration configuration;
  configuration.poses.jump_m = jump_m;
  configuration.voxels.fans.rule = FanMapperConfig::Rule::kStamp;
  Mapped mapped(configuration);
  WallSeen seen;
  std::optional<Time> looked_at;
  while (auto event = source.next()) {
    mapped.pipeline.on_event(std::move(*event));
    if (mapped.last_scan == looked_at || *mapped.last_scan - *mapped.first_scan < seconds(5.5)) continue;
    looked_at = mapped.last_scan;
    const bool another = std::any_of(mapped.obstacles.begin(), mapped.obstacles.end(),
                                     [](const Vector3d& p) { return std::abs(p.x() - kWall) > 2.5; });
    ++seen.scans;
    seen.scans_with_another += another ? 1 : 0;
  }
  mapped.pipeline.finish();
  const VoxelMap& map = *mapped.model.map();
  for_each_seen(map, [&](const VoxelIndex& v) {
    if (map.space(v) != Space::kOccupied) return;
    const bool at_it = std::abs(map.centre_of(v).x() - kWall) < 1.5;
    ++(at_it ? seen.voxels_at_it : seen.voxels_elsewhere);
  });
  seen.counts = mapped.pipeline.counts();
  seen.moved = mapped.model.outcome().moved;
  return seen;
}

// In both maps of the surroundings, whichever way the fix goes. ledger: S6-53 S5-13
TEST(APositionThatJumps, LeavesAWallSeenBeforeAndAfterAtOnePlace) {
  ISOBATH_NOT_SANITIZED();
  for (const double off_m : {8.0, -8.0}) {
    const WallSeen seen = wall_seen(off_m, 1);
    EXPECT_EQ(seen.counts.jumps, 1u);
    EXPECT_NEAR(seen.counts.farthest_jump_m, 8, 0.3);
    EXPECT_EQ(seen.moved, 1u);
    EXPECT_GT(seen.voxels_at_it, 100);
    EXPECT_LT(seen.voxels_elsewhere, 0.1 * seen.voxels_at_it) << off_m;
    EXPECT_GE(seen.scans, 5);
    EXPECT_EQ(seen.scans_with_another, 0) << off_m;
    // The scene shows what it is for: a jump that is taken for a way that the vehicle went makes a second wall.
    const WallSeen doubled = wall_seen(off_m, 1000);
    EXPECT_EQ(doubled.counts.jumps, 0u);
    EXPECT_GT(doubled.voxels_elsewhere, 0.2 * doubled.voxels_at_it);
    EXPECT_GT(doubled.scans_with_another, 2);
  }
}

/// A sounding ahead, four times.
void hear_point(VoxelModel& model, double t_s, const Vector3d& vehicle_W) {
  Swath swath;
  swath.time = Time(seconds(t_s));
  swath.soundings.push_back({{8.2f, 0, 0}, 8.2f, 0, 0, Sounding::Kind::kWater});
  for (int shot = 0; shot < 4; ++shot) model.update(swath, {{}, vehicle_W});
}

// ledger: S6-53
TEST(APositionThatJumps, LeavesWhatIsOldWhereEarlierFixesHavePutIt) {
  VoxelModelConfig config;
  config.fit = false;
  config.map.voxel_m = 0.5;
  const auto space_at = [](const VoxelModel& model, const Vector3d& p) {
    return model.map()->space(model.map()->voxel_at(p));
  };
  for (const double pause_s : {60.0, 300.0}) {
    VoxelModel model(config);
    hear_point(model, 10, {0, 0, 20});
    model.move_along({0, 6, 0});
    EXPECT_EQ(space_at(model, {8.2, 6, 20}), Space::kOccupied) << "heard since the start";
    EXPECT_EQ(space_at(model, {8.2, 0, 20}), Space::kUnknown);
    hear_point(model, 10 + pause_s, {50, 6, 20});
    model.move_along({0, 10, 0});
    EXPECT_EQ(space_at(model, {58.2, 16, 20}), Space::kOccupied);
    EXPECT_EQ(space_at(model, {8.2, pause_s > 120 ? 6.0 : 16.0, 20}), Space::kOccupied) << "after " << pause_s << " s";
    EXPECT_EQ(model.outcome().moved, 2u);
    EXPECT_EQ(model.outcome().occupied, 2u);
  }
}

// ledger: S6-53
TEST(APositionThatJumps, OutOfTheMapTakesAllAlongAndHarmsNothing) {
  VoxelModelConfig config;
  config.window_m = 100;
  VoxelModel model(config);
  hear_point(model, 10, {0, 0, 20});
  EXPECT_GT(model.outcome().seen, 0u);
  model.move_along({1e9, -1e300, 0});
  EXPECT_EQ(model.outcome().seen, 0u);
  hear_point(model, 11, {1e7, 0, 20});
  EXPECT_THAT(model.refused(), Contains(Pair("too far from the origin for voxels of this size", 4u)));
  hear_point(model, 12, {0, 0, 20});
  EXPECT_GT(model.outcome().seen, 0u);
}

// Fans of any width --------------------------------------------------------------------------------------------------

struct Target {
  double azimuth_deg, range_m;
};

/// Beams of 3 degrees from one azimuth on, that hear targets out of a level background.
Ping round_look(double t, double first_deg, int beams, const std::vector<Target>& targets, const Pose& X_BS = {}) {
  const auto fan = test::fan_of(beams, Angle::degrees(first_deg + 1.5), Angle::degrees(3));
  Ping ping = test::ping_of<std::uint8_t>(fan, {0, 0.2, 100}, [&](int beam, int bin) {
    for (const Target& target : targets) {
      const Angle off = (fan->azimuth[beam] - Angle::degrees(target.azimuth_deg)).wrapped();
      if (std::abs(off.degrees()) < 2.9 && std::abs((bin + 0.5) * 0.2 - target.range_m) < 0.25) return 250;
    }
    return 20;
  });
  ping.time = Time(seconds(t));
  ping.X_BS = X_BS;
  return ping;
}

/// Geometry alone: an echo is one at once, and raises all of its arc.
Configuration without_a_past() {
  Configuration configuration;
  configuration.voxels.fans.rule = FanMapperConfig::Rule::kStamp;
  configuration.echoes.method = DetectionMethod::kOrderedStatistic;
  return configuration;
}

/// Of all voxels that have become likelier, the greatest distance in the plane from the nearest target; and of all
/// targets, from the nearest such voxel.
std::pair<double, double> farthest_off(const VoxelMap& map, const std::vector<Vector3d>& targets) {
  double astray = 0;
  std::vector<double> missed(targets.size(), kInfinity);
  for_each_seen(map, [&](const VoxelIndex& v) {
    if (map.probability(v) <= 1.05 * map.config().prior) return;
    double nearest = kInfinity;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const double d = (map.centre_of(v) - targets[i]).head<2>().norm();
      nearest = std::min(nearest, d);
      missed[i] = std::min(missed[i], d);
    }
    astray = std::max(astray, nearest);
  });
  return {astray, *std::max_element(missed.begin(), missed.end())};
}

Vector3d place_of(const Target& target) {
  const Angle a = Angle::degrees(target.azimuth_deg);
  return {target.range_m * cos(a), target.range_m * sin(a), 0};
}

// Wherever the fan is cut open. ledger: S5-12
TEST(AFanWiderThanHalfACircle, IsMappedRightUpToAWholeTurn) {
  ISOBATH_NOT_SANITIZED();
  const std::vector<Target> targets{{0, 9}, {120, 12}, {-120, 7}, {178.5, 15}, {90, 17}};
  std::vector<Vector3d> places;
  for (const Target& target : targets) places.push_back(place_of(target));
  const std::vector<std::pair<double, int>> fans{{-180, 120}, {0, 120}, {-300, 120}, {700, 120}, {-135, 110}};
  for (const auto& [first_deg, beams] : fans) {
    Mapped mapped(without_a_past());
    for (int n = 0; n < 3; ++n) mapped.pipeline.on_event(round_look(n, first_deg, beams, targets));
    mapped.pipeline.finish();
    EXPECT_EQ(mapped.pipeline.counts().pings, 3u);
    EXPECT_TRUE(mapped.pipeline.rejected().empty());
    const auto [astray, missed] = farthest_off(*mapped.model.map(), places);
    EXPECT_LT(astray, 1.6) << "a fan of " << 3 * beams << " degrees from " << first_deg;
    EXPECT_LT(missed, 0.4) << "a fan of " << 3 * beams << " degrees from " << first_deg;
    EXPECT_GE(mapped.obstacles.size(), 3 * targets.size()) << "and in the plan view";
    for (const Vector3d& p : mapped.obstacles) {
      const auto near = [&](const Vector3d& place) { return (p - place).head<2>().norm() < 2; };
      EXPECT_TRUE(std::any_of(places.begin(), places.end(), near)) << p.transpose();
    }
  }
}

TEST(AFanWiderThanATurn, IsRefusedAndCounted) {
  Mapped mapped(without_a_past());
  mapped.pipeline.on_event(round_look(0, -180, 120, {{0, 9}}));
  mapped.pipeline.on_event(round_look(1, -190, 130, {{0, 9}}));
  mapped.pipeline.finish();
  EXPECT_EQ(mapped.pipeline.counts().pings, 1u);
  EXPECT_THAT(mapped.pipeline.rejected(), Contains(Pair("beams round more than a whole turn", 1u)));
}

// A target to starboard is there, whichever way the sonar hangs. ledger: S5-11
TEST(ASonarMountedUpsideDown, MapsToTheSideWhereThingsAre) {
  ISOBATH_NOT_SANITIZED();
  for (const double roll : {0.0, 180.0}) {
    const Pose X_BS{Rotation::from_heading_pitch_roll({}, {}, Angle::degrees(roll)), Vector3d::Zero()};
    const double turned = roll == 0 ? 1 : -1;  // its beams run the other way round
    Mapped mapped(without_a_past());
    for (int n = 0; n < 6; ++n) {
      mapped.pipeline.on_event(test::fix_at(n, 0));
      mapped.pipeline.on_event(round_look(n, -60, 40, {{turned * 35, 10}}, X_BS));
    }
    mapped.pipeline.finish();
    EXPECT_EQ(mapped.pipeline.counts().vertical, 0u);
    const auto [astray, missed] = farthest_off(*mapped.model.map(), {place_of({35, 10})});
    EXPECT_LT(astray, 1.6);
    EXPECT_LT(missed, 0.4);
    ASSERT_FALSE(mapped.obstacles.empty());
    for (const Vector3d& p : mapped.obstacles) EXPECT_LT((p - place_of({35, 10})).head<2>().norm(), 2);
  }
}

// What no map can use ------------------------------------------------------------------------------------------------

Ping with(const std::function<void(Ping&, BeamFan&)>& spoil) {
  Ping ping = round_look(1, -60, 40, {{0, 9}});
  auto fan = std::make_shared<BeamFan>(*ping.fan);
  spoil(ping, *fan);
  ping.fan = fan;
  return ping;
}

Ping of_numbers(float spoilt) {
  Ping ping = test::ping_of<float>(test::fan_of(40), {0, 0.2, 100},
                                   [&](int beam, int bin) { return beam == 7 && bin == 31 ? spoilt : 20.0f; });
  ping.time = Time(seconds(1));
  return ping;
}

// ledger: S6-15
TEST(PingsThatNoMapCanUse, AreCountedByTheirReasonAndChangeNothing) {
  const std::map<std::string, std::vector<Ping>> bad{
      {"no usable range window",
       {with([](Ping& p, BeamFan&) { p.window.bin_m = 0; }), with([](Ping& p, BeamFan&) { p.window.bin_m = -0.2; }),
        with([](Ping& p, BeamFan&) { p.window.bin_m = kNan; }),
        with([](Ping& p, BeamFan&) { p.window.bin_m = kInfinity; }),
        with([](Ping& p, BeamFan&) { p.window.start_m = -3; }),
        with([](Ping& p, BeamFan&) { p.window.start_m = kNan; }), with([](Ping& p, BeamFan&) { p.window.bins = 0; }),
        with([](Ping& p, BeamFan&) { p.window.bins = -4; })}},
      {"beams out of order or without width",
       {with([](Ping&, BeamFan& f) { f.azimuth.clear(), f.width.clear(); }),
        with([](Ping&, BeamFan& f) { f.width.pop_back(); }),
        with([](Ping&, BeamFan& f) { std::swap(f.azimuth[3], f.azimuth[30]); }),
        with([](Ping&, BeamFan& f) { f.azimuth[3] = f.azimuth[4]; }),
        with([](Ping&, BeamFan& f) { f.azimuth[3] = Angle::radians(double{kNan}); }),
        with([](Ping&, BeamFan& f) { f.azimuth.back() = Angle::radians(double{kInfinity}); }),
        with([](Ping&, BeamFan& f) { f.width[3] = {}; }),
        with([](Ping&, BeamFan& f) { f.width[3] = Angle::degrees(-3); }),
        with([](Ping&, BeamFan& f) { f.height = {}; }),
        with([](Ping&, BeamFan& f) { f.height = Angle::radians(double{kInfinity}); })}},
      {"bins, range or mount of a size that no sonar has",
       {with([](Ping& p, BeamFan&) { p.window.bin_m = 1e-6; }), with([](Ping& p, BeamFan&) { p.window.bin_m = 2e4; }),
        with([](Ping& p, BeamFan&) { p.X_BS.translation.x() = 1e300; })}},
      {"samples do not match beams and bins",
       {with([](Ping& p, BeamFan&) { p.window.bins = 99; }), with([](Ping& p, BeamFan&) { p.intensity = {}; }),
        with([](Ping&, BeamFan& f) { f.azimuth.pop_back(), f.width.pop_back(); })}},
      {"value not finite",
       {of_numbers(std::numeric_limits<float>::quiet_NaN()), of_numbers(std::numeric_limits<float>::infinity()),
        with([](Ping& p, BeamFan&) { p.X_BS.translation.y() = kNan; }),
        with([](Ping& p, BeamFan&) { p.sound_speed = kNan; })}}};
  Mapped mapped(without_a_past());
  mapped.pipeline.on_event(round_look(1, -60, 40, {{0, 9}}));
  mapped.pipeline.finish();
  const std::uint64_t seen = mapped.model.outcome().seen;
  EXPECT_GT(seen, 1000u);
  for (const auto& [reason, pings] : bad) {
    for (const Ping& ping : pings) mapped.pipeline.on_event(ping);
    EXPECT_THAT(mapped.pipeline.rejected(), Contains(Pair(reason, pings.size())));
  }
  Ping nobodys = round_look(1, -60, 40, {});
  nobodys.fan = nullptr;
  mapped.pipeline.on_event(nobodys);
  EXPECT_THAT(mapped.pipeline.rejected(), Contains(Pair("no beams", 1u)));
  Navigation lost = test::fix_at(1, 0);
  lost.X_WB.translation.z() = kNan;
  mapped.pipeline.on_event(lost);
  EXPECT_THAT(mapped.pipeline.rejected(), Contains(Pair("navigation not finite", 1u)));
  mapped.pipeline.finish();
  EXPECT_EQ(mapped.pipeline.counts().pings, 1u);
  EXPECT_EQ(mapped.model.outcome().seen, seen);
  mapped.pipeline.on_event(of_numbers(20));
  mapped.pipeline.finish();
  EXPECT_EQ(mapped.pipeline.counts().pings, 2u) << "and it goes on";
}

// A sonar that changes its range within reason stays in the map; one whose bins or range have nothing to do with the
// voxels that the first ping has set is left out, and the run goes on.
TEST(PingsThatNoMapCanUse, OfAnotherScaleAreLeftOutOfTheVoxels) {
  Mapped mapped(without_a_past());
  const auto scaled = [](double t, double factor) {
    Ping ping = round_look(t, -60, 40, {{0, 9}});
    ping.window.bin_m *= factor;
    return ping;
  };
  mapped.pipeline.on_event(scaled(1, 1));
  mapped.pipeline.on_event(scaled(2, 1.5));
  mapped.pipeline.on_event(scaled(3, 0.1));
  EXPECT_TRUE(mapped.model.refused().empty());
  for (const double factor : {1e-4, 1e-9, 300.0, 1e6, 1e200}) mapped.pipeline.on_event(scaled(4, factor));
  mapped.pipeline.finish();
  EXPECT_EQ(mapped.pipeline.counts().pings, 5u) << "the plan view takes them all";
  EXPECT_THAT(mapped.pipeline.rejected(),
              testing::ElementsAre(Pair("bins, range or mount of a size that no sonar has", 3u)));
  EXPECT_THAT(mapped.model.refused(),
              testing::UnorderedElementsAre(Pair("voxels far too large for the bins of a ping", 1u),
                                            Pair("voxels far too small for the range of a ping", 1u)));
  EXPECT_EQ(mapped.model.outcome().layers.front().pings, 3u);
}

}  // namespace
}  // namespace isobath
