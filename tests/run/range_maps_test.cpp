// What the readings of range sonars make of the maps of a run: the depth map, and the spherical grid beside it.
#include <algorithm>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <isobath/run/closed_loop.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/world/depth_model.hpp>
#include <numbers>
#include <tests/support/straight_helm.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

/// The maps of a run as they are at its end.
class LastMaps : public OnboardObserver {
 public:
  std::shared_ptr<const DepthSnapshot> depths;
  std::shared_ptr<const GridSnapshot> sphere;
  void on_mapped(Time, const Pipeline&, const DepthModel& model, const VoxelModel&) override {
    depths = model.snapshot();
  }
  void on_sphere(Time, const std::shared_ptr<const GridSnapshot>& grid) override { sphere = grid; }
};

LastMaps maps_of(const std::string& scene, double depth_m, double speed) {
  LastMaps maps;
  test::StraightHelm helm({Angle{}, depth_m, speed});
  LoopRequest request;
  request.observers = {&maps};
  request.configuration.mission.chart_room.sphere = true;  // keeps the grid
  run_closed_loop(parse_scenario(scene, "ranges.toml"), helm, request);
  return maps;
}

/// A wall ahead and a pile to starboard of it, heard by three cones, which overlap.
constexpr const char* kWallAndPile = R"(
[scene]
title = "A wall and a pile"
duration_s = 12
[vehicle]
start = [0, 0, 5]
speed = 0.5
[[wall]]
name = "wall"
line = [[30, 14], [30, -14]]
top = 0
bottom = 12
[[cylinder]]
name = "pile"
centre = [18, 7, 6]
radius = 0.6
length = 12
[[sonar]]
preset = "obstacle_cone"
[[sonar]]
preset = "obstacle_cone"
heading_deg = 20
[[sonar]]
preset = "obstacle_cone"
heading_deg = -10
)";

/// Places of the obstacles ahead, in plan: pixels that a forward sonar raised.
std::vector<Vector2d> obstacle_pixels(const DepthSnapshot& depths) {
  std::vector<Vector2d> places;
  const PixelGrid grid = depths.grid();
  for (double north = 0; north < 60; north += grid.pixel_m) {
    for (double east = -30; east < 30; east += grid.pixel_m) {
      const Pixel p = grid.at({north, east});
      if (depths.at(p).has(kSeenByObstacle)) places.push_back(grid.centre(p));
    }
  }
  return places;
}

std::vector<Vector2d> obstacle_cells(const GridSnapshot& sphere) {
  std::vector<Vector2d> places;
  sphere.grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      if (!sphere.grid.is_obstacle(cell)) continue;
      const Eigen::Vector3d p_W = sphere.X_WB.translation + world_from_grid_axes(sphere.grid.point_of(cell));
      places.emplace_back(p_W.head<2>());
    }
  });
  return places;
}

double nearest_of(const std::vector<Vector2d>& places, const Vector2d& p) {
  double nearest = 1e9;
  for (const Vector2d& place : places) nearest = std::min(nearest, (place - p).norm());
  return nearest;
}

// Each obstacle of the spherical grid is one of the depth map within a cell, and the other way round within a cell and
// half the beam, over whose whole width the depth map raises an echo (S1-E15). ledger: S1-80
TEST(RangeMaps, ADepthMapAndASphericalGridOfTheSameReadingsShowTheSameObstacles) {
  const LastMaps maps = maps_of(kWallAndPile, 5, 0.5);
  ASSERT_TRUE(maps.depths && maps.sphere);
  const std::vector<Vector2d> pixels = obstacle_pixels(*maps.depths), cells = obstacle_cells(*maps.sphere);
  const Vector2d here = maps.sphere->X_WB.translation.head<2>();
  const double bucket = maps.sphere->grid.config().bucket.radians(), half_beam = Angle::degrees(5).radians();
  const double pixel_m = maps.depths->grid().pixel_m;
  int of_pile = 0, of_wall = 0;
  for (const Vector2d& cell : cells) {
    EXPECT_LE(nearest_of(pixels, cell), bucket * (cell - here).norm() + pixel_m / 2) << cell.transpose();
    ++(cell.x() < 24 ? of_pile : of_wall);
  }
  for (const Vector2d& pixel : pixels) {
    const double range = (pixel - here).norm();
    EXPECT_LE(nearest_of(cells, pixel), (bucket + half_beam) * range + pixel_m / 2) << pixel.transpose();
  }
  EXPECT_GT(of_pile, 3);
  EXPECT_GT(of_wall, 3);
}

/// A pole that reaches from the bottom to mid-water, heard by cones of these depressions, deg, in this order.
double mapped_top_of_a_pole(const std::vector<double>& depressions, const Vector2d& pole) {
  std::string scene = fmt::format(R"(
[scene]
title = "A pole"
duration_s = 20
[vehicle]
start = [0, 0, 10]
speed = 0.1
[bottom]
kind = "flat"
depth = 30
extent_m = 100
[[cylinder]]
name = "pole"
centre = [{}, {}, 21.25]
radius = 0.4
length = 17.5
)",
                                  pole.x(), pole.y());
  for (const double depression : depressions) {
    scene += fmt::format("[[sonar]]\npreset = \"obstacle_cone\"\npitch_deg = {}\n", -depression);
  }
  const LastMaps maps = maps_of(scene, 10, 0.1);
  return maps.depths ? maps.depths->at(maps.depths->grid().at(pole)).depth_m() : 0;
}

// The beam ahead passes over the pole, those below it meet it. The map has the highest of their bounds, whichever
// speaks first or last; the steepest beam alone bounds it too low. ledger: S1-67
TEST(RangeMaps, SeveralBeamsFindTheTopOfAPoleInWhateverOrderTheySpeak) {
  const double top = 12.5, half_height = 20 * std::tan(5 * std::numbers::pi / 180);
  const Vector2d pole(20.2, 0.2);
  for (const std::vector<double>& order : {std::vector<double>{0, 8, 20}, {20, 8, 0}, {8, 20, 0}, {0, 20, 8}}) {
    EXPECT_NEAR(mapped_top_of_a_pole(order, pole), top, half_height) << "the cone at " << order[0] << " deg first";
  }
  EXPECT_GT(mapped_top_of_a_pole({20}, pole), top + half_height);
}

}  // namespace
}  // namespace isobath
