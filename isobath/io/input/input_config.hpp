// InputConfig: settings of the log readers, for what logs do not state.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/io/input/survey_input.hpp>
#include <string>
#include <vector>

namespace isobath {

/// The track of the vehicle, in logs that hold two.
enum class LogTrack : std::uint8_t { kGnss, kDeadReckoning };

/// Axes of the world and of the body in the log of a robot: east-north-up with forward-port-up (ROS, REP 103), or
/// north-east-down with forward-starboard-down. kByName: the latter where the name of the frame ends in "ned".
enum class LogAxes : std::uint8_t { kByName, kEnu, kNed };

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
  std::string navigation;         ///< CSV file of poses for the log, or another log with poses; empty: none
  LogTrack track = LogTrack::kGnss;
  std::string reference;  ///< CSV file of poses to compare the log's with; empty: the log's other track, if any
  std::string set;        ///< set in a folder that holds several ("clean", "noisy"); empty: first by name
  int pass = 0;           ///< pass in a set that holds several; 0: the first
  int max_bins = 1500;    ///< from the sonar to the end of its window; finer bins are pooled; 0: never
  std::string topics;     ///< topics of a ROS log to use, patterns with * and ?; empty: one of each kind
  LogAxes axes = LogAxes::kByName;
  bool beam_major = false;              ///< whether the samples of a beam stand together in a ROS sonar image
  std::string frame_geometry;           ///< geometry.json of the images in a ROS log; empty: images are not read
  std::string cameras;                  ///< pairs.toml of two image topics of a ROS log; empty: they are not read
  double pressure_unit_pa = 1;          ///< one unit of a ROS log's pressures, Pa
  double surface_pressure_pa = 101325;  ///< at the surface; 0: the log has gauge pressures
  double water_density = 1025;          ///< kg/m3, for depths from pressures
  int mavlink_system = 0;               ///< vehicle of a MAVLink log; 0: the first that states its attitude or position
  SurveyInput survey;                   ///< what logs of survey boats do not state
};
std::vector<Field> fields(InputConfig& config);

}  // namespace isobath
