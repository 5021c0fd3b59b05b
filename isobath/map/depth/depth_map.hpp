// DepthMap: the persistent depth map of the operational area (Oskard, Hong and Shaffer 1990; ledger S1-16 to S1-19,
// S1-27 to S1-40).
//
// Three quadtrees hold the whole operational area; a local window of array pixels lies around the vehicle and takes the
// readings. When the vehicle comes within a quarter of the window's width of its edge, a new window centred on the
// vehicle is made in the background, from a frozen copy of the old one: leaving tiles are written to the trees,
// arriving tiles are read from them. Meanwhile readings go into the old window, and the caller keeps them; when the new
// window is ready, the caller applies them to it and swaps. The result is, bit for bit, that of an instantaneous shift
// (S1-31, S1-32).
//
//   if (const auto target = map.wanted(position)) shift = map.begin_shift(*target);   // mapping thread, microseconds
//   shift->run();                                                                     // any thread, milliseconds
//   apply readings since then to shift->window(); map.finish_shift(*shift);           // mapping thread, microseconds
//
// Threads: one mapping thread owns the map. A running shift or commit has exclusive use of the trees; the mapping
// thread touches only the window. snapshot() is an immutable version for any thread. Positions are (north, east) of W.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/base/time.hpp>
#include <isobath/map/depth/depth_field.hpp>
#include <isobath/map/depth/depth_trees.hpp>
#include <memory>
#include <optional>
#include <span>

namespace isobath {

struct DepthMapConfig {
  double pixel_m = 0.5;
  int window_pixels = 512;  ///< a side; a multiple of 32, 2^n
  double area_m = 8192;  ///< minimum side of the operational area, centred on the origin of W; rounded up to 2^n pixels
};
std::vector<Field> fields(DepthMapConfig& config);

/// The square of an operational area: its pixel grid and its number of quadtree levels.
struct DepthArea {
  PixelGrid grid;
  int levels = 0;
};
/// Throws Error where the area is too large for this pixel size.
DepthArea area_of(const DepthMapConfig& config);

/// The map at one moment: immutable, for planners, pages and reports in any thread (S1-03).
class DepthSnapshot final : public DepthField {
 public:
  [[nodiscard]] PixelGrid grid() const override { return grid_; }
  [[nodiscard]] std::uint64_t version() const override { return version_; }
  [[nodiscard]] DepthPixel at(Pixel p) const;  ///< the same as DepthField::at, but faster
  void read(PixelWindow window, std::span<DepthPixel> out) const override;
  [[nodiscard]] bool may_be_shallower(const PixelWindow& window, double depth_m) const override;
  /// Minimum and maximum known depth of blocks of 8 x 8 pixels (S1-38); `blocks` in block coordinates (pixel / 8).
  void read_blocks(const PixelWindow& blocks, std::span<DepthBlock> out) const;
  [[nodiscard]] const DepthTrees& trees() const { return *trees_; }
  [[nodiscard]] const DepthWindow& window() const { return window_; }

 private:
  friend class DepthMap;
  std::shared_ptr<TilePool> pool_;  ///< outlives the window's tiles
  std::shared_ptr<const DepthTrees> trees_;
  DepthWindow window_;
  PixelGrid grid_;
  std::uint64_t version_ = 0;
};

class DepthMap {
 public:
  /// `trees`: fresh, with a prior, or from an earlier mission (S1-81). The first window is centred on `start`.
  DepthMap(const DepthMapConfig& config, const DepthArea& area, DepthTrees trees, const Eigen::Vector2d& start);
  ~DepthMap();

  [[nodiscard]] const PixelGrid& grid() const { return area_.grid; }
  [[nodiscard]] const DepthArea& area() const { return area_; }
  [[nodiscard]] DepthWindow& window() { return window_; }
  [[nodiscard]] const DepthWindow& window() const { return window_; }

  /// Has exclusive use of the trees until finish_shift.
  class Shift {
   public:
    /// Writes leaving tiles and reads arriving ones. Any thread, once.
    void run();
    /// The new window, valid after run().
    [[nodiscard]] DepthWindow& window() { return next_; }
    /// Extent of the new window, valid at any time in any thread.
    [[nodiscard]] PixelWindow extent() const { return extent_; }
    [[nodiscard]] int pixels_lost() const { return pixels_lost_; }

   private:
    friend class DepthMap;
    Shift(DepthMap& map, Pixel target);
    DepthMap& map_;
    DepthWindow frozen_, next_;
    PixelWindow extent_;
    std::shared_ptr<const DepthTrees> published_;
    int pixels_lost_ = 0;
  };
  /// The first tile of a window centred on this position, if the position is nearer to the edge than a quarter of the
  /// width (S1-29). The edge is that of the window made by `under_way`, if there is one. After a shift the vehicle is
  /// half a width away from the edge, so windows do not swing to and fro.
  [[nodiscard]] std::optional<Pixel> wanted(const Eigen::Vector2d& north_east, const Shift* under_way = nullptr) const;
  [[nodiscard]] std::unique_ptr<Shift> begin_shift(Pixel first_tile);
  void finish_shift(Shift& shift);

  /// Writes pixels anywhere in the area, in the window or in the trees; those outside the area are lost. Not while a
  /// shift runs.
  void write(std::span<const std::pair<Pixel, DepthPixel>> pixels);
  /// Writes everything in the window to the trees (S1-30), before the map is saved. Not while a shift runs.
  void flush();
  /// Up to date only after flush().
  [[nodiscard]] const DepthTrees& trees() const { return trees_; }
  [[nodiscard]] std::shared_ptr<const DepthSnapshot> snapshot() const;
  /// Pixels that lay outside the operational area and were lost.
  [[nodiscard]] std::uint64_t pixels_lost() const { return pixels_lost_; }

 private:
  [[nodiscard]] Pixel centred(const Eigen::Vector2d& north_east) const;

  std::shared_ptr<TilePool> pool_;  ///< outlives the tiles
  DepthArea area_;
  DepthTrees trees_;
  std::shared_ptr<const DepthTrees> published_;
  DepthWindow window_;
  bool shifting_ = false;
  std::uint64_t pixels_lost_ = 0;
  mutable std::uint64_t version_ = 0;
};

}  // namespace isobath
