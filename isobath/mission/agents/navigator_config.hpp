// Settings of the Navigator (navigator.hpp).
#pragma once

#include <isobath/base/config.hpp>
#include <vector>

namespace isobath {

struct NavigatorConfig {
  double drop_distance_m = 0;
  double slack_m = 0.5;
  double switch_m = 5;
  double shortcut_m = 3;
  int sure_scans = 3;
  double sure_within_m = 20;
  double decide_within_m = 30;
  double fence_clearance_m = 1;
  double chart_sigmas = 2;
  double jump_m = 1;  ///< as PoseBufferConfig::jump_m, by which the maps about the vehicle move
  double map_age_s = 20;
  double tight_m = 0.5;
  double tight_speed = 0.8;
  int emergency_factor = 4;
  double off_leg_m = 12;
};

std::vector<Field> fields(NavigatorConfig& config);

}  // namespace isobath
