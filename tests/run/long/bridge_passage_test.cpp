// Under the bridge: neither sonar alone shows a way, both together do, and a vehicle takes it.
#include <gmock/gmock.h>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/planning/space_route.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/world/voxel_model.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

// Of scenarios/bridge.toml: the pylons beside the way stand at 4.5 m to either side, 0.6 m thick; the berm rises to 5.2
// m.
constexpr double kPylons = 45, kBerm = 32, kHalfWidth = 3.9, kBermTop = 5.2;

/// Maps all pings until the vehicle has come so far north; the scans are counted, and the last pose kept.
class Approach : public ResultSink {
 public:
  Approach(const std::string& without, double north) : model(VoxelModelConfig{}) {
    SimulationConfig simulation;
    simulation.without = without;
    SimulatedSource source(load_scenario((test::source_folder() / "scenarios/bridge.toml").string()).scene, simulation,
                           1);
    Pipeline pipeline({}, *this);
    while (auto event = source.next()) {
      pipeline.on_event(std::move(*event));
      if (vehicle.x() > north) break;
    }
  }
  void on_ping(const PosedPing& posed) override { take(posed); }
  void on_vertical_ping(const PosedPing& posed) override { take(posed); }
  void on_scan(const ScanResult&) override {}

  /// As a vehicle there would plan, with nothing but measured water to go through where the plan view is closed.
  [[nodiscard]] Result<SpaceRoutePath, RouteRefusal> plan(const std::vector<std::string>& heights,
                                                          const std::vector<Hazard>& plan_view) const {
    const OccupancySnapshot grid(*model.map(), heights, vehicle, 80);
    SpaceRouteTask task;
    task.start = vehicle;
    task.goal = {60, 0, 3};
    task.half_width_m = 0.15;
    task.hazards = plan_view;
    SpaceRouteConfig config;
    config.decide_m = 1000;
    return plan_space_route(grid, task, config);
  }

  VoxelModel model;
  Vector3d vehicle = Vector3d::Zero();

 private:
  void take(const PosedPing& posed) {
    model.update(posed);
    vehicle = posed.X_WB.translation;
  }
};

Hazard closed(double north, double east, double half_north, double half_east) {
  return {{{north - half_north, east - half_east},
           {north + half_north, east - half_east},
           {north + half_north, east + half_east},
           {north - half_north, east + half_east}},
          0,
          HazardKind::kSeen,
          0};
}

// ledger: S5-34 S5-35 S5-D05 S5-D06
TEST(BridgePassage, IsFoundByBothSonarsTogetherAndByNeitherAlone) {
  const Approach both("", 13), flat("vertical", 13), vertical("horizontal", 13), sooner("vertical", 8);
  // What a fan that lies flat makes of it: the berm from bank to bank, and the pylons.
  std::vector<Hazard> plan_view = {closed(kBerm, 0, 2, 43)};
  for (double east = -31.5; east < 32; east += 9) plan_view.push_back(closed(kPylons, east, 1, 1));
  EXPECT_FALSE(flat.plan({"upright"}, plan_view)) << "it tells no height";
  EXPECT_FALSE(sooner.plan({"flat"}, plan_view)) << "and were it believed of all heights, the berm reaches through all";
  // A fan that stands upright makes none: all that it has not measured may be closed.
  EXPECT_FALSE(vertical.plan({"upright"}, {closed(40, 0, 11, 43)}));
  const auto path = both.plan({"upright"}, plan_view);
  ASSERT_TRUE(path) << to_text(path.error());
  // It keeps clear of what truly stands there.
  for (std::size_t i = 1; i < path->points.size(); ++i) {
    const Vector3d a = path->points[i - 1], leg = path->points[i] - a;
    for (int k = 0; k <= 200; ++k) {
      const Vector3d p = a + leg * k / 200;
      EXPECT_GT(p.z(), 0.5);
      const bool between_pylons = std::abs(p.x() - kPylons) < 1.5, over_berm = std::abs(p.x() - kBerm) < 4;
      EXPECT_TRUE(!between_pylons || std::abs(p.y()) < kHalfWidth - 0.5) << p.transpose();
      EXPECT_TRUE(!over_berm || p.z() < kBermTop - 0.5) << p.transpose();
    }
  }
}

// What both know to be free holds the opening, 1.5 m less on each side, from before the berm to behind the pylons.
// ledger: S5-35 S5-D06
TEST(BridgePassage, CorridorHoldsTheOpening) {
  const Approach both("", 18);
  const VoxelMap& map = *both.model.map();
  int all = 0, free = 0;
  for (double north = 28.25; north < 48; north += 0.5) {
    for (double east = -kHalfWidth + 1.5; east <= kHalfWidth - 1.5; east += 0.5) {
      for (double depth = 1.5; depth <= kBermTop - 1.5; depth += 0.5) {
        const VoxelIndex v = map.voxel_at({north, east, depth});
        ++all;
        free += map.is_seen(v) && map.probability(v) <= OccupancySnapshot::kMaxMeasured;
      }
    }
  }
  EXPECT_GE(free, 0.995 * all);
}

LoopResult sail(const std::string& without, int seed) {
  Scenario scenario = load_scenario((test::source_folder() / "scenarios/bridge.toml").string());
  LoopRequest request;
  request.configuration.simulation.without = without;
  request.configuration.simulation.seed = seed;
  MissionSetup setup;
  setup.plan = scenario.mission;
  setup.vehicle = parameters_of(load_vehicle(scenario.scene.vehicle.file));
  const auto helm = make_serial_helm(setup, request.configuration);
  return run_closed_loop(scenario, *helm, request);
}

bool says(const std::vector<Decision>& decisions, const std::string& agent, const std::string& words) {
  return std::any_of(decisions.begin(), decisions.end(), [&](const Decision& d) {
    return d.agent == agent && (d.what + ": " + d.reason).find(words) != std::string::npos;
  });
}

// The berm closes the plane from bank to bank: the way leads over it. ledger: S3-35 S5-35 S5-37 S5-F05
TEST(BridgePassage, IsSailed) {
  const LoopResult run = sail("", 1);
  EXPECT_EQ(run.report.reached, 1u);
  EXPECT_LT(run.contact_s, 0);
  EXPECT_GT(run.min_clearance_m, 0.8);
  EXPECT_TRUE(says(run.decisions, "navigator", "of depth the clearance is"));
}

// ledger: S5-34
TEST(BridgePassage, IsRefusedWhereNothingTellsHeight) {
  const LoopResult run = sail("vertical", 1);
  EXPECT_EQ(run.report.reached, 0u);
  EXPECT_LT(run.contact_s, 0);
  EXPECT_TRUE(says(run.decisions, "safety officer", "no path"));
}

}  // namespace
}  // namespace isobath
