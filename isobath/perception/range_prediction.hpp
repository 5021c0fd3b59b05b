// RangePredictor: the range that a sonar should report, and its standard deviation, from the depth map, the pose and
// the beam (Oskard 1990, I; ledger S1-04, S1-66).
//
// Each pixel is a column of solid ground from its stored depth downwards. The prediction is the smallest true distance
// from the apex to ground inside the exact cone (S1-65), over all columns of the beam's plan. Within a pixel the
// contact is where the cone meets it, not at its centre: a flat bottom at altitude A is predicted at A, and for a
// forward beam at A / sin(delta + a), without steps of a pixel.
//
// The standard deviation is half the difference of two searches: with all ground raised, and with all ground lowered,
// by its vertical uncertainty (depths, and attitude times distance). It therefore grows where the beam grazes: two
// metres above a flat bottom a level beam of 6 degrees expects its echo at 38 +- 4 m. It does not include the deviation
// of the measured range; the gate adds that (S1-04).
//
// Frames: W; depths positive down, m. Nothing allocates after the first prediction of the widest beam. One thread.
// Cost for a level beam of 6 degrees to 50 m, pixels of 0.5 m, on a 2.6 GHz core under load: 8 us over a bottom out of
// reach, 14 us over one within reach.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/map/depth/pixel_grid.hpp>
#include <isobath/perception/scan_conversion.hpp>
#include <isobath/sonar/beam_cone.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// Standard deviations: sigma^2 = (floor + share R)^2 + navigation^2 + (R attitude)^2 (S1-73). A predicted range
/// depends on the height of the beam over the ground, of variance vertical^2 + (R attitude)^2; the horizontal position
/// error does not enter.
struct RangeDeviation {
  double floor_m = 0.1;
  double share = 0.005;
  double navigation_m = 0.25;
  double vertical_m = 0.15;  ///< of the vehicle's depth relative to the map's depths
  Angle attitude = Angle::degrees(0.25);

  [[nodiscard]] double of_range(double range_m) const { return floor_m + share * range_m; }
  [[nodiscard]] double of_pose(double range_m, double navigation) const;
  [[nodiscard]] double total(double range_m, double navigation) const;
};

std::vector<Field> fields(RangeDeviation& config);

/// Depths of a window of pixels, row by row from the north-west; NaN where unknown.
struct DepthPatch {
  PixelWindow window;
  std::span<const float> depth_m;
};

struct RangePrediction {
  /// Infinite: no echo is expected. May be slightly beyond the maximum.
  double expected_m = std::numeric_limits<double>::infinity();
  double sigma_m = 0;
  double max_range_m = 0;

  /// Whether a reading, or the absence of an echo, agrees within n standard deviations.
  [[nodiscard]] bool agrees(const std::optional<double>& measured_m, double sigma_range_m, double n) const;
};

class RangePredictor {
 public:
  /// Predictions reach this factor beyond the maximum range: an echo just within the limit may be that of a bottom that
  /// is expected just beyond it.
  static constexpr double kBeyond = 1.1;

  RangePredictor(const RangeDeviation& deviation, const PixelGrid& grid) : deviation_(deviation), grid_(grid) {}

  /// The window of pixels that a prediction needs: the window of its DepthPatch.
  [[nodiscard]] PixelWindow window(const BeamCone& cone, double max_range_m) const;
  /// The pixels in this window that it reads, clipped to `patch`. Valid until the next call.
  std::span<const PixelSpan> pixels(const BeamCone& cone, double max_range_m, const PixelWindow& patch);
  /// Call pixels() with the same cone, range and window before.
  [[nodiscard]] RangePrediction predict_listed(const BeamCone& cone, double max_range_m, const DepthPatch& patch) const;

 private:
  RangeDeviation deviation_;
  PixelGrid grid_;
  std::vector<PixelSpan> spans_;
};

/// First echo of the water surface (depth 0), in closed form (S1-66).
RangePrediction predict_surface(const BeamCone& cone, double max_range_m, const RangeDeviation& deviation);

}  // namespace isobath
