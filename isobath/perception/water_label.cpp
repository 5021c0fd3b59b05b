#include <algorithm>
#include <cmath>
#include <isobath/perception/water_label.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBoundary_m = 1;     // an object nearer to bottom or surface may be part of it
constexpr int kFewest = 2;            // minimum number of voxels of a standing object
constexpr double kMostlyKnown = 0.5;  // share of the water over a bottom, or under a surface, that must be measured

bool is_over(const Polygon& convex, const Vector2d& p, double by_m) {
  return (nearest_point(convex, p) - p).norm() <= by_m;
}

/// Counts over the columns of voxels within an outline.
struct Columns {
  int standing = 0, at_bottom = 0, at_surface = 0;  ///< occupied voxels
  int between = 0, measured = 0;                    ///< voxels between the boundaries; those of them measured as water
};

Columns columns_of(const Polygon& outline_W, double surface, double bottom, const OccupancySnapshot& space) {
  const double voxel = space.voxel_m(), half = 0.5 * voxel;
  const double margin = std::max(kBoundary_m, 2 * voxel);
  Vector2d least = outline_W.front(), most = least;
  for (const Vector2d& p : outline_W) {
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
  const Eigen::Array2i first = (least.array() / voxel).floor().cast<int>(),
                       last = (most.array() / voxel).floor().cast<int>();
  Columns found;
  for (int x = std::max(first.x(), space.least().x());
       x <= std::min(last.x(), space.least().x() + space.size().x() - 1); ++x) {
    for (int y = std::max(first.y(), space.least().y());
         y <= std::min(last.y(), space.least().y() + space.size().y() - 1); ++y) {
      if (!is_over(outline_W, {x * voxel + half, y * voxel + half}, half)) continue;
      double depth = space.least().z() * voxel + half;
      for (const SpaceCell cell : space.column(x, y)) {
        const bool occupied = cell == SpaceCell::kOccupied;
        if (depth > bottom - margin) {
          found.at_bottom += occupied ? 1 : 0;
        } else if (depth < surface + margin) {
          found.at_surface += occupied ? 1 : 0;
        } else {
          ++found.between;
          found.standing += occupied ? 1 : 0;
          found.measured += cell == SpaceCell::kMeasured ? 1 : 0;
        }
        depth += voxel;
      }
    }
  }
  return found;
}

}  // namespace

WaterLabel label_by_reach(const Obstacle& obstacle, const HeardFrom& from) {
  if (!from.water.above_bottom_m || !from.water.below_surface_m) return WaterLabel::kUnknown;
  const Pose X_WL = level(from.X_WB);
  const Vector3d p_W = X_WL * Vector3d(obstacle.centre.x(), obstacle.centre.y(), 0);
  const Vector3d p_S = (from.X_WB * from.X_BS).inverse() * p_W;
  const double range = p_S.head<2>().norm();
  const BoundaryReach reach =
      boundary_reach(from.water, Angle::radians(std::atan2(p_S.y(), p_S.x())),
                     std::clamp(from.height, Angle::degrees(1), Angle::degrees(89)));  // to the edge of its main lobe
  return reach.label(range) == BinLabel::kClear ? WaterLabel::kStanding : WaterLabel::kUnknown;
}

WaterLabel label_by_heights(const Obstacle& obstacle, const HeardFrom& from, const OccupancySnapshot& space) {
  if (obstacle.outline.empty()) return WaterLabel::kUnknown;
  const Pose X_WL = level(from.X_WB);
  Polygon outline_W;
  for (const Vector2d& p : obstacle.outline) outline_W.push_back((X_WL * Vector3d(p.x(), p.y(), 0)).head<2>());
  const double depth = (from.X_WB * from.X_BS).translation.z();
  const double surface = from.water.below_surface_m ? depth - *from.water.below_surface_m : depth;
  const auto altitude = from.water.above_bottom_m;
  const Columns found = columns_of(outline_W, surface, depth + altitude.value_or(2 * kBoundary_m), space);
  if (found.standing >= kFewest) return WaterLabel::kStanding;
  if (!altitude || found.measured < kMostlyKnown * found.between) return WaterLabel::kUnknown;
  if (found.at_bottom >= kFewest && found.at_surface == 0) return WaterLabel::kBottom;
  if (found.at_surface >= kFewest && found.at_bottom == 0) return WaterLabel::kSurface;
  return WaterLabel::kUnknown;
}

void label_obstacles(std::vector<Obstacle>& obstacles, const HeardFrom& from, const OccupancySnapshot* space) {
  for (Obstacle& o : obstacles) {
    o.label = label_by_reach(o, from);
    if (o.label == WaterLabel::kUnknown && space) o.label = label_by_heights(o, from, *space);
  }
}

}  // namespace isobath
