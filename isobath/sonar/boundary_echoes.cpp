#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/sonar/beam_cone.hpp>
#include <isobath/sonar/boundary_echoes.hpp>
#include <isobath/sonar/hidden_target.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kOuter = 1;           // edge of the main lobe off the axis, in beam heights: -14 dB for a line array
constexpr double kInner = 0.125;       // nearer to the axis the level depends on range, as any background does
constexpr int kBeamsLearnt = 16;       // beams of a multibeam ping to learn from: enough, at a fraction of the cost
constexpr int kFewest = 100;           // minimum number of samples within the slope for an expectation
constexpr int kFewestOfCell = 25;      // minimum number of samples in one degree
constexpr float kLouder = 1.1f;        // minimum ratio to the threshold of open water: less is chance
constexpr double kMinTelling = 2;      // minimum ratio of p_D over f for an informative decision
constexpr std::uint32_t kWeight = 64;  // weight of a sample, so that halving counts loses little
constexpr float kMixed = 1.5f;         // allowance over a Rayleigh law for different ranges and grounds at one angle
constexpr double kLow = 0.1, kMiddle = 0.3;

double rayleigh(double p) { return std::sqrt(-std::log1p(-p)); }

float degrees(double radians) { return static_cast<float>(radians * 180 / std::numbers::pi); }

Vector3d axis_of(const WaterColumn& water, Angle azimuth) {
  return water.R_WS * Vector3d(cos(azimuth), sin(azimuth), 0);
}

/// Tilt of the axis, down, degrees; rounded, so that the beams of a level fan share it.
float tilt_of(const WaterColumn& water, Angle azimuth) {
  constexpr float kSteps = 4;
  const double sine = std::clamp(axis_of(water, azimuth).z(), -1.0, 1.0);
  return std::round(kSteps * degrees(std::asin(sine))) / kSteps;
}

bool known(const WaterColumn& water) { return water.above_bottom_m || water.below_surface_m; }

}  // namespace

std::vector<Field> fields(BoundaryConfig& c) {
  return {Field::flag(
              "tell_boundaries", &c.tell_boundaries,
              "Whether echoes of bottom and surface are separated from obstacles, if depth and altitude are known."),
          Field::degrees(
              "slope_deg", &c.slope, {0, 30},
              "Tolerance of the angle at which a boundary is expected: its slope, errors of attitude and altitude."),
          Field::real("boundary_max_level", &c.max_level, {1.1, 100}, "1",
                      "Maximum level of bottom and surface, in thresholds of open water; louder rings stay obstacles.")
              .was("boundary_loudest"),
          Field::integer("boundary_memory", &c.boundary_memory, {200, 1'000'000}, "beams",
                         "Maximum number of beams from which the level of bottom and surface is learnt.")};
}

BinLabel BoundaryReach::label(double range_m) const {
  const int surface = range_m >= surface_m ? 1 : 0, bottom = range_m >= bottom_m ? 2 : 0;
  return static_cast<BinLabel>(surface + bottom);
}

BoundaryReach boundary_reach(const WaterColumn& water, Angle azimuth, Angle half_height) {
  const BeamCone beam(Vector3d::Zero(), axis_of(water, azimuth).normalized(), half_height);
  const auto reach = [&](const std::optional<double>& distance, double sign) {
    const auto range = distance && *distance > 0 ? beam.range_to_level(sign * *distance) : std::nullopt;
    return range.value_or(std::numeric_limits<double>::infinity());
  };
  return {reach(water.below_surface_m, -1), reach(water.above_bottom_m, 1)};
}

// Level of the boundaries ------------------------------------------------------------------------------------------

Angle BoundaryEchoes::edge() const { return std::clamp(height_ * kOuter, Angle::degrees(1), Angle::degrees(89)); }

bool BoundaryEchoes::may_be(BinLabel label, Side side) { return (static_cast<unsigned>(label) >> side & 1U) != 0; }

