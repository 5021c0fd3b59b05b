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
      Field::text("navigation", &c.navigation, "CSV file of poses that replace the log's own fixes; empty: none."),
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
  };
  for (Field& field : fields(c.survey)) all.push_back(std::move(field));
  return all;
}

}  // namespace isobath
