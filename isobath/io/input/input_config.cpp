#include <isobath/io/input/input_config.hpp>

namespace isobath {

std::vector<Field> fields(InputConfig& c) {
  std::vector<Field> all{
      Field::real("sound_speed", &c.sound_speed, {1300, 1700}, "m/s",
                  "Speed of sound, for devices that leave it to the host."),
      Field::degrees("mount_heading_deg", &c.mount_heading, {-360, 360},
                     "Direction of the sonar's zero bearing in the body, clockwise from forward."),
      Field::degrees("mount_pitch_deg", &c.mount_pitch, {-90, 90},
                     "Pitch of a downward-looking multibeam head, for logs that do not state it (XTF)."),
      Field::degrees("mount_roll_deg", &c.mount_roll, {-180, 180},
                     "Roll of a downward-looking multibeam head, for logs that do not state it (XTF)."),
      Field::numbers(
          "mount_m", c.mount_m, 3, {-1000, 1000}, "m",
          "Position of a multibeam head forward, starboard and down of the navigation's reference point (XTF)."),
      Field::flag("clockwise", &c.clockwise, "Whether a scanning head's bearings grow clockwise, seen from above."),
      Field::degrees("beam_width_deg", &c.beam_width, {0, 360},
                     "Full width of a beam in azimuth; 0: as the format or the device states."),
      Field::degrees("beam_height_deg", &c.beam_height, {0, 360},
                     "Full height of a beam in elevation; 0: as the format or the device states."),
      Field::real("range_m", &c.range_m, {0, 10000}, "m",
                  "Full range of the sonar, for logs that do not state it; 0: the device's default."),
      Field::flag("high_nibble_first", &c.high_nibble_first,
                  "Whether the first of two 4-bit samples is in the high half of a byte (Tritech)."),
      Field::text(
          "navigation", &c.navigation,
          "CSV file of poses, or another log that holds poses, which replace the log's own fixes; empty: none."),
      Field::choice("track", &c.track, {{"gnss", LogTrack::kGnss}, {"dead-reckoning", LogTrack::kDeadReckoning}},
                    "Track of the vehicle where a log holds two: of its satellite receiver, or its dead reckoning."),
      Field::text("reference", &c.reference,
                  "CSV file of poses to compare those of the run with, which it does not use; empty: for dead "
                  "reckoning the log's own satellite track, if it has one."),
      Field::flag(
          "water_column", &c.water_column,
          "Reads the water column of multibeam logs, also from the file beside them that holds it (.kmwcd, .wcd)."),
      Field::text("set", &c.set, "Set to read in a folder that holds several; empty: the first by name."),
      Field::integer("pass", &c.pass, {0, 1e6}, "", "Pass to read in a set that holds several; 0: the first."),
      Field::integer(
          "max_bins", &c.max_bins, {0, 1e6}, "bins",
          "Maximum number of range bins from the sonar to the end of its window: finer bins are averaged, which also "
          "reduces speckle; 0: no limit.")
          .was("most_bins"),
      Field::text("topics", &c.topics,
                  "Topics of a ROS log to use, such as /sonar*,/odom; * matches any text, ? one character, commas "
                  "separate patterns; empty: of each kind the topic with the most messages."),
      Field::choice("axes", &c.axes, {{"by-name", LogAxes::kByName}, {"enu", LogAxes::kEnu}, {"ned", LogAxes::kNed}},
                    "Axes of poses in a ROS log: enu (east-north-up, body forward-port-up), ned (north-east-down, body "
                    "forward-starboard-down), or by-name: ned where the name of the frame ends in ned."),
      Field::flag("beam_major", &c.beam_major,
                  "Whether the samples of a beam stand together in a ROS sonar image; off: those of a range do."),
      Field::text("frame_geometry", &c.frame_geometry,
                  "geometry.json that says what rows and columns of the images in a ROS log are; empty: images are not "
                  "read."),
      Field::text("cameras", &c.cameras,
                  "pairs.toml that says which two image topics of a ROS log are a pair of cameras, and how these see; "
                  "empty: pairs are not read."),
      Field::real("pressure_unit_pa", &c.pressure_unit_pa, {1e-3, 1e6}, "Pa",
                  "Unit of the pressures in a ROS log, for drivers that do not publish pascals."),
      Field::real("surface_pressure_pa", &c.surface_pressure_pa, {0, 200000}, "Pa",
                  "Pressure at the surface, subtracted for a depth; 0: the log has gauge pressures."),
      Field::real("water_density", &c.water_density, {900, 1100}, "kg/m3",
                  "Density of the water, for depths from pressures."),
      Field::integer("mavlink_system", &c.mavlink_system, {0, 255}, "",
                     "System number of the vehicle in a MAVLink log; 0: the first that states its attitude or "
                     "position."),
  };
  for (Field& field : fields(c.survey)) all.push_back(std::move(field));
  return all;
}

}  // namespace isobath
