// Maps in three dimensions held against the scenes that they were made of.
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/scenario/voxel_scorer.hpp>
#include <isobath/world/voxel_model.hpp>
#include <tests/support/data.hpp>
#include <tuple>
#include <vector>

namespace isobath::voxel_truth_test {
namespace {

using Rule = FanMapperConfig::Rule;

class VoxelsAlone : public ResultSink {
 public:
  explicit VoxelsAlone(const VoxelModelConfig& config) : model(config) {}
  void on_ping(const PosedPing& posed) override { model.update(posed); }
  void on_vertical_ping(const PosedPing& posed) override { model.update(posed); }
  void on_scan(const ScanResult&) override {}
  VoxelModel model;
};

Scene scene_of(const std::string& name) {
  return load_scenario((test::source_folder() / "scenarios" / name).string()).scene;
}

VoxelTruth score_of(Scene scene, double duration_s, const FanMapperConfig& fans,
                    const EchoDetectorConfig& echoes = {}) {
  SimulationConfig simulation;
  simulation.duration_s = duration_s;
  SimulatedSource source(std::move(scene), simulation, 1);
  VoxelModelConfig config;
  config.fans = fans;
  VoxelsAlone sink(config);
  Configuration configuration;
  configuration.echoes = echoes;
  Pipeline pipeline(configuration, sink);
  while (auto event = source.next()) pipeline.on_event(std::move(*event));
  pipeline.finish();
  return judge(*sink.model.map(), source.simulator().world());
}

FanMapperConfig by(Rule rule) {
  FanMapperConfig config;
  config.rule = rule;
  return config;
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
  for (int shot = 0; shot < 4; ++shot) model.update(swath, X_WB);
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
  // The rules are compared on the decisions of samples, many of them faint: cells leave little to tell apart.
  EchoDetectorConfig samples;
  samples.method = DetectionMethod::kLearnt;
  const VoxelTruth marginal = score_of(scene, duration_s, by(Rule::kMarginal), samples),
                   stamp = score_of(scene, duration_s, by(Rule::kStamp), samples),
                   counted = score_of(scene, duration_s, by(Rule::kHitAndMiss), samples);
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

/// The room of lines and arcs, by the bridge's two fans. Its sound travels at 1500 m/s.
Scene room() {
  Scene room = scene_of("polygon_room.toml");
  room.sonars = scene_of("bridge.toml").sonars;
  for (SonarConfig& sonar : room.sonars) sonar.sound_speed = 1500;
  return room;
}

// ledger: S5-31 S4-31
TEST(VoxelTruth, OfARoomIsBestMetByTheMarginalRule) { expect_the_marginal_rule_ahead(room(), 12); }

void print(const std::string& name, const VoxelTruth& t) {
  std::printf("%s: log-loss %.4f, occupied %llu, precision %.3f, surface %llu, recall %.3f;", name.c_str(), t.log_loss,
              static_cast<unsigned long long>(t.occupied), t.precision(), static_cast<unsigned long long>(t.surface),
              t.recall());
  for (const VoxelTruth::Said& s : t.by_probability) {
    if (s.voxels == 0) continue;
    std::printf(" %.2f:%.2f(%llu)", s.probability, static_cast<double>(s.surface) / static_cast<double>(s.voxels),
                static_cast<unsigned long long>(s.voxels));
  }
  std::printf("\n");
}

/// The farthest that a tenth of the scale is off the diagonal, of those that hold enough voxels.
double off_the_diagonal(const VoxelTruth& t, std::uint64_t enough) {
  double farthest = 0;
  for (const VoxelTruth::Said& s : t.by_probability) {
    if (s.voxels < enough) continue;
    farthest =
        std::max(farthest, std::abs(s.probability - static_cast<double>(s.surface) / static_cast<double>(s.voxels)));
  }
  return farthest;
}

EchoDetectorConfig ordered_statistic() {
  EchoDetectorConfig echoes;
  echoes.method = DetectionMethod::kOrderedStatistic;
  echoes.false_alarm = 0.0001;
  return echoes;
}

/// What holds of a scene after 20 s (the room: 12 s), by either way of deciding echoes.
struct Bars {
  double off, off_ordered;   ///< bound reached: tenths with 500 voxels and more
  double precision, recall;  ///< of the default decisions
  double off_marginal;       ///< at least so far off is the rule without dependence
};
void expect_reliable(const std::string& name, const Scene& scene, double duration_s, const Bars& bars) {
  constexpr std::uint64_t kEnough = 500;
  const VoxelTruth aspects = score_of(scene, duration_s, by(Rule::kAspects));
  const VoxelTruth marginal = score_of(scene, duration_s, by(Rule::kMarginal));
  const VoxelTruth ordered = score_of(scene, duration_s, by(Rule::kAspects), ordered_statistic());
  print(name + ", aspects", aspects);
  print(name + ", marginal", marginal);
  print(name + ", aspects, os_cfar at 0.0001", ordered);
  // Every voxel that any echo can be of is occupied: no evidence finds more surfaces than this does.
  FanMapperConfig any = by(Rule::kHitAndMiss);
  any.hit = 10;
  any.miss = 0;
  print(name + ", every voxel in which an echo was heard", score_of(scene, duration_s, any));
  EXPECT_LT(off_the_diagonal(aspects, kEnough), bars.off);
  EXPECT_LT(off_the_diagonal(ordered, kEnough), bars.off_ordered);
  EXPECT_GT(off_the_diagonal(marginal, kEnough), bars.off_marginal);
  EXPECT_GT(aspects.precision(), bars.precision);
  EXPECT_GT(aspects.recall(), bars.recall);
}

// By default each tenth of the scale with 500 voxels and more is within 0.1 of the truth. ledger: S5-31 S5-35 S5-38
TEST(VoxelReliability, OfTheBridge) {
  expect_reliable("bridge", scene_of("bridge.toml"), 20, {0.1, 0.62, 0.68, 0.05, 0.05});
}
TEST(VoxelReliability, OfTheRoom) { expect_reliable("room", room(), 12, {0.1, 0.3, 0.7, 0.8, 0.3}); }
TEST(VoxelReliability, OfClutterAtAllHeights) {
  expect_reliable("clutter", scene_of("clutter_fans.toml"), 20, {0.1, 0.6, 0.68, 0.17, 0.15});
}

// Echoes of one direction without a limit make voxels surer than they are. What the other parts of the rule give stands
// in docs/three-dimensions.md.
TEST(VoxelReliability, NeedsTheLimitOfEchoes) {
  FanMapperConfig unlimited = by(Rule::kAspects);
  unlimited.aspects.max_log_odds = 30;
  const VoxelTruth with = score_of(room(), 8, by(Rule::kAspects)), without = score_of(room(), 8, unlimited);
  print("aspects", with);
  print("echoes have no limit", without);
  EXPECT_LT(with.log_loss, 0.9 * without.log_loss);
  EXPECT_LT(off_the_diagonal(with, 500), off_the_diagonal(without, 500));
}

}  // namespace
}  // namespace isobath::voxel_truth_test
