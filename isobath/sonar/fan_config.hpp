// FanConfig: settings of the decisions on a fan (fan_detector.hpp) and of their background (fan_background.hpp).
#pragma once

#include <isobath/base/config.hpp>

namespace isobath {

struct FanBackgroundConfig {
  Angle window = Angle::degrees(24);
  double memory_s = 2;
  double max_ratio = 4;  ///< factor in power
};
std::vector<Field> fields(FanBackgroundConfig& config);

struct FanDetectorConfig {
  double false_alarm = 1e-4;
  double p_detect = 0.7;
  double blanking_m = 0.6;  ///< nearer cells are not usable
  double look_s = 0.5;
  int range_cells = 200;
  FanBackgroundConfig background;
};
std::vector<Field> fields(FanDetectorConfig& config);

}  // namespace isobath
