// BoundaryEchoes: what a sonar hears of the bottom and of the surface is told from what stands in the water, and where
// it cannot be told that is said (ledger S6-69; the limitation of Ganesan 2015, 1.2 and 4.2).
//
// Geometry. Over a level boundary at vertical distance h a beam whose axis looks down (for the surface: up) by t hears
// the boundary at range r from e = asin(h / r) - t off its axis. `labels` says which bins the beam can hear it in: from
// the range on at which the outer edge of its main lobe meets the boundary. Nearer bins are clear of both and are left
// as they are, whatever they hold; so nothing is taken for bottom on the last metres before an obstacle.
//
// Level. How loud a boundary is at an angle off the axis (beam pattern, grazing angle, ground) is learnt from the beams
// so far, all bearings together: it moves with e, not with range, so that pitch, a dive or a rising bottom take it
// along. It is the 1 - f quantile that was counted, but not above 1.5 times what a Rayleigh law (a rough boundary)
// through the quantiles q10 and q30 says, which echoes on up to half of the bearings do not move. A bin is held against
// the loudest level within `slope` nearer to the axis: the bottom may slope, altitude and attitude be off.
//
// Decision. Where that is above the threshold of open water, only what is louder is an echo of an obstacle. The same
// target is found less often there: of a fluctuating one (Swerling 1), p_D = f^(1 / (1 + s)), with s its signal to
// noise ratio, less by the square of the ratio of both thresholds. That p_D goes with the decision: a bin of the ring
// without an echo says little of free water, and nothing where p_D comes near f or the boundary is not known yet.
//
// A ring louder than `loudest` times that threshold stays an obstacle: in a basin its walls would be taken for it.
//
// Not promised: what fills more than half of all bearings at the same angle off the axis as the bottom, and is no
// louder than that, is taken for it until it comes nearer than the beam's edge. Turned rather than level (roll of a fan
// about its beams) the elevation is off by its cosine. Side lobes are not sorted out. One object a sonar; after the
// first ping nothing allocates.
#pragma once

#include <array>
#include <isobath/base/config.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/echo_histogram.hpp>
#include <isobath/sonar/ping.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// Where a sonar is between surface and bottom; what is empty is not known.
struct WaterColumn {
  Rotation R_WS;
  std::optional<double> above_bottom_m;   ///< height of S over the bottom below it
  std::optional<double> below_surface_m;  ///< depth of S
};

enum class BinLabel : std::uint8_t { kClear = 0, kMayBeSurface = 1, kMayBeBottom = 2, kMayBeEither = 3 };

/// From which range on one beam can hear surface and bottom, m; infinite: not at all, or not known. `half_height`: of
/// the beam, to the edge that is meant.
struct BoundaryReach {
  double surface_m, bottom_m;
  [[nodiscard]] BinLabel label(double range_m) const;
};
BoundaryReach boundary_reach(const WaterColumn& water, Angle azimuth, Angle half_height);

struct BoundaryConfig {
  bool tell_boundaries = true;
  Angle slope = Angle::degrees(4);
  double loudest = 2;          ///< times the threshold of open water
  int boundary_memory = 1000;  ///< 500 to 1000 beams are remembered
};
std::vector<Field> fields(BoundaryConfig& config);

class BoundaryEchoes {
 public:
  explicit BoundaryEchoes(const BoundaryConfig& config = {}) : config_(config) {}

  /// Of each ping, before `sort_out`. Bins before `first_bin` ring.
  void learn(const Ping& ping, const WaterColumn& water, int first_bin, double false_alarm);
  /// `thresholds`: of open water, a bin; empty where there are none (cfar). Takes the echoes that a boundary explains
  /// out of the decisions and dims the bins in which a target may be hidden.
  void sort_out(const Ping& ping, const WaterColumn& water, std::span<const float> thresholds,
                EchoDecisions& decisions);

 private:
  enum Side : std::uint8_t { kAbove, kBelow, kSides };  // bits of BinLabel
  struct Loudness {
    EchoHistogram seen;           ///< by degrees off the axis
    std::vector<int> samples;     ///< remembered, likewise
    std::vector<float> level;     ///< 1 - f quantile
    std::vector<float> expected;  ///< the loudest within the slope; negative: not known
    std::vector<float> angle;     ///< off the horizontal by bin, degrees; of the ping at hand
  };
  struct Beam {
    float tilt = 0;  ///< of the axis, down, degrees, rounded
    std::vector<float> threshold, p_detect;
    std::vector<std::uint64_t> dim;
    bool any = false;
  };
  void prepare(const Ping& ping, const WaterColumn& water);
  void renew(double false_alarm);
  [[nodiscard]] float quantile(const Loudness& side, int cell, double share) const;
  [[nodiscard]] Angle edge() const;  ///< of the main lobe, off the axis
  static bool may_be(BinLabel label, Side side);
  [[nodiscard]] std::optional<std::size_t> cell_of(Side side, int bin, float tilt) const;
  void expect(const RangeWindow& window, std::span<const float> thresholds, const EchoDecisions& decisions,
              const BoundaryReach& reach, float tilt);

  BoundaryConfig config_;
  std::optional<EchoLevels> levels_;
  std::vector<double> edges_;
  Angle height_;
  std::array<Loudness, kSides> sides_;
  Beam beam_;  ///< what is expected of a beam of this tilt; neighbouring beams share it
  std::vector<float> samples_;
  int beams_ = 0, due_ = 0, next_beam_ = 0;
};

}  // namespace isobath
