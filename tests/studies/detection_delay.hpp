// What the base confidence of charted water costs and saves: how late a wall appears in the map, and how many obstacles
// of nothing do (ledger S1-50, S1-D01, S1-D08). Measured on the real mapper, for docs/detection-delay.md.
#pragma once

#include <string>
#include <vector>

namespace isobath::test {

inline constexpr double kCycle_s = 0.6;  ///< between the readings of a sonar (S1-56)
inline constexpr double kSpuriousShare = 0.05;
inline constexpr int kWatched = 1000;  ///< readings in empty water, of each seed
inline constexpr int kSeeds = 4;

struct DetectionDelay {
  int base = 0;
  int readings = 0;                   ///< until an unmapped wall stands in the map
  int readings_merged = 0;            ///< the same with the prefilter, a reading every 0.6 s
  int readings_merged_under_way = 0;  ///< towards the wall at 1.5 m/s
  double false_standing = 0;          ///< obstacles of nothing for 1000 readings of a vehicle that stands still
  double false_under_way = 0;         ///< at 1.5 m/s
};

DetectionDelay measure_delay(int base);

/// A row of the table.
std::string row_of(const DetectionDelay& delay);
std::string delay_page(const std::vector<DetectionDelay>& rows);
/// PNG.
std::string delay_picture(const std::vector<DetectionDelay>& rows);

}  // namespace isobath::test