void BoundaryEchoes::prepare(const Ping& ping, const WaterColumn& water) {
  const EchoLevels levels(ping.intensity.type(), ping.full_scale);
  if (!levels_ || *levels_ != levels || height_ != ping.fan->height) {
    levels_ = levels;
    edges_ = levels.edges();
    height_ = ping.fan->height;
    const int cells = static_cast<int>(std::ceil(edge().degrees())) + 1;
    for (Loudness& side : sides_) {
      side.seen = EchoHistogram(levels, cells);
      side.samples.assign(cells, 0);
      side.level.assign(cells, 0);
      side.expected.assign(cells, -1);
    }
    beams_ = due_ = next_beam_ = 0;
  }
  const int bins = ping.window.bins;
  samples_.resize(bins);
  for (const Side s : {kAbove, kBelow}) {
    const double distance = (s == kAbove ? water.below_surface_m : water.above_bottom_m).value_or(0);
    sides_[s].angle.resize(bins);
    for (int k = 0; k < bins; ++k) {
      sides_[s].angle[k] = degrees(std::asin(std::clamp(distance / ping.window.centre(k), 0.0, 1.0)));
    }
  }
}

/// Index of the degree off the axis at which a beam of this tilt receives a boundary; empty near the axis.
std::optional<std::size_t> BoundaryEchoes::cell_of(Side s, int bin, float tilt) const {
  const Loudness& side = sides_[s];
  const float off = std::abs(side.angle[bin] + (s == kAbove ? tilt : -tilt));
  if (off < static_cast<float>(kInner * height_.degrees())) return std::nullopt;
  return std::min(static_cast<std::size_t>(off), side.level.size() - 1);
}

void BoundaryEchoes::learn(const Ping& ping, const WaterColumn& water, int first_bin, double false_alarm) {
  if (!config_.tell_boundaries || !known(water)) return;
  prepare(ping, water);
  const int beams = ping.intensity.beams(), learnt = std::min(beams, kBeamsLearnt);
  for (int i = 0; i < learnt; ++i) {
    const int beam = (next_beam_ + i * beams / learnt) % beams;
    ping.intensity.copy_beam(beam, samples_.data());
    const float tilt = tilt_of(water, ping.fan->azimuth[beam]);
    const BoundaryReach reach = boundary_reach(water, ping.fan->azimuth[beam], edge());
    for (int k = first_bin; k < ping.window.bins; ++k) {
      const BinLabel label = reach.label(ping.window.centre(k));
      for (const Side s : {kAbove, kBelow}) {
        const auto cell = may_be(label, s) ? cell_of(s, k, tilt) : std::nullopt;
        if (!cell) continue;
        sides_[s].seen.add(static_cast<int>(*cell), samples_[k], kWeight);
        ++sides_[s].samples[*cell];
      }
    }
  }
  next_beam_ = (next_beam_ + 1) % beams;
  beams_ += learnt;
  if (beams_ < due_) return;
  if (beams_ >= config_.boundary_memory) {
    for (Loudness& side : sides_) {
      side.seen.halve();
      for (int& n : side.samples) n /= 2;
    }
    beams_ /= 2;
  }
  due_ = beams_ + std::clamp(beams_ / 8, 8, 64);
  renew(false_alarm);
}

float BoundaryEchoes::quantile(const Loudness& side, int cell, double share) const {
  const std::uint32_t* row = side.seen.row(cell);
  double total = 0;
  for (int i = 0; i < levels_->count(); ++i) total += row[i];
  double below = 0;
  for (int i = 0; i < levels_->count(); ++i) {
    if (below + row[i] > share * total) {
      return static_cast<float>(std::lerp(edges_[i], edges_[i + 1], (share * total - below) / row[i]));
    }
    below += row[i];
  }
  return static_cast<float>(edges_.back());
}

