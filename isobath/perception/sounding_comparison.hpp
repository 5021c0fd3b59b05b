// SoundingComparison: what a depth map says where a sounding lies, for a check of the map by soundings that it does not
// hold yet (cross lines; ledger S1-47, S1-76).
//
// The map's depth is the mean over the pixels within the sounding's footprint, widened by the position uncertainty,
// each weighted by 1 + confidence. Charted land, and pixels known only as clear down to a depth, are skipped. The
// bottom's gradient is that of the plane through the measured pixels within 5 m.
//
// Frames: W of the map. One thread; allocates nothing once the widest footprint has been seen. About 1 us, and 2 us
// for a gradient.
#pragma once

#include <algorithm>
#include <cmath>
#include <Eigen/Core>
#include <functional>
#include <isobath/map/depth/depth_pixel.hpp>
#include <isobath/map/depth/pixel_grid.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// Within which a sounding agrees with a map: the floor or a share of the depth, whichever is larger, m.
inline double agreement_margin(double floor_m, double share, double depth_m) {
  return std::max(floor_m, share * std::abs(depth_m));
}

/// The map at a sounding.
struct MappedBottom {
  double depth_m = 0;
  double confidence = 0;  ///< 0 .. 20
  double minute = 0;      ///< mean of the pixels' last readings, since the map's epoch
  unsigned flags = 0;     ///< PixelFlag, of any of them
};

/// Why a map has no bottom at a sounding.
enum class NoBottom : std::uint8_t { kUnknown, kLand, kOnlyClear };

class SoundingComparison {
 public:
  /// Reads the pixels of a window of the map, row by row; unknown ones outside of it.
  using Read = std::function<void(const PixelWindow&, std::span<DepthPixel>)>;

  explicit SoundingComparison(const PixelGrid& grid) : grid_(grid) {}

  /// `radius_m`: of the footprint, widened. Pixels of a later minute than `latest` are skipped. Empty where the map has
  /// no bottom; why() then says the reason.
  std::optional<MappedBottom> at(const Read& read, const Eigen::Vector2d& north_east, double radius_m,
                                 std::uint32_t latest = DepthPixel::kLastMinute);
  [[nodiscard]] NoBottom why() const { return why_; }
  /// Gradient of depth (north, east). Empty if the measured pixels around are few, or on one line.
  std::optional<Eigen::Vector2d> gradient(const Read& read, const Eigen::Vector2d& north_east);

 private:
  PixelGrid grid_;
  NoBottom why_ = NoBottom::kUnknown;
  std::vector<DepthPixel> patch_;
};

}  // namespace isobath
