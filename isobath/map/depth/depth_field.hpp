// DepthField: a depth map as planners see it: readable pixels of one version (ledger S1-03).
//
// A pixel outside the stored area is unknown, like any pixel that was never observed: unknown depth is not safe depth.
// A field does not change while it is read. Implementations are immutable snapshots, so any number of threads may read
// at once.
#pragma once

#include <cstdint>
#include <isobath/map/depth/depth_pixel.hpp>
#include <isobath/map/depth/pixel_grid.hpp>
#include <span>

namespace isobath {

class DepthField {
 public:
  DepthField() = default;
  DepthField(const DepthField&) = default;
  DepthField& operator=(const DepthField&) = default;
  virtual ~DepthField() = default;

  [[nodiscard]] virtual PixelGrid grid() const = 0;
  /// Row by row from the north-west; `out` holds width x height pixels.
  virtual void read(PixelWindow window, std::span<DepthPixel> out) const = 0;
  /// Grows with every change of the map of which this is a snapshot.
  [[nodiscard]] virtual std::uint64_t version() const = 0;

  /// False only if no pixel of the window has a known depth less than `depth_m`. Cheaper than reading them.
  [[nodiscard]] virtual bool may_be_shallower(const PixelWindow& /*window*/, double /*depth_m*/) const { return true; }

  [[nodiscard]] DepthPixel at(Pixel p) const {
    DepthPixel pixel;
    read({p.column, p.row, 1, 1}, std::span(&pixel, 1));
    return pixel;
  }
};

}  // namespace isobath
