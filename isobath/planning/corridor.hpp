// Corridor: the area that a vehicle sweeps along a path: which pixels it meets, and how deep the vehicle is over each
// (ledger S1-41; S1-82 for many vehicles).
//
// A leg dilated by the half-width is a stadium. It meets every pixel whose closed square comes within the half-width of
// the leg (supercover: no obstacle of one pixel slips through, corners included). The depth over a pixel is the
// vehicle's greatest depth while within the half-width of the pixel. All of this is in closed form: the part of a line
// from which a convex shape is within reach is an interval. Points are (north, east, depth) in W, m; a depth is that of
// the vehicle's lowest part. Cost: about 0.1 us a pixel.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/pixel_grid.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// A stretch of a leg, m from its start.
struct Stretch {
  double from = 0;
  double to = 0;
};

/// The part of the leg from a to b that is within `reach` of the segment from c to d (c = d: of a point).
std::optional<Stretch> within_reach_of_segment(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                               const Eigen::Vector2d& c, const Eigen::Vector2d& d, double reach);
/// The part of the leg that is within `reach` of the rectangle between the corners low and high.
std::optional<Stretch> within_reach_of_box(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                           const Eigen::Vector2d& low, const Eigen::Vector2d& high, double reach);

struct SweptPixel {
  Pixel pixel;
  std::int32_t leg = 0;  ///< the first leg that meets it, from 0
  double along_m = 0;    ///< from the start of the path to where the vehicle first meets it, horizontally
  double vehicle_z = 0;  ///< greatest depth over it, m
};

enum class CorridorRefusal : std::uint8_t { kNoPath, kNotFinite, kTooLarge };
const char* to_text(CorridorRefusal refusal);

/// Every pixel of the corridor once, by rows from the north-west. At least one point; a single one sweeps a disc.
Result<std::vector<SweptPixel>, CorridorRefusal> sweep(const PixelGrid& grid, std::span<const Eigen::Vector3d> path,
                                                       double half_width_m);

inline constexpr double kMaxSweptPixels = 0x1p24;  ///< of a path, estimated before it is swept

}  // namespace isobath
