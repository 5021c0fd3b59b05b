// Traversability: whether a vehicle can pass along a hypothesised path, and where it cannot (Oskard 1990, III-D; ledger
// S1-41).
//
// A pixel of the swept corridor is clear where depth - z_vehicle >= clearance. Unknown depth is not safe depth, nor is
// a depth of too little confidence: such pixels are counted separately, and as not clear. Three forms, all in [0, 1]:
//   fraction   share of the corridor's pixels that are clear
//   strict     1 if all are clear, else 0
//   weighted   the share where each pixel weighs (1 + c) / (1 + 20), c its confidence 0..20, an unknown one 1: a pixel
//              that is hardly known neither clears nor blocks much, an unknown pixel blocks in full
// Rocks and pipelines of the chart, given as discs and segments with a radius, block the pixels that they meet where
// their top is nearer to the vehicle than the clearance.
//
// A pixel that several legs meet counts once, for the deepest passage over it. Points are (north, east, depth) in W, m,
// of the vehicle's lowest part. Pure; the answer belongs to one version of the map. Cost: about 0.12 us a pixel.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/map/depth/depth_field.hpp>
#include <isobath/planning/corridor.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct PassageConfig {
  double half_width_m = 1;
  double clearance_m = 1;  ///< water required below the vehicle
  int min_confidence = 2;  ///< 0..20; the threshold of DepthRules: what no reading has confirmed has less
};

std::vector<Field> fields(PassageConfig& config);

/// A point (a = b) or a line of the chart with everything within `radius_m` of it, from the bottom up to `top_m`.
struct ChartObstacle {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  double radius_m = 0;
  double top_m = -std::numeric_limits<double>::infinity();  ///< depth of its top; by default above the surface
};

/// A place on the path that decides the result.
struct PassagePlace {
  Pixel pixel;
  std::int32_t leg = 0;  ///< from 0
  double along_m = 0;    ///< from the start of the path, horizontally
  double vehicle_z = 0;
  std::optional<double> depth_m;        ///< empty: unknown
  int confidence = 0;                   ///< of the depth, 0..20
  std::optional<std::size_t> obstacle;  ///< the charted one that blocks it
};

struct Traversability {
  double fraction = 0;
  double weighted = 0;
  std::size_t pixels = 0;
  std::size_t clear = 0;
  std::size_t unknown = 0;
  std::size_t unsure = 0;  ///< deep enough by a depth of too little confidence; the rest is too shallow or charted
  std::optional<PassagePlace> worst;           ///< minimum water below the vehicle, of the known pixels
  std::optional<PassagePlace> blocking;        ///< the first along the path that is not clear
  std::optional<PassagePlace> known_blocking;  ///< the first that is not clear by a known depth or an obstacle
  std::uint64_t map_version = 0;
  PixelGrid grid;
  PassageConfig passage;

  [[nodiscard]] double strict() const { return clear == pixels ? 1 : 0; }
  /// One line: "leg 2: 1.85 m of water at north 41.25 m, east -3.75 m; 3.00 m draught and 0.50 m clearance needed".
  [[nodiscard]] std::string reason() const;
  /// The same of one place that blocks, without the number of the leg.
  [[nodiscard]] std::string reason_of(const PassagePlace& place) const;
};

/// Along one leg or many; at least one point.
Result<Traversability, CorridorRefusal> traversability(const DepthField& map, std::span<const Eigen::Vector3d> path,
                                                       const PassageConfig& passage,
                                                       std::span<const ChartObstacle> chart = {});

}  // namespace isobath
