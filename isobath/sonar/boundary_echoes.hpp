// BoundaryEchoes: separates echoes of the bottom and of the surface from echoes of obstacles, and marks bins in which
// the two cannot be separated (ledger S6-69; the limitation of Ganesan 2015, 1.2 and 4.2).
//
// Geometry. A level boundary is at vertical distance h. A beam whose axis points down (for the surface: up) by t
// receives its echo at range r from e = asin(h / r) - t off the axis. `label` gives the bins in which the beam can
// receive it: from the range at which the outer edge of its main lobe meets the boundary. Nearer bins are clear of both
// boundaries and stay unchanged. So on the last metres before an obstacle nothing is taken for bottom.
//
// Level. The level of a boundary at an angle off the axis (beam pattern, grazing angle, ground) is learnt from the
// beams so far, over all bearings. It depends on e, not on range, so it follows pitch, a dive or a rising bottom. It is
// the counted 1 - f quantile, but at most 1.5 times that of a Rayleigh law (a rough boundary) through the quantiles q10
// and q30, which echoes on up to half of the bearings do not affect. A bin is compared with the greatest level within
// `slope` nearer to the axis, since the bottom may slope, and altitude and attitude may have errors.
//
// Decision. Where this level is above the threshold of open water, only a louder echo is one of an obstacle. A target
// is detected less often there: for a fluctuating one (Swerling 1), p_D = f^(1 / (1 + s)), with its signal-to-noise
// ratio s divided by the squared ratio of both thresholds. This p_D goes with the decision. A bin of the ring without
// an echo then says little of free water, and nothing if p_D is near f or the level of the boundary is not known yet.
//
// A ring louder than `max_level` times the threshold of open water stays an obstacle, since in a basin it may be the
// walls.
//
// Not promised: an object that fills more than half of all bearings at the same angle off the axis as the bottom, and
// is no louder than the bottom, is taken for it until it is nearer than the beam's edge. If the sonar is not level
// (roll of a fan about its beams) the elevation has an error of its cosine. Side lobes are not sorted out. One object
// per sonar; after the first ping nothing allocates.
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

/// Position of a sonar between surface and bottom; empty: not known.
struct WaterColumn {
  Rotation R_WS;
  std::optional<double> above_bottom_m;   ///< height of S over the bottom below it
  std::optional<double> below_surface_m;  ///< depth of S
};

enum class BinLabel : std::uint8_t { kClear = 0, kMayBeSurface = 1, kMayBeBottom = 2, kMayBeEither = 3 };

/// The ranges from which on one beam can receive surface and bottom, m; infinite: never, or not known.
struct BoundaryReach {
  double surface_m, bottom_m;
  [[nodiscard]] BinLabel label(double range_m) const;
};
/// `half_height`: angle from the axis to the considered edge of the beam.
BoundaryReach boundary_reach(const WaterColumn& water, Angle azimuth, Angle half_height);

struct BoundaryConfig {
  bool tell_boundaries = true;
  Angle slope = Angle::degrees(4);
  double max_level = 2;        ///< maximum level of a boundary, in thresholds of open water
  int boundary_memory = 1000;  ///< 500 to 1000 beams are remembered
};
std::vector<Field> fields(BoundaryConfig& config);

class BoundaryEchoes {
 public:
  explicit BoundaryEchoes(const BoundaryConfig& config = {}) : config_(config) {}

  /// Call for each ping before `sort_out`. Bins before `first_bin` are in the ringing and ignored.
  void learn(const Ping& ping, const WaterColumn& water, int first_bin, double false_alarm);
  /// Removes echoes that a boundary explains from the decisions, and dims the bins in which it may hide a target.
  /// `thresholds`: those of open water by bin; empty for methods without them (CFAR).
  void sort_out(const Ping& ping, const WaterColumn& water, std::span<const float> thresholds,
                EchoDecisions& decisions);

 private:
  enum Side : std::uint8_t { kAbove, kBelow, kSides };  // bits of BinLabel
  struct Loudness {
    EchoHistogram seen;           ///< samples, by degrees off the axis
    std::vector<int> samples;     ///< remembered samples, by degrees off the axis
    std::vector<float> level;     ///< 1 - f quantile
    std::vector<float> expected;  ///< greatest level within the slope; negative: not known
    std::vector<float> angle;     ///< angle below or above the horizontal by bin of the present ping, degrees
  };
  struct Beam {
    float tilt = 0;  ///< tilt of the axis, down, degrees, rounded
    std::vector<float> threshold, p_detect;
    std::vector<std::uint64_t> dim;
    bool any = false;
  };
  void prepare(const Ping& ping, const WaterColumn& water);
  void renew(double false_alarm);
  [[nodiscard]] float quantile(const Loudness& side, int cell, double share) const;
  [[nodiscard]] Angle edge() const;  ///< edge of the main lobe, off the axis
  static bool may_be(BinLabel label, Side side);
  [[nodiscard]] std::optional<std::size_t> cell_of(Side side, int bin, float tilt) const;
  void expect(const RangeWindow& window, std::span<const float> thresholds, const EchoDecisions& decisions,
              const BoundaryReach& reach, float tilt);

  BoundaryConfig config_;
  std::optional<EchoLevels> levels_;
  std::vector<double> edges_;
  Angle height_;
  std::array<Loudness, kSides> sides_;
  Beam beam_;  ///< expectation for beams of this tilt; neighbouring beams share it
  std::vector<float> samples_;
  int beams_ = 0, due_ = 0, next_beam_ = 0;
};

}  // namespace isobath
