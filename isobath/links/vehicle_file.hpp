// VehicleFile: what `isobath aboard` runs: the autopilot, the devices, the vehicle's limits and the mission, in TOML.
//
//   [vehicle]
//   model = "bluerov2"              # limits and size: a vehicle file, or the name of one of the project's
//   [autopilot]
//   link = "udp-server:14550"
//   [mission]
//   from = "autopilot"
//   [[device]]
//   kind = "ping360"
//   link = "udp:192.168.2.2:9092"
//   position_m = [0.2, 0, -0.1]
//
// Reading throws Error with line and column.
#pragma once

#include <isobath/links/device_config.hpp>
#include <isobath/links/front_seat.hpp>

namespace isobath {

struct VehicleFile {
  enum class MissionFrom : std::uint8_t { kNone, kFile, kAutopilot };
  std::string title;
  std::string model = "bluerov2";
  FrontSeatConfig autopilot;
  MissionFrom mission_from = MissionFrom::kAutopilot;
  std::string mission_file;  ///< relative to the vehicle file
  std::vector<DeviceConfig> devices;
};

VehicleFile parse_vehicle_file(std::string_view text, const std::string& file);
VehicleFile load_vehicle_file(const std::string& file);
/// The file that reads so: of each section and device the settings that are not the defaults, and the links.
std::string vehicle_file_text(VehicleFile vehicle);
/// Every section with its defaults, annotated.
std::string vehicle_file_template();

}  // namespace isobath
