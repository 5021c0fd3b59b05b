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

VoxelTruth score_of(const std::string& scene, double duration_s, Rule rule) {
  SimulationConfig simulation;
  simulation.duration_s = duration_s;
  SimulatedSource source(load_scene((test::source_folder() / "scenarios" / scene).string()), simulation, 1);
  VoxelModelConfig config;
  config.fans.rule = rule;
  VoxelsAlone sink(config);
  Pipeline pipeline({}, sink);
  while (auto event = source.next()) pipeline.take(std::move(*event));
  pipeline.finish();
  return judge(*sink.model.map(), source.simulator().world());
}

// ledger: S5-31 S5-35 S5-38 S5-D06
TEST(VoxelTruth, OfTheBridgeIsBestMetByTheMarginalRule) {
  const VoxelTruth marginal = score_of("bridge.toml", 12, Rule::kMarginal),
                   stamp = score_of("bridge.toml", 12, Rule::kStamp),
                   counted = score_of("bridge.toml", 12, Rule::kHitAndMiss);
  for (const auto& [name, t] : {std::pair{"marginal", marginal}, {"stamp", stamp}, {"hit and miss", counted}}) {
    std::printf("%s: log-loss %.4f, precision %.3f of %llu, recall %.3f of %llu\n", name, t.log_loss, t.precision(),
                static_cast<unsigned long long>(t.occupied), t.recall(), static_cast<unsigned long long>(t.surface));
  }
  EXPECT_LT(marginal.log_loss, stamp.log_loss);
  EXPECT_LT(marginal.log_loss, counted.log_loss);
  EXPECT_GT(marginal.precision(), stamp.precision());
}

}  // namespace
}  // namespace isobath
