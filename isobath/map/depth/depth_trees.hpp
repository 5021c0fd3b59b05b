// DepthTrees: the whole depth map of an operational area as three region quadtrees (Oskard 1990, III-A; ledger S1-13,
// S1-16, S1-17, S1-19, S1-36).
//
// prior: charted depths, never written during a mission. sensed: depths measured by sensors. state: confidence, flags
// and age of every pixel; charted water starts at its base value, uncharted water at 0. The depth of a pixel is the
// sensed one where the state says so (by the flag, not by the confidence: S1-E05), else the charted one.
//
// Copying copies page tables only (copy-on-write pages): a copy is an immutable version for readers in other threads.
// The area is a square of 2^levels pixels; outside it nothing is known and nothing is kept.
#pragma once

#include <isobath/map/depth/depth_tile.hpp>
#include <isobath/map/depth/region_quadtree.hpp>
#include <span>

namespace isobath {

class DepthTrees {
 public:
  /// Uncharted water of 2^levels pixels a side.
  explicit DepthTrees(int levels);
  /// Charted depths (depth words) and the matching states (state words).
  DepthTrees(RegionQuadtree prior, RegionQuadtree state);
  /// All three trees as read from disk; all of one size.
  DepthTrees(RegionQuadtree prior, RegionQuadtree sensed, RegionQuadtree state);

  [[nodiscard]] int levels() const { return prior_.levels(); }
  [[nodiscard]] PixelWindow extent() const { return {0, 0, 1 << levels(), 1 << levels()}; }
  [[nodiscard]] const RegionQuadtree& prior() const { return prior_; }
  [[nodiscard]] const RegionQuadtree& sensed() const { return sensed_; }
  [[nodiscard]] const RegionQuadtree& state() const { return state_; }

  [[nodiscard]] DepthPixel at(Pixel p) const;
  /// Fusion of the three (S1-19), row by row; outside the area nothing is known.
  void read(const PixelWindow& window, std::span<DepthPixel> out) const;
  /// Fills a tile and its blocks; no pixel is marked as changed.
  void read_tile(Pixel tile, DepthTile& out) const;
  /// Writes the changed pixels of a tile (S1-30, S1-35). Only the finest map writes here (S1-36). Returns the number of
  /// pixels that lay outside the area and were lost.
  int write_tile(Pixel tile, const DepthTile& from);

 private:
  RegionQuadtree prior_, sensed_, state_;
};

}  // namespace isobath
