#include <isobath/links/device_config.hpp>

namespace isobath {

const char* to_text(DeviceKind kind) {
  switch (kind) {
    case DeviceKind::kPing360: return "ping360";
    case DeviceKind::kPing1D: return "ping1d";
    case DeviceKind::kMicron: return "micron";
    case DeviceKind::kOculus: return "oculus";
    case DeviceKind::kDvlA50: return "dvl-a50";
    case DeviceKind::kNmea: return "nmea";
  }
  return "";
}

void DeviceConfig::take(const ScanCommand& command, const DeviceConfig& configured) {
  if (command.as_configured) *this = configured;
  if (command.middle) middle = *command.middle;
  if (command.heading) middle = (*command.heading - configured.heading).wrapped();
  if (command.sector) sector = *command.sector;
  if (command.step) step = *command.step;
  if (command.range_m) range_m = *command.range_m;
}

InputConfig DeviceConfig::input() const {
  InputConfig input;
  input.sound_speed = sound_speed;
  input.mount_heading = heading;
  input.mount_pitch = pitch;
  input.mount_roll = roll;
  for (int i = 0; i < 3; ++i) input.mount_m[i] = position_m[i];
  input.clockwise = !upside_down;
  return input;
}

int DeviceConfig::gain_in_use() const {
  constexpr int kNormal = 1, kHalf = 50;
  if (gain >= 0) return gain;
  return kind == DeviceKind::kPing360 ? kNormal : kHalf;
}

std::vector<Field> fields(DeviceConfig& c) {
  using Kind = DeviceKind;
  return {
      Field::text("name", &c.name, "What the page and messages call it; empty: its kind."),
      Field::choice("kind", &c.kind,
                    {{to_text(Kind::kPing360), Kind::kPing360},
                     {to_text(Kind::kPing1D), Kind::kPing1D},
                     {to_text(Kind::kMicron), Kind::kMicron},
                     {to_text(Kind::kOculus), Kind::kOculus},
                     {to_text(Kind::kDvlA50), Kind::kDvlA50},
                     {to_text(Kind::kNmea), Kind::kNmea}},
                    "The device."),
      Field::text("link", &c.link, "Where it is: udp:HOST:PORT, tcp:HOST:PORT, serial:DEVICE:BAUD or oculus:auto."),
      Field::numbers(
          "position_m", c.position_m, 3, {-100, 100}, "m",
          "Forward, starboard and down of the vehicle's reference point; of NMEA 0183: of its echo sounder."),
      Field::degrees("heading_deg", &c.heading, {-180, 180},
                     "Direction of its zero bearing, from the bow to starboard."),
      Field::degrees("pitch_deg", &c.pitch, {-90, 90}, "Upward tilt of a multibeam sonar."),
      Field::degrees("roll_deg", &c.roll, {-180, 180}, "Roll of a multibeam sonar; 90: a vertical fan."),
      Field::choice("looks", &c.looks,
                    {{"usual", DeviceLooks::kUsual}, {"ahead", DeviceLooks::kAhead}, {"down", DeviceLooks::kDown}},
                    "Where a Ping1D looks: ahead (along heading_deg) or down; usual: down."),
      Field::flag("upside_down", &c.upside_down,
                  "Whether a scanning head hangs upside down: its bearings then grow counter-clockwise."),
      Field::real("sound_speed", &c.sound_speed, {1300, 1700}, "m/s", "Speed of sound in the water."),
      Field::real("range_m", &c.range_m, {0.75, 200}, "m", "Range that the sonar is commanded to."),
      Field::degrees("sector_deg", &c.sector, {1, 360}, "Sector that a scanning head sweeps."),
      Field::degrees("middle_deg", &c.middle, {-180, 180}, "Middle of that sector, from its zero bearing."),
      Field::degrees("step_deg", &c.step, {0.225, 9},
                     "Step of a scanning head; rounded to what it can do, a Ping360 to 0.9 degrees."),
      Field::integer("samples", &c.samples, {100, 1200}, "", "Samples of a line of a scanning head."),
      Field::integer("frequency_khz", &c.frequency_khz, {500, 1000}, "kHz", "Frequency of a Ping360."),
      Field::integer("gain", &c.gain, {-1, 100}, "",
                     "Gain: of a Ping360 0 (low), 1 or 2 (high); of an Oculus or a Micron in percent; -1: 1, or 50 %."),
      Field::real("interval_s", &c.interval_s, {0.02, 10}, "s", "Interval between the requests to a Ping1D."),
      Field::flag("navigation", &c.navigation,
                  "Whether this DVL or NMEA 0183 gives the vehicle's navigation, not the autopilot.")};
}

SectionList device_list(std::vector<DeviceConfig>& devices) {
  return {"device", "A sonar or a velocity log of the vehicle.", [&devices](const Place& place) {
            DeviceConfig& device = devices.emplace_back();
            device.place = place;
            return fields(device);
          }};
}

}  // namespace isobath