void BoundaryEchoes::renew(double false_alarm) {
  const double stretch = (rayleigh(1 - false_alarm) - rayleigh(kMiddle)) / (rayleigh(kMiddle) - rayleigh(kLow));
  const int slope = static_cast<int>(std::ceil(config_.slope.degrees()));
  for (Loudness& side : sides_) {
    const int cells = static_cast<int>(side.level.size());
    for (int c = 0; c < cells; ++c) {
      if (side.samples[c] < kFewestOfCell) continue;
      const float low = quantile(side, c, kLow), middle = quantile(side, c, kMiddle);
      const float rayleigh_law = middle + static_cast<float>(stretch) * (middle - low);
      side.level[c] = std::min(kMixed * rayleigh_law, quantile(side, c, 1 - false_alarm));
    }
    for (int c = 0; c < cells; ++c) {
      int samples = 0;
      float loudest = 0;
      for (int near = std::max(0, c - slope); near <= c; ++near) {
        samples += side.samples[near];
        if (side.samples[near] >= kFewestOfCell) loudest = std::max(loudest, side.level[near]);
      }
      side.expected[c] = samples >= kFewest ? loudest : -1;
    }
  }
}

// Decisions ----------------------------------------------------------------------------------------------------------

void BoundaryEchoes::expect(const RangeWindow& window, std::span<const float> thresholds,
                            const EchoDecisions& decisions, const BoundaryReach& reach, float tilt) {
  beam_.tilt = tilt;
  beam_.any = false;
  beam_.threshold.resize(window.bins);
  beam_.p_detect.resize(window.bins);
  beam_.dim.assign(decisions.words(), 0);
  for (int k = 0; k < window.bins; ++k) {
    const BinLabel label = reach.label(window.centre(k));
    if (label == BinLabel::kClear || !decisions.usable(k)) continue;
    float loudest = 0;
    bool learnt = true;
    for (const Side s : {kAbove, kBelow}) {
      const auto cell = may_be(label, s) ? cell_of(s, k, tilt) : std::nullopt;
      if (!cell) continue;
      const float expected = sides_[s].expected[*cell];
      learnt = learnt && expected >= 0;
      loudest = std::max(loudest, expected);
    }
    const float open = thresholds.empty() ? loudest : thresholds[k];
    if (learnt && !(loudest > kLouder * open) && !(thresholds.empty() && loudest > 0)) continue;
    if (loudest > static_cast<float>(config_.max_level) * open) continue;  // may be walls all round
    const double f = decisions.false_alarm;
    const double ratio = static_cast<double>(loudest / open);  // ratio of amplitudes
    const double p = learnt ? hidden_p_detect(ratio * ratio, static_cast<double>(decisions.p_detect[k]), f) : 0;
    beam_.threshold[k] = loudest;
    beam_.p_detect[k] = p > kMinTelling * f ? static_cast<float>(p) : 0;
    beam_.dim[k / 64] |= std::uint64_t{1} << (k % 64);
    beam_.any = true;
  }
}

void BoundaryEchoes::sort_out(const Ping& ping, const WaterColumn& water, std::span<const float> thresholds,
                              EchoDecisions& decisions) {
  if (!config_.tell_boundaries || !known(water)) return;
  for (int b = 0; b < decisions.beams(); ++b) {
    const float tilt = tilt_of(water, ping.fan->azimuth[b]);
    if (b == 0 || tilt != beam_.tilt) {
      expect(ping.window, thresholds, decisions, boundary_reach(water, ping.fan->azimuth[b], edge()), tilt);
    }
    if (!beam_.any) continue;
    decisions.set_dim(b, beam_.dim.data(), beam_.p_detect.data());
    std::uint64_t* hits = decisions.hits(b);
    for (int w = 0; w < decisions.words(); ++w) {
      for (std::uint64_t left = hits[w] & beam_.dim[w]; left != 0; left &= left - 1) {
        const int k = 64 * w + std::countr_zero(left);
        const bool louder = ping.intensity(b, k) >= beam_.threshold[k];
        if (!louder || !(beam_.p_detect[k] > 0)) hits[w] &= ~(left & -left);
      }
    }
  }
}

}  // namespace isobath
