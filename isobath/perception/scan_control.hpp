// ScanControl: where a sonar that can be told how to scan should look next: where the spherical grid is least sure
// (Auran, Silven 1995, 2, 3.2 and 5; ledger S4-41). Water that nothing echoed in is dull and gets no more than its
// turn.
//
//   worth of a sector = sum of H(p) / (1 + looks) over the stored cells that its beams pass
//                       - turn_cost x the turn to its middle,
//   H(p) = -p ln p - (1 - p) ln(1 - p), nats.
// `looks` are the times that this azimuth was chosen: of n looks each brings about 1 / n of what the first did, and a
// thing whose outline never gets sure, because its echoes scatter, would be looked at for ever without. Locked cells
// are settled and count nothing. Sectors begin at each bucket of azimuth; the worthiest is chosen, of equals the first
// clockwise from where the sonar looks. Cost: stored cells once each. One thread.
#pragma once

#include <isobath/map/spherical_grid.hpp>
#include <vector>

namespace isobath {

struct ScanLimits {
  Angle sector = Angle::degrees(30);
  Angle height = Angle::degrees(10);  ///< of the beams, about the level
  double turn_cost = 0.1;             ///< nats a radian
};
struct ScanChoice {
  Angle azimuth;  ///< of the sector's middle, in G
  double worth = 0;
};

double binary_entropy(double probability);
/// Sums of H over the cells of each azimuth that beams of this height pass, in G as the table is turned.
std::vector<double> entropy_by_azimuth(const SphericalGrid& grid, Angle height);

class ScanControl {
 public:
  explicit ScanControl(const ScanLimits& limits = {}) : limits_(limits) {}

  /// Counts as looked at, by then. `looking` is the azimuth in G of what the sonar looks at now.
  ScanChoice next(const SphericalGrid& grid, Angle looking);

 private:
  ScanLimits limits_;
  std::vector<double> looks_;  ///< by azimuth of the table as it was at the start
};

}  // namespace isobath
