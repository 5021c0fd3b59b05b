#include <cmath>
#include <fmt/format.h>
#include <isobath/map/spherical/spherical_layers.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/spherical_sizes.hpp>
#include <vector>

namespace isobath {
namespace {

constexpr int kSlicePixels = 640;
constexpr Colour kCells{0.0, 0.35, 0.65, 0.9}, kSquares{0.75, 0.3, 0.1, 0.9};
constexpr double kThin = 0.6;

}  // namespace

SphericalSizes spherical_sizes(const SphericalGridConfig& config, double range_m) {
  const SphericalLayers layers(config.min_layer_m, config.bucket, range_m);
  const DirectionBuckets buckets(config.bucket);
  SphericalSizes sizes;
  sizes.range_m = range_m;
  sizes.layers = layers.count();
  sizes.uniform_layers = static_cast<int>(std::ceil(range_m / config.min_layer_m - 1e-9));
  const auto directions = static_cast<std::uint64_t>(buckets.count());
  const auto across = static_cast<std::uint64_t>(std::ceil(2 * range_m / config.min_layer_m - 1e-9));
  sizes.cells = directions * static_cast<std::uint64_t>(sizes.layers);
  sizes.uniform_cells = directions * static_cast<std::uint64_t>(sizes.uniform_layers);
  sizes.cubic_cells = across * across * across;
  sizes.slice_cells = static_cast<std::uint64_t>(buckets.azimuths()) * static_cast<std::uint64_t>(sizes.layers);
  sizes.square_cells = across * across;
  return sizes;
}

std::string spherical_slice_picture(const SphericalGridConfig& config, double range_m) {
  const SphericalLayers layers(config.min_layer_m, config.bucket, range_m);
  const int azimuths = DirectionBuckets(config.bucket).azimuths(), quarter = azimuths / 4;
  const SphericalSizes sizes = spherical_sizes(config, range_m);
  PlanPicture picture(
      frame_around(Eigen::AlignedBox2d(Eigen::Vector2d(-range_m, -range_m), Eigen::Vector2d(range_m, range_m))),
      kSlicePixels,
      {fmt::format("A level slice to {:g} m: {} cells by direction, {} squares", range_m, sizes.slice_cells,
                   sizes.square_cells),
       "forward (m)", "starboard (m)"});
  for (int i = 0; i < layers.count(); ++i) {
    const double r = std::min(range_m, layers.outer(i));
    std::vector<Eigen::Vector2d> arc;
    for (int k = 0; k <= azimuths / 2; ++k) {
      const Angle a = config.bucket * (k - quarter);
      arc.emplace_back(r * cos(a), r * sin(a));
    }
    picture.polyline(arc, {kCells, kThin, false});
  }
  for (int k = 0; k <= azimuths / 2; ++k) {
    const Angle a = config.bucket * (k - quarter);
    const std::vector<Eigen::Vector2d> ray{Eigen::Vector2d::Zero(), range_m * Eigen::Vector2d(cos(a), sin(a))};
    picture.polyline(ray, {kCells, kThin, false});
  }
  for (double x = 0; x <= range_m; x += config.min_layer_m) {
    const double half = std::sqrt(range_m * range_m - x * x);
    picture.polyline(std::vector<Eigen::Vector2d>{{-x, -half}, {-x, half}}, {kSquares, kThin, false});
    for (const double side : {-1.0, 1.0}) {
      picture.polyline(std::vector<Eigen::Vector2d>{{0, side * x}, {-half, side * x}}, {kSquares, kThin, false});
    }
  }
  picture.vehicle(Eigen::Vector2d::Zero(), 0);
  picture.finish({{kCells, "spherical cells"}, {kSquares, fmt::format("squares of {:g} m", config.min_layer_m)}});
  return picture.png();
}

}  // namespace isobath
