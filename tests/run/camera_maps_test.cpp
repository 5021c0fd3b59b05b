// What the ranges of a pair of cameras make of the maps of a run, against the scene.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/run/closed_loop.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/world/depth_model.hpp>
#include <isobath/world/voxel_model.hpp>
#include <tests/support/data.hpp>
#include <tests/support/straight_helm.hpp>

namespace isobath::camera_maps {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

/// The maps of a run as they are at its end.
class Maps : public OnboardObserver {
 public:
  std::shared_ptr<const DepthSnapshot> depths;
  std::vector<ColumnTop> tops;
  double voxel_m = 0;
  void on_mapped(Time time, const Pipeline&, const DepthModel& model, const VoxelModel& voxels) override {
    if (to_seconds(time) < kUntil_s - 0.01) return;
    depths = model.snapshot();
    tops = voxels.tops();
    if (voxels.map()) voxel_m = voxels.map()->voxel_m();
  }
  static constexpr double kUntil_s = 20;
};

/// The depths that the scene truly has within half a side of a place, the shallowest first.
std::pair<double, double> true_depths(const World& world, const Vector2d& place, double half_side) {
  double shallowest = 1e9, deepest = 0;
  constexpr int kSteps = 8;
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      const Vector3d from(place.x() + half_side * i / kSteps, place.y() + half_side * j / kSteps, 0.1);
      const auto hit = world.cast(from, Vector3d::UnitZ(), 100);
      const double depth = hit ? from.z() + hit->range : 100;
      shallowest = std::min(shallowest, depth);
      deepest = std::max(deepest, depth);
    }
  }
  return {shallowest, deepest};
}

// A vehicle passes 2 m above boulders; the standard deviation of a range at 2 m is 7 cm.
// ledger: S8-07 S1-79 S5-13
TEST(CameraMaps, DepthsAndVoxelsOfASurveyByCamerasAreThoseOfTheScene) {
  const Scenario scenario =
      load_scenario((test::source_folder() / "scenarios/cameras/survey_by_cameras.toml").string());
  Maps maps;
  test::StraightHelm helm({Angle{}, 6, 0.25}, Maps::kUntil_s);
  LoopRequest request;
  request.observers = {&maps};
  request.configuration.simulation.duration_s = Maps::kUntil_s + 0.1;
  run_closed_loop(scenario, helm, request);
  ASSERT_TRUE(maps.depths);
  const World world(scenario.scene);
  const PixelGrid grid = maps.depths->grid();
  int known = 0, right = 0;
  for (double north = -1; north < 6; north += grid.pixel_m) {
    for (double east = -1.5; east < 1.5; east += grid.pixel_m) {
      const Pixel p = grid.at({north, east});
      const DepthPixel pixel = maps.depths->at(p);
      if (!pixel.known() || !pixel.has(kSensed)) continue;
      ++known;
      const auto [shallowest, deepest] = true_depths(world, grid.centre(p), grid.pixel_m / 2);
      right += pixel.depth_m() > shallowest - 0.15 && pixel.depth_m() < deepest + 0.15 ? 1 : 0;
    }
  }
  RecordProperty("depth_pixels", known);
  RecordProperty("depth_pixels_right", right);
  EXPECT_GT(known, 40);
  EXPECT_GE(right, 0.95 * known) << known;
  EXPECT_EQ(maps.voxel_m, 0.1) << "as large as a range is unsure";
  int tops_right = 0;
  for (const ColumnTop& top : maps.tops) {
    const auto [shallowest, deepest] = true_depths(world, top.north_east, maps.voxel_m);
    tops_right += top.depth_m > shallowest - 0.2 && top.depth_m < deepest + 0.2 ? 1 : 0;
  }
  RecordProperty("columns", static_cast<int>(maps.tops.size()));
  RecordProperty("columns_right", tops_right);
  EXPECT_GT(maps.tops.size(), 300u);
  EXPECT_GE(tops_right, 0.95 * static_cast<double>(maps.tops.size())) << maps.tops.size();
}

}  // namespace
}  // namespace isobath::camera_maps
