// InputConfig: what the readers of logs must be told, because the logs do not say it.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/io/survey_input.hpp>
#include <string>
#include <vector>

namespace isobath {

/// What logs do not say about the sonar and how it is mounted.
struct InputConfig {
  double sound_speed = 1500;  ///< m/s, for devices that leave it to the host
  Angle mount_heading;        ///< of the sonar's zero bearing in the body
  Angle mount_pitch;          ///< of a multibeam head that looks down, in logs that do not state it
  Angle mount_roll;           ///< likewise
  double mount_m[3] = {};     ///< likewise: forward, starboard, down of the point that navigation states
  bool clockwise = true;      ///< sense of a scanning head's bearings seen from above
  Angle beam_width;           ///< 0: what the format or the device type says
  Angle beam_height;          ///< 0: what the format or the device type says
  double range_m = 0;         ///< whole range, for logs that do not state it; 0: what the device is set to by default
  bool high_nibble_first = true;  ///< order of two 4-bit samples in a byte (Tritech)
  bool water_column = true;       ///< of multibeam logs is read, with that of the file beside them
  std::string navigation;         ///< CSV of poses beside the log; empty: none
  std::string set;                ///< of a folder that holds several: "clean", "noisy"; empty: the first by name
  int pass = 0;                   ///< of a set that holds several; 0: the first
  int most_bins = 1500;           ///< from the sonar to the end of its window; more are pooled; 0: never
  SurveyInput survey;             ///< what logs of survey boats leave open
};
std::vector<Field> fields(InputConfig& config);

}  // namespace isobath
