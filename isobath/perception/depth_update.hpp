// DepthUpdate: what one look of a sonar does to a window of the depth map (ledger S1-02, S1-48 to S1-66, S1-73):
// evidence on pixels, whether the map explains the echo already, the rule, pixel by pixel.
//
// The outcome is a function of the look and of the window's contents alone, so that a look may be given to two windows.
// Frames: W of the map. One thread. Throws nothing; allocates nothing once the largest look has been seen.
#pragma once

#include <functional>
#include <isobath/map/depth_map.hpp>
#include <isobath/perception/depth_parts.hpp>
#include <isobath/perception/range_prediction.hpp>
#include <isobath/perception/reading_evidence.hpp>
#include <optional>
#include <vector>

namespace isobath {

inline constexpr double kTrackBreak = 100;  ///< m between fixes that are no track any more

/// Everything that speaks to the map, in one form: what waits for a shift.
struct DepthLook {
  enum class Kind : std::uint8_t { kRange, kSounding, kTrack };
  Kind kind = Kind::kRange;
  bool depth_sonar = false;  ///< of kRange
  std::uint32_t minute = 0;
  int count = 1;
  double sigma_m = 0;  ///< of the place of the vehicle
  double lot = 0.5;    ///< 0 .. 1: whether it counts, where it is worth less than half a unit of confidence
  RangeReading reading;
  Pose X_WB;
  // A sounding: bottom at p seen along u. A track: from p to q.
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), u = Eigen::Vector3d::Zero();
  Eigen::Vector2d q = Eigen::Vector2d::Zero();
  double range_m = 0;
  double depth_sigma_m = 0;
  Angle half_angle;
};

/// Whether a chart or a depth sonar stands for this depth. Where only forward beams have spoken it is a bound: clear
/// water down to it, or something that reaches up to it at least; an echo from there may be of something new, and is
/// not explained by it.
inline bool vouched(const DepthPixel& pixel) {
  return pixel.known() && (!pixel.has(kSensed) || pixel.has(kSeenByDepth));
}

struct UpdateOutcome {
  bool changed = false;                                      ///< any pixel, in depth, confidence, flags or age
  bool useless = false;                                      ///< it said nothing of any map
  bool outside = false;                                      ///< it lay wholly outside this window
  bool weak = false;                                         ///< too unsure to count
  bool explained = false;                                    ///< by the map
  std::uint32_t affirmed = 0, conflicted = 0, replaced = 0;  ///< pixels
};

/// What a depth with this standard deviation is worth, as a share of one whose sigma is a third of the margin within
/// which depths agree: the ratio of the log-odds that it agrees because it is right (S1-73). 0 .. 1.
double evidence_share(double sigma_m, double margin_m);

class DepthUpdate {
 public:
  using Listener = std::function<void(const PixelChange&)>;

  DepthUpdate(const DepthMapperParts& parts, const PixelGrid& grid);

  /// `listener` may be null or empty.
  UpdateOutcome apply(DepthWindow& window, const DepthLook& look, const Listener* listener);
  /// Pixels beyond which the look neither asks nor says anything: wide, cheap, never too narrow.
  [[nodiscard]] PixelWindow reach(const DepthLook& look) const;
  /// The cone of a reading of use, near enough to the map to have pixels.
  [[nodiscard]] std::optional<BeamCone> cone(const RangeReading& reading, const Pose& X_WB) const;
  [[nodiscard]] bool has_pixels(const Eigen::Vector2d& north_east) const;
  [[nodiscard]] bool is_depth_sonar(const BeamCone& cone) const { return cone.axis().z() >= cos_depth_within_; }
  [[nodiscard]] bool is_echo(const RangeReading& reading, bool depth_sonar) const {
    return reading.range_m && *reading.range_m < evidence_.max_range_m(reading, depth_sonar);
  }

 private:
  UpdateOutcome apply_range(DepthWindow& window, const DepthLook& look, const Listener* listener);
  UpdateOutcome apply_sounding(DepthWindow& window, const DepthLook& look, const Listener* listener);
  UpdateOutcome apply_track(DepthWindow& window, const DepthLook& look, const Listener* listener);
  UpdateOutcome apply_evidence(DepthWindow& window, const Evidence& found, const DepthLook& look, PixelFlag flag,
                               const Listener* listener);
  std::optional<RangePrediction> predict(const DepthWindow& window, const BeamCone& cone, double max_range_m);
  [[nodiscard]] int step_of(const Evidence& found, double lot) const;

  DepthMapperConfig config_;
  DepthRules rules_;
  PixelGrid grid_;
  double cos_depth_within_;
  ReadingEvidence evidence_;
  RangeDeviation deviation_;
  RangePredictor predictor_;
  std::vector<float> patch_;
  std::vector<PixelSpan> spans_;
};

}  // namespace isobath
