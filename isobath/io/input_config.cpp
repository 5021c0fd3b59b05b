#include <isobath/io/input_config.hpp>

namespace isobath {

std::vector<Field> fields(InputConfig& c) {
  std::vector<Field> all{
      Field::real("sound_speed", &c.sound_speed, {1300, 1700}, "m/s",
                  "Speed of sound, for devices that leave it to the host."),
      Field::degrees("mount_heading_deg", &c.mount_heading, {-360, 360},
                     "Direction of the sonar's zero bearing in the body, clockwise from forward."),
      Field::degrees("mount_pitch_deg", &c.mount_pitch, {-90, 90},
                     "Pitch of a multibeam head that looks down, where the log does not state it (XTF)."),
      Field::degrees("mount_roll_deg", &c.mount_roll, {-180, 180},
                     "Roll of a multibeam head that looks down, where the log does not state it (XTF)."),
      Field::numbers(
          "mount_m", c.mount_m, 3, {-1000, 1000}, "m",
          "Place of a multibeam head forward, starboard and down of the point that navigation states (XTF)."),
      Field::flag("clockwise", &c.clockwise, "Whether a scanning head's bearings grow clockwise, seen from above."),
      Field::degrees("beam_width_deg", &c.beam_width, {0, 360},
                     "Full width of a beam in azimuth; 0: what the format or the device says."),
      Field::degrees("beam_height_deg", &c.beam_height, {0, 360},
                     "Full height of a beam in elevation; 0: what the format or the device says."),
      Field::real("range_m", &c.range_m, {0, 10000}, "m",
                  "Whole range of logs that do not state it; 0: what the device is set to by default."),
      Field::flag("high_nibble_first", &c.high_nibble_first,
                  "Order of the two 4-bit samples in a byte from a Tritech head."),
      Field::text("navigation", &c.navigation, "CSV of poses beside the log; empty: none."),
      Field::flag(
          "water_column", &c.water_column,
          "Reads the water column of multibeam logs too, and the file beside them that holds it (.kmwcd, .wcd)."),
      Field::text("set", &c.set, "Which set of a folder that holds several; empty: the first by name."),
      Field::integer("pass", &c.pass, {0, 1e6}, "", "Which pass of a set that holds several; 0: the first."),
      Field::integer(
          "most_bins", &c.most_bins, {0, 1e6}, "bins",
          "Range bins from the sonar to the end of its window at most: a finer sonar's are averaged, and their "
          "speckle with them; 0: all as they are."),
  };
  for (Field& field : fields(c.survey)) all.push_back(std::move(field));
  return all;
}

}  // namespace isobath
