// PingVitals: what the samples of one ping say about the sonar itself, before anybody looks for echoes in them: whether
// it hears at all, hears anew, on both sides, and hears water.
//
//   frozen      a receiver has noise: two pings whose samples agree to the last bit are one ping told twice (digest)
//   saturated   the share of samples at full scale
//   deaf        the share of samples at zero; in water a receiver hears at least its own transmission
//   blind side  mean level of the beams to either side of the boresight
//   garbled     roughness: mean step between neighbouring range bins, of full scale. Sound fades and pulses last, so
//               that water is smooth or faint; bytes that are not sound make 1/3 (two uniform draws)
//
// Measured over the recordings that the tests read: roughness up to 0.11, samples at full scale up to 0.14, no two
// neighbouring pings alike. All shares are of the samples, levels of Ping::full_scale. Not promised: garbage as faint
// as the noise of the sonar cannot be told from it.
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

struct PingVitals {
  std::uint64_t digest = 0;
  double mean = 0;
  double full_scale = 0;
  double silent = 0;
  double roughness = 0;
  std::optional<double> port;  ///< mean level; empty: no beam looks there
  std::optional<double> starboard;
  Angle bearing;  ///< of the middle of the fan, in B
};

PingVitals vitals_of(const Ping& ping);

/// The nearest echo of each beam that stands out: decided as echo, behind the blind zone, and `contrast` deviations
/// (1.48 times the median one) above the median of its beam, so that of the false alarms that a map can afford next to
/// none is left. Of a fan they must be so many more that all its beams together would have no more false echoes than
/// one beam has, by Rayleigh's law: 6 become 7.6 for 512 beams. (They are told from 256 bins at most: of 200 the fan
/// has a twentieth of its beams' false echoes.) Positions in L of the ping's instant, x forward, y starboard, m, as if
/// at the height of the sonar. None where the sonar looks more than 45 degrees up or down: that is the bottom. Replaces
/// what `out` held.
void nearest_echoes(const Ping& ping, const EchoDecisions& decisions, const Rotation& R_LB, double contrast,
                    std::vector<Eigen::Vector2d>& out);

}  // namespace isobath
