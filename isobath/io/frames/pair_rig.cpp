#include <algorithm>
#include <array>
#include <isobath/io/frames/pair_rig.hpp>
#include <vector>

namespace isobath {
namespace {

Schema rig_schema(PairRig& r) {
  Schema all;
  all.sections = {
      {"pairs",
       "Pairs of pictures of two cameras side by side.",
       {Field::file("calibration", &r.calibration,
                    "The cameras: TOML (isobath stereo --format explains it), or a YAML file of OpenCV."),
        Field::file("extrinsics", &r.extrinsics,
                    "OpenCV's second file, which says how the right camera stands; empty: none."),
        Field::text("left", &r.left, "Names of the left pictures (.png, .jpg) in the folder, with one *."),
        Field::text("right", &r.right,
                    "Names of the right ones; what * stands for is that of the left picture of the pair."),
        Field::file("times", &r.times,
                    "CSV file with the columns name (what * stands for) and t_s (seconds) or time_us (microseconds "
                    "since 1970); empty: times follow from rate_hz."),
        Field::real("rate_hz", &r.rate_hz, {0, 1000}, "Hz",
                    "Pairs per second, in the order of their names; 0: * stands for the time in microseconds since "
                    "1970, unless there is a file of times."),
        Field::real("start_s", &r.start_s, {-1e9, 1e10}, "s", "Time of the first pair, if rate_hz gives the times."),
        Field::file("poses", &r.poses, "CSV file of the vehicle's poses; empty: that of input.navigation, or none."),
        Field::text("left_topic", &r.left_topic, "Image topic of the left camera in a ROS log."),
        Field::text("right_topic", &r.right_topic, "Image topic of the right camera."),
        Field::numbers("position", r.position.data(), 3, {-100, 100}, "m",
                       "Where the left camera stands: forward, starboard, down of the point whose poses are known."),
        Field::degrees("heading_deg", &r.heading, {-360, 360}, "Direction in which it looks, clockwise from forward."),
        Field::degrees("pitch_deg", &r.pitch, {-90, 90}, "Its pitch; -90: straight down."),
        Field::degrees("roll_deg", &r.roll, {-180, 180}, "Its roll.")}}};
  return all;
}

void check_pattern(const std::string& pattern, const char* key, const std::string& file) {
  if (std::ranges::count(pattern, '*') == 1 && pattern.find('/') == std::string::npos) return;
  throw Error("\"" + pattern + "\" is no name with one *", {file, {}, {}, {}, std::string("pairs.") + key},
              "such as left_*.png");
}

}  // namespace

PairRig parse_pair_rig(std::string_view text, const std::string& file) {
  PairRig rig;
  Schema schema = rig_schema(rig);
  read_toml(text, file, schema);
  const auto at = [&](const char* key) { return Place{file, {}, {}, {}, std::string("pairs.") + key}; };
  if (rig.calibration.empty()) throw Error("is missing", at("calibration"), "a file");
  if (rig.left_topic.empty() != rig.right_topic.empty())
    throw Error("one topic is no pair", at("right_topic"), "two topics, or none");
  if (!rig.times.empty() && rig.rate_hz > 0)
    throw Error("both a rate and a file of times", at("rate_hz"), "one of them");
  check_pattern(rig.left, "left", file);
  check_pattern(rig.right, "right", file);
  return rig;
}

PairRig read_pair_rig(const std::filesystem::path& file) {
  PairRig rig = parse_pair_rig(text_of_file(file.string()), file.string());
  std::vector<std::filesystem::path> calibration{rig.calibration};
  if (!rig.extrinsics.empty()) calibration.emplace_back(rig.extrinsics);
  rig.cameras = read_stereo_calibration(calibration);
  if (rig.cameras.moves) throw Error("is of one camera that moves", {rig.calibration}, "two cameras side by side");
  return rig;
}

std::string pair_rig_toml(const PairRig& rig) {
  PairRig copy = rig;
  return write_toml(rig_schema(copy).sections, true);
}

std::string pair_rig_template() {
  PairRig rig;
  return write_template(rig_schema(rig));
}

}  // namespace isobath
