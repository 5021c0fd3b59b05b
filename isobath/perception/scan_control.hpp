// ScanControl: chooses the next sector of a steerable sonar: the one in which the spherical grid is least certain
// (Auran, Silven 1995, 2, 3.2 and 5; ledger S4-41). Water without echoes has little worth and is not favoured.
//
//   worth of a sector = sum of H(p) / (1 + looks) over the stored cells that its beams pass
//                       - turn_cost x the turn to its middle,
//   H(p) = -p ln p - (1 - p) ln(1 - p), nats.
// `looks` is the number of times that this azimuth was chosen: the n-th look gains about 1 / n of the first. Without
// it, an object whose outline stays uncertain because its echoes scatter would be chosen permanently. Locked cells are
// settled and count nothing. Sectors begin at each bucket of azimuth. The sector of the greatest worth is chosen; of
// equal ones, the first clockwise from the present direction. A sonar that sweeps less than a turn can reach only
// sectors within it. Cost: one pass over the stored cells. One thread.
#pragma once

#include <isobath/map/spherical/spherical_grid.hpp>
#include <vector>

namespace isobath {

struct ScanLimits {
  Angle sector = Angle::degrees(30);
  Angle height = Angle::degrees(10);  ///< height of the beams, centred on the horizontal
  double turn_cost = 0.1;             ///< nats per radian
};
/// Azimuths in G that the sonar can reach: `width` about `middle`.
struct ScanReach {
  Angle middle;
  Angle width = Angle::degrees(360);
};
struct ScanChoice {
  Angle azimuth;  ///< middle of the sector, in G
  double worth = 0;
};

double binary_entropy(double probability);
/// For each azimuth of the turned table in G, the sum of H over the cells that beams of this height pass.
std::vector<double> entropy_by_azimuth(const SphericalGrid& grid, Angle height);

class ScanControl {
 public:
  explicit ScanControl(const ScanLimits& limits = {}) : limits_(limits) {}

  /// Chooses the next sector within reach and counts it as looked at. `looking`: present azimuth of the sonar in G. If
  /// no sector is within reach, it is the one in the middle of the reach.
  ScanChoice next(const SphericalGrid& grid, Angle looking, const ScanReach& reach = {});

 private:
  ScanLimits limits_;
  std::vector<double> looks_;  ///< by azimuth of the unturned table
};

}  // namespace isobath
