// DenseMatcher: dense disparity of a rectified pair (stereo fragment 1990; ledger S8-01 S8-03 S8-04 S8-06 S8-08 S8-11).
//
// Candidates cost the bits of a centre-symmetric census of 9 x 7 pixels (Spangenberg et al. 2013, 31 bits) that differ,
// plus the difference of brightness up to a cap; in a colour pair each channel, times its weight. Costs are averaged
// over a window by running sums, so that its size costs no time, and smoothed along five directions (Hirschmueller
// 2008) in one pass from the top. The least sum wins. A parabola through three sums refines it.
//
// A pixel has no disparity, and its state says why, where its match lies outside of the right picture, where the window
// has too little contrast (turbid water, sand without texture), where a second disparity is about as good, where the
// right picture's own winner disagrees (occlusion), and in small islands (speckle). It is marked, not guessed.
//
// Disparity: x_left - x_right, pixels. Threads work on bands of rows; the bands do not depend on the number of threads,
// so the result has the same bits on any. A band begins with kWarmUp rows of the one above it, whose results are
// discarded. `plain` uses plain loops for the vectors: the same bits, some 20 times the time.
//
// Not thread-safe; keeps its buffers, so that a stream of pairs of one size allocates once. Cost: docs/stereo.md.
#pragma once

#include <isobath/stereo/optics/camera_image.hpp>
#include <isobath/stereo/stereo_config.hpp>
#include <memory>

namespace isobath {

enum class PixelState : std::uint8_t { kValid, kOutside, kUntextured, kAmbiguous, kOccluded, kSpeckle };
constexpr int kPixelStates = 6;
/// "valid", "outside of the right picture", ...
const char* name_of(PixelState state);

struct DisparityMap {
  int width = 0, height = 0;
  std::vector<float> disparity;   ///< pixels; NaN unless valid
  std::vector<float> confidence;  ///< 0..1: by how much the second-best disparity is worse, as a share of its cost
  std::vector<PixelState> state;

  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] float operator()(int column, int row) const { return disparity[index(column, row)]; }
  [[nodiscard]] double share_of(PixelState wanted) const;
};

class DenseMatcher {
 public:
  explicit DenseMatcher(const StereoConfig& config, bool plain = false);
  ~DenseMatcher();
  /// Pictures of the same size and number of channels (an assertion), at least 16 x 16 pixels.
  void match(const CameraImage& left, const CameraImage& right, DisparityMap& map);
  [[nodiscard]] DisparityMap match(const CameraImage& left, const CameraImage& right);

  static constexpr int kWarmUp = 24;  ///< rows

 private:
  struct Buffers;
  void match_bands(int first, int last, DisparityMap& map);
  void sweep_down(int y, int band, const std::uint8_t* means, bool keep, DisparityMap& map);
  void finish_row(int y, int band, DisparityMap& map) const;

  StereoConfig config_;
  bool plain_;
  std::unique_ptr<Buffers> buffers_;
};

/// Marks islands of fewer than `pixels` valid pixels, whose neighbours differ by up to one pixel, as speckle.
void remove_speckles(int pixels, DisparityMap& map);

}  // namespace isobath
