#include <array>
#include <filesystem>
#include <isobath/base/file_access.hpp>
#include <isobath/sim/camera_config.hpp>

namespace isobath {

std::vector<Field> fields(CameraPairConfig& c) {
  return {
      Field::text("name", &c.name, "Name of the pair."),
      Field::flag("on", &c.on, "Whether the vehicle carries the pair."),
      Field::file("calibration", &c.calibration, "The cameras, as isobath stereo --format explains them (.toml)."),
      Field::real("rate_hz", &c.rate_hz, {0.01, 30}, "Hz", "Pairs of pictures per second."),
      Field::numbers("position", c.position.data(), 3, {-100, 100}, "m",
                     "Where the left camera stands: forward, starboard, down of the vehicle's middle."),
      Field::degrees("heading_deg", &c.heading, {-360, 360}, "Direction in which it looks, clockwise from forward."),
      Field::degrees("pitch_deg", &c.pitch, {-90, 90}, "Its pitch; -90: straight down."),
      Field::degrees("roll_deg", &c.roll, {-180, 180}, "Its roll."),
      Field::real("noise", &c.noise, {0, 50}, "grey levels", "Standard deviation of the noise of a pixel.")};
}

void check(const CameraPairConfig& camera) {
  Place place = camera.place;
  place.key += (place.key.empty() ? "" : ".") + std::string("calibration");
  if (camera.calibration.empty()) throw Error("is missing", place, "a file");
  if (std::filesystem::is_regular_file(camera.calibration)) return;
  throw Error("no such file: " + camera.calibration, place, "a file", nearest_file(camera.calibration));
}

StereoCalibration cameras_of(const CameraPairConfig& camera) {
  StereoCalibration cameras = read_stereo_calibration(std::array<std::filesystem::path, 1>{camera.calibration});
  if (cameras.moves || cameras.rectified.focal_px > 0 || cameras.left.width == 0)
    throw Error("is not of two cameras side by side", {camera.calibration}, "[left], [right] and [pair]");
  return cameras;
}

}  // namespace isobath
