// PingQuality: health of a sonar from the samples of one ping, before echo detection: whether the sonar receives sound,
// on both sides, and whether its samples are new and look like sound in water.
//
//   frozen      a receiver has noise: two pings with identical samples are one ping sent twice (digest)
//   saturated   the share of samples at full scale
//   deaf        the share of samples at zero; in water a receiver picks up at least its own transmission
//   blind side  mean level of the beams to either side of the boresight
//   garbled     roughness: mean step between neighbouring range bins, as a share of full scale. Sound fades and pulses
//               have a length, so water is smooth or faint; bytes that are not sound give 1/3 (two uniform draws)
//
// Measured over the recordings that the tests read: roughness up to 0.11, samples at full scale up to 0.14, no two
// successive pings alike. All shares are of the samples, levels are shares of Ping::full_scale. Not promised: garbage
// as faint as the noise of the sonar cannot be distinguished from it.
//
// Pure; allocates nothing. The ping must pass `check`.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/geometry/pose.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct PingQuality {
  std::uint64_t digest = 0;
  double mean = 0;
  double full_scale = 0;
  double silent = 0;
  double roughness = 0;
  std::optional<double> port;  ///< mean level; empty: no beam on this side
  std::optional<double> starboard;
  Angle bearing;  ///< middle of the fan, in B
};

PingQuality quality_of(const Ping& ping);

/// The bin of the nearest echo of a beam that stands out from the beam by `contrast`, as nearest_echoes() states.
std::optional<int> nearest_clear_echo(const Ping& ping, const EchoDecisions& decisions, int beam, double contrast);
/// The bin of the nearest echo of a beam that its decisions alone make sure: from it on the decisions for echoes come
/// so densely that false alarms explain it in one beam of a thousand (cumulative sum of the log-likelihood ratios,
/// Page 1954). It finds what does not stand out from a beam, such as walls and their multiples that fill most of it.
/// Costs a few operations for each decision for an echo.
std::optional<int> nearest_dense_echo(const EchoDecisions& decisions, int beam);
/// The nearer of the two; empty: there is neither.
std::optional<int> nearest_sure_echo(const Ping& ping, const EchoDecisions& decisions, int beam, double contrast);
/// The contrast at which all beams of a fan together have no more false echoes than one beam has at `contrast`.
double contrast_of_fan(double contrast, int beams);

/// The nearest clear echo of each beam: decided as an echo, beyond the blind zone, and `contrast` deviations (1.48
/// times the median one) above the median of its beam. This removes nearly all of the false alarms that a map
/// tolerates. For a fan the contrast is raised so that all its beams together have no more false echoes than one beam
/// has, by Rayleigh's law: 6 becomes 7.6 for 512 beams. (Median and deviation are estimated from at most 256 bins; from
/// 200, the fan has a twentieth of the false echoes of its beams taken singly.) Positions in L at the time of the ping,
/// x forward, y starboard, m, as if at the height of the sonar. Empty if the sonar points more than 45 degrees up or
/// down: that is the bottom. Replaces the content of `out`. `silent_m`: for each beam the range up to which it has no
/// sure echo, at the contrast of one beam; the end of the window if there is none; empty for a sonar that points up or
/// down.
void nearest_echoes(const Ping& ping, const EchoDecisions& decisions, const Rotation& R_LB, double contrast,
                    std::vector<Eigen::Vector2d>& out, std::vector<float>& silent_m);

}  // namespace isobath
