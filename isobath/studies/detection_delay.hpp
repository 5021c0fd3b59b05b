// DetectionDelay: what the base confidence of charted water costs and saves. A low one believes the first echoes, a
// high one waits: how late a wall appears in the map, and how many obstacles of nothing do (Oskard, Hong, Shaffer 1990,
// IV-A and VI; ledger S1-47, S1-50, S1-D01, S1-D08). The real mapper makes the numbers; `isobath delay` prints them.
//
// Delay: a level beam looks at a wall that is not in the chart, with a reading every kCycle_s. False obstacles: in
// empty water a share of the readings is a false echo at a random range. A pure function of its request.
#pragma once

#include <isobath/base/config.hpp>
#include <string>
#include <vector>

namespace isobath {

struct DelayRequest {
  static constexpr double kCycle_s = 0.6;  ///< between the readings of a sonar (S1-56)
  int from_base = 2, to_base = 15;         ///< confidence.base_prior; base_sensor is one above
  double wall_m = 20;
  double speed = 1.5;            ///< m/s, under way
  double spurious_share = 0.05;  ///< of the readings in empty water
  double nearest_false_m = 5, farthest_false_m = 45;
  int readings = 1000;  ///< in empty water, per seed
  int seeds = 4;
};

/// Mean and limits over the seeds, for 1000 readings.
struct FalseObstacles {
  double mean = 0, least = 0, most = 0;
};

struct DetectionDelay {
  int base = 0;
  int readings = 0;                   ///< until an unmapped wall stands in the map
  int readings_merged = 0;            ///< the same with the prefilter, a reading every kCycle_s
  int readings_merged_under_way = 0;  ///< the same, towards the wall
  FalseObstacles false_standing;      ///< of a vehicle that stands still
  FalseObstacles false_under_way;
};

DetectionDelay measure_delay(int base, const DelayRequest& request = {});
std::vector<DetectionDelay> measure_delays(const DelayRequest& request);

/// PNG: delay against false obstacles.
std::string delay_picture(const std::vector<DetectionDelay>& rows);

}  // namespace isobath
