// DepthUpdate: applies one look of a sonar to a window of the depth map (ledger S1-02, S1-48 to S1-66, S1-73): evidence
// on pixels, whether the map already predicts the echo, the confidence rule, pixel by pixel.
//
// The outcome depends on the look and the window's contents alone, so that a look can be applied to two windows.
// Frames: W of the map. One thread. Throws nothing; allocates nothing once the largest look has been seen.
#pragma once

#include <functional>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/perception/depth_parts.hpp>
#include <isobath/perception/range_prediction.hpp>
#include <isobath/perception/reading_evidence.hpp>
#include <optional>
#include <vector>

namespace isobath {

inline constexpr double kTrackBreak = 100;  ///< m between fixes beyond which they do not form a track

/// An input of the map in one form, for the queue of a shift: a reading, a sounding or a part of the track.
struct DepthLook {
  enum class Kind : std::uint8_t { kRange, kSounding, kTrack };
  Kind kind = Kind::kRange;
  bool depth_sonar = false;  ///< kRange only
  bool in_water = false;     ///< kSounding only: of something in the water, not of the bottom
  std::uint32_t minute = 0;
  int count = 1;
  double sigma_m = 0;  ///< standard deviation of the vehicle's position
  double lot = 0.5;    ///< 0 .. 1: decides whether a look worth less than half a unit of confidence counts
  RangeReading reading;
  Pose X_WB;
  // A sounding: bottom at p seen along u. A track: from p to q.
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), u = Eigen::Vector3d::Zero();
  Eigen::Vector2d q = Eigen::Vector2d::Zero();
  double range_m = 0;
  double depth_sigma_m = 0;
  Angle half_angle;
};

/// Whether this depth comes from a chart or a depth sonar. A depth from forward beams alone is a bound: clear water
/// down to it, or an object that reaches at least up to it. An echo from there may be of a new object, so such a depth
/// does not predict it.
inline bool vouched(const DepthPixel& pixel) {
  return pixel.known() && (!pixel.has(kSensed) || pixel.has(kSeenByDepth));
}

struct UpdateOutcome {
  bool changed = false;                                      ///< a pixel changed in depth, confidence, flags or age
  bool useless = false;                                      ///< the look has no evidence on any map
  bool outside = false;                                      ///< the look is wholly outside this window
  bool weak = false;                                         ///< too uncertain to count
  bool explained = false;                                    ///< the map predicts the echo
  std::uint32_t affirmed = 0, conflicted = 0, replaced = 0;  ///< pixels
  std::uint32_t examined = 0;                                ///< pixels of the window that the look has evidence on
};

/// Weight of a depth with this standard deviation, relative to one whose sigma is a third of the margin within which
/// depths agree: the ratio of the log-odds that it agrees because it is right (S1-73). 0 .. 1.
double evidence_share(double sigma_m, double margin_m);

class DepthUpdate {
 public:
  using Listener = std::function<void(const PixelChange&)>;

  DepthUpdate(const DepthMapperParts& parts, const PixelGrid& grid);

  /// `listener` may be null or empty.
  UpdateOutcome apply(DepthWindow& window, const DepthLook& look, const Listener* listener);
  /// A window that contains all pixels that the look reads or writes: cheap to compute, wide rather than tight.
  [[nodiscard]] PixelWindow reach(const DepthLook& look) const;
  /// The cone of a reading; empty if the reading is unusable or too far from the map to have pixels.
  [[nodiscard]] std::optional<BeamCone> cone(const RangeReading& reading, const Pose& X_WB) const;
  /// Where a depth sounding lies, with the radius of its footprint, widened by the position uncertainty; empty for any
  /// other look.
  struct Bottom {
    Eigen::Vector3d p_W;
    double radius_m;
  };
  [[nodiscard]] std::optional<Bottom> bottom_of(const DepthLook& look) const;
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
