// Maps in three dimensions held against the scenes that they were made of.
#include <cstdio>
#include <gtest/gtest.h>
#include <isobath/runtime/scenario.hpp>
#include <isobath/runtime/voxel_model.hpp>
#include <isobath/runtime/voxel_truth.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Rule = FanMapperConfig::Rule;

class VoxelsAlone : public ResultSink {
 public:
  explicit VoxelsAlone(const VoxelModelConfig& config) : model(config) {}
  void on_ping(const PosedPing& posed) override { model.take(posed); }
  void on_upright(const PosedPing& posed) override { model.take(posed); }
  void on_scan(const ScanResult&) override {}
  VoxelModel model;
};

Scene scene_of(const std::string& name) {
  return load_scenario((test::source_folder() / "scenarios" / name).string()).scene;
}

VoxelTruth score_of(Scene scene, double duration_s, Rule rule) {
  SimulationConfig simulation;
  simulation.duration_s = duration_s;
  SimulatedSource source(std::move(scene), simulation, 1);
  VoxelModelConfig config;
  config.fans.rule = rule;
  VoxelsAlone sink(config);
  Pipeline pipeline({}, sink);
  while (auto event = source.next()) pipeline.take(std::move(*event));
  pipeline.finish();
  return judge(*sink.model.map(), source.simulator().world());
}

// A wall ahead, seen in four shots by beams a tenth of a radian apart: occupied where it is, free before it, unknown
// behind it and beside the beams; a voxel that one beam passes and another ends in holds the echo.
TEST(VoxelModelOfSoundings, IsFreeAlongTheBeamAndOccupiedAtItsEnd) {
  VoxelModelConfig config;
  config.fit = false;
  config.map.voxel_m = 0.5;
  VoxelModel model(config);
  Swath swath;
  for (int row = -3; row <= 3; ++row) {
    for (int column = -5; column <= 5; ++column) {
      const Eigen::Vector3d p(8.25, 0.825 * column, 0.825 * row);
      swath.soundings.push_back({p.cast<float>(), static_cast<float>(p.norm()), 0, 0, Sounding::Kind::kWater});
    }
  }
  Sounding bottom{{3, 0, 3}, 4.3f, 0, 0, Sounding::Kind::kBottom};
  swath.soundings.push_back(bottom);
  const Pose X_WB{Rotation::from_heading(Angle::degrees(90)), {100, 20, 30}};  // looks east
  for (int shot = 0; shot < 4; ++shot) model.take(swath, X_WB);
  ASSERT_TRUE(model.map());
  const VoxelMap& map = *model.map();
  const auto space_at = [&](double ahead, double starboard, double down) {
    return map.space(map.voxel_at(X_WB * Eigen::Vector3d(ahead, starboard, down)));
  };
  for (int row = -3; row <= 3; ++row) {
    for (int column = -5; column <= 5; ++column) {
      EXPECT_EQ(space_at(8.25, 0.825 * column, 0.825 * row), Space::kOccupied);
      EXPECT_EQ(space_at(4.1, 0.41 * column, 0.41 * row), Space::kFree);
      EXPECT_EQ(space_at(9.25, 0.925 * column, 0.925 * row), Space::kUnknown) << "behind";
    }
  }
  EXPECT_EQ(space_at(3, 0, 3), Space::kUnknown) << "a sounding of the bottom";
  EXPECT_EQ(space_at(-2, 0, 0), Space::kUnknown);
  EXPECT_EQ(model.outcome().layers.size(), 1u);
  EXPECT_EQ(model.outcome().layers[0].sensor, "soundings");
  EXPECT_EQ(model.outcome().layers[0].pings, 4u);
}

void expect_the_marginal_rule_ahead(const Scene& scene, double duration_s) {
  const VoxelTruth marginal = score_of(scene, duration_s, Rule::kMarginal),
                   stamp = score_of(scene, duration_s, Rule::kStamp),
                   counted = score_of(scene, duration_s, Rule::kHitAndMiss);
  for (const auto& [name, t] : {std::pair{"marginal", marginal}, {"stamp", stamp}, {"hit and miss", counted}}) {
    std::printf("%s: log-loss %.4f, precision %.3f of %llu, recall %.3f of %llu\n", name, t.log_loss, t.precision(),
                static_cast<unsigned long long>(t.occupied), t.recall(), static_cast<unsigned long long>(t.surface));
  }
  EXPECT_LT(marginal.log_loss, stamp.log_loss);
  EXPECT_LT(marginal.log_loss, counted.log_loss);
  EXPECT_GT(marginal.precision(), stamp.precision());
}

// ledger: S5-31 S5-35 S5-38 S5-D06
TEST(VoxelTruth, OfTheBridgeIsBestMetByTheMarginalRule) { expect_the_marginal_rule_ahead(scene_of("bridge.toml"), 12); }

// The room of lines and arcs, by the bridge's two fans. ledger: S5-31 S4-31
TEST(VoxelTruth, OfARoomIsBestMetByTheMarginalRule) {
  Scene room = scene_of("polygon_room.toml");
  room.sonars = scene_of("bridge.toml").sonars;
  expect_the_marginal_rule_ahead(room, 12);
}

}  // namespace
}  // namespace isobath
