// FanSector: the part of the world that a fan ensonifies, and the geometry of its beams for look-ups by direction.
//
// Frame F is the sensor's, turned about its down axis so that the fan's middle lies ahead; a beam ends half way to the
// next, or where its width does. Internal to the fan mapper.
#pragma once

#include <cstdint>
#include <isobath/geometry/pose.hpp>
#include <isobath/map/voxel/voxel_blocks.hpp>
#include <isobath/perception/fan_kernel.hpp>
#include <isobath/sonar/ping.hpp>
#include <memory>
#include <vector>

namespace isobath {

/// A block of voxels that a ping can touch.
struct EnsonifiedBlock {
  VoxelIndex corner;
  float first[3];  ///< centre of its first voxel relative to the sensor, along W, m
  LogOdds16* evidence;
};

class FanSector {
 public:
  explicit FanSector(double voxel_m) : voxel_m_(voxel_m) {}

  /// As FanMapper::fault_of.
  static const char* fault_of(const Ping& ping, double voxel_m);
  [[nodiscard]] bool is_of(const Ping& ping) const { return ping.fan == fan_ && ping.window == window_; }
  /// Takes over the geometry of a ping, and sets that of the view, which then refers to this object. Throws Error if
  /// `fault_of` gives a reason.
  void update(const Ping& ping, FanView& view);

  [[nodiscard]] const RangeWindow& window() const { return window_; }
  [[nodiscard]] const Pose& X_SF() const { return X_SF_; }
  /// Sets the axes of the view and the surface above it, at this depth in W.
  void aim(const Pose& X_WF, double surface_m, FanView& view) const;
  /// The blocks that the fan can touch, in one order, without evidence.
  [[nodiscard]] std::vector<EnsonifiedBlock> blocks(const Pose& X_WF) const;

 private:
  void set_directions(const std::vector<double>& left, const std::vector<double>& right, double middle);

  double voxel_m_;
  std::shared_ptr<const BeamFan> fan_;
  RangeWindow window_;
  Pose X_SF_;
  double half_width_ = 0;               ///< of the fan with the outer beams' width, rad
  double sine_ = 0;                     ///< of half its height
  std::vector<std::int32_t> beams_at_;  ///< FanView::beams_at
};

}  // namespace isobath
