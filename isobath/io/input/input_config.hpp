// InputConfig: settings of the log readers, for what logs do not state.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/io/input/survey_input.hpp>
#include <string>
#include <vector>

namespace isobath {

/// The track of the vehicle, in logs that hold two.
enum class LogTrack : std::uint8_t { kGnss, kDeadReckoning };

/// What logs do not state about the sonar and its mounting.
struct InputConfig {
  double sound_speed = 1500;      ///< m/s, for devices that leave the speed of sound to the host
  Angle mount_heading;            ///< direction of the sonar's zero bearing in the body
  Angle mount_pitch;              ///< pitch of a downward-looking multibeam head, for logs that do not state it
  Angle mount_roll;               ///< its roll, likewise
  double mount_m[3] = {};         ///< likewise: forward, starboard, down of the navigation's reference point
  bool clockwise = true;          ///< whether a scanning head's bearings grow clockwise seen from above
  Angle beam_width;               ///< 0: as the format or the device type states
  Angle beam_height;              ///< 0: as the format or the device type states
  double range_m = 0;             ///< full range, for logs that do not state it; 0: the device's default
  bool high_nibble_first = true;  ///< order of two 4-bit samples in a byte (Tritech)
  bool water_column = true;       ///< reads the water column of multibeam logs, and of the file beside them
  std::string navigation;         ///< CSV file of poses for the log; empty: none
  LogTrack track = LogTrack::kGnss;
  std::string reference;  ///< CSV file of poses to compare the log's with; empty: the log's other track, if any
  std::string set;        ///< set in a folder that holds several ("clean", "noisy"); empty: first by name
  int pass = 0;           ///< pass in a set that holds several; 0: the first
  int max_bins = 1500;    ///< from the sonar to the end of its window; finer bins are pooled; 0: never
  SurveyInput survey;     ///< what logs of survey boats do not state
};
std::vector<Field> fields(InputConfig& config);

}  // namespace isobath
