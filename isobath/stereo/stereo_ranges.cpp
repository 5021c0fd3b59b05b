#include <algorithm>
#include <cmath>
#include <isobath/stereo/stereo_ranges.hpp>

namespace isobath {

using Eigen::Vector3d;

std::vector<StereoPoint> stereo_points(const DisparityMap& map, const PairGeometry& geometry, double sigma_disparity) {
  std::vector<StereoPoint> points;
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      const float d = map(column, row);
      if (!std::isfinite(d)) continue;
      const auto p = geometry.point(column, row, d);
      if (p) points.push_back({column, row, *p, geometry.sigma_z(p->z(), sigma_disparity)});
    }
  }
  return points;
}

namespace {

/// A cell of the picture, at least half of it valid: the point at the median distance.
struct StereoCell {
  Vector3d p;          ///< forward, starboard, down of the left camera
  double range_m = 0;  ///< its distance
  double sigma_m = 0;  ///< of the range, of one pixel
};

std::vector<StereoCell> cells_of(const DisparityMap& map, const PairGeometry& geometry, double sigma_disparity,
                                 int cell, double max_range_m) {
  const std::vector<StereoPoint> points = stereo_points(map, geometry, sigma_disparity);
  const int columns = (map.width + cell - 1) / cell, rows = (map.height + cell - 1) / cell;
  std::vector<std::vector<const StereoPoint*>> cells(static_cast<std::size_t>(columns) *
                                                     static_cast<std::size_t>(rows));
  for (const StereoPoint& point : points) {
    const int at = point.row / cell * columns + point.column / cell;
    cells[static_cast<std::size_t>(at)].push_back(&point);
  }
  std::vector<StereoCell> found;
  for (auto& inside : cells) {
    if (inside.empty() || static_cast<int>(inside.size()) * 2 < cell * cell) continue;
    const auto middle = inside.begin() + static_cast<std::ptrdiff_t>(inside.size() / 2);
    std::nth_element(inside.begin(), middle, inside.end(), [](const StereoPoint* a, const StereoPoint* b) {
      return std::pair(a->p_V.norm(), a->column + a->row) < std::pair(b->p_V.norm(), b->column + b->row);
    });
    const StereoPoint& point = **middle;
    const double range = point.p_V.norm();
    if (range > max_range_m) continue;
    found.push_back({{point.p_V.z(), point.p_V.x(), point.p_V.y()}, range, point.sigma_z_m * range / point.p_V.z()});
  }
  return found;
}

Angle width_of(int cell, const PairGeometry& geometry) {
  return Angle::radians(2 * std::atan(0.5 * cell / geometry.pair().focal_px));
}

}  // namespace

std::vector<StereoReading> stereo_readings(const DisparityMap& map, const PairGeometry& geometry,
                                           double sigma_disparity, const Pose& X_BV, Time time, int cell,
                                           double max_range_m) {
  std::vector<StereoReading> readings;
  for (const StereoCell& found : cells_of(map, geometry, sigma_disparity, cell, max_range_m)) {
    const Vector3d& p = found.p;
    const Angle heading = Angle::radians(std::atan2(p.y(), p.x()));
    const Angle pitch = Angle::radians(-std::atan2(p.z(), std::hypot(p.x(), p.y())));
    StereoReading one;
    one.reading.time = time;
    one.reading.range_m = found.range_m;
    one.reading.max_range_m = max_range_m;
    one.reading.width = width_of(cell, geometry);
    one.reading.X_BS = {X_BV.rotation * Rotation::from_heading_pitch_roll(heading, pitch, {}), X_BV.translation};
    one.sigma_m = found.sigma_m;
    readings.push_back(one);
  }
  return readings;
}

Swath stereo_swath(const DisparityMap& map, const PairGeometry& geometry, double sigma_disparity, const Pose& X_BV,
                   Time time, int cell, double max_range_m) {
  Swath swath;
  swath.time = time;
  swath.beam_width = width_of(cell, geometry);
  for (const StereoCell& found : cells_of(map, geometry, sigma_disparity, cell, max_range_m)) {
    if (swath.soundings.size() == Swath::kMaxSoundings) break;
    Sounding sounding;
    sounding.point = (X_BV * found.p).cast<float>();
    sounding.range_m = static_cast<float>(found.range_m);
    sounding.beam = static_cast<std::uint16_t>(swath.soundings.size());
    sounding.kind = Sounding::Kind::kWater;
    sounding.sigma_range_m = static_cast<float>(found.sigma_m);
    swath.soundings.push_back(sounding);
  }
  return swath;
}

}  // namespace isobath
