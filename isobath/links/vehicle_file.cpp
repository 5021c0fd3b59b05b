#include <algorithm>
#include <filesystem>
#include <isobath/links/vehicle_file.hpp>
#include <utility>

namespace isobath {
namespace {

Schema schema_of(VehicleFile& file) {
  using From = VehicleFile::MissionFrom;
  return {
      {{"vehicle",
        "The vehicle.",
        {Field::text("title", &file.title, "What the page and the report call it."),
         Field::text("model", &file.model,
                     "Its size and limits: a vehicle file (.toml), or the name of one that the program has.")}},
       {"autopilot", "What controls the vehicle: an ArduSub autopilot or a MOOS community.", fields(file.autopilot)},
       {"mission",
        "The mission.",
        {Field::choice("from", &file.mission_from,
                       {{"autopilot", From::kAutopilot}, {"file", From::kFile}, {"none", From::kNone}},
                       "Source: autopilot, what a ground station has sent to it; file; none: the vehicle only maps."),
         Field::text("file", &file.mission_file, "Mission file, or a plan of QGroundControl.")}}},
      {device_list(file.devices)}};
}

void check_link(const DeviceConfig& device) {
  using Kind = LinkAddress::Kind;
  const LinkAddress address = link_address_of(device.link, "link");
  if (device.kind == DeviceKind::kNmea && address.kind == Kind::kUdp)
    throw Error(device.link + ": NMEA 0183 is only heard, and is not sent to", device.place, "udp-server:PORT");
}

void check_front_seat(const VehicleFile& file) {
  const LinkAddress address = link_address_of(file.autopilot.link, "autopilot.link");
  if (file.autopilot.kind != FrontSeatKind::kMoos) return;
  if (address.kind != LinkAddress::Kind::kTcp)
    throw Error(file.autopilot.link + ": a MOOSDB is reached over TCP", {.key = "autopilot.link"}, "tcp:HOST:9000");
  if (file.autopilot.client.empty()) throw Error("the MOOS client has no name", {.key = "autopilot.client"});
  if (file.mission_from == VehicleFile::MissionFrom::kAutopilot)
    throw Error("a MOOS community holds no mission for Isobath", {.key = "mission.from"}, "",
                "write from = \"file\" and file = \"mission.toml\", or from = \"none\", into [mission]");
}

void check_devices(const VehicleFile& file) {
  std::vector<std::string> names;
  bool navigates = false;
  for (const DeviceConfig& device : file.devices) {
    if (device.link.empty()) throw Error("the device has no link", device.place, "udp:HOST:PORT and the like");
    check_link(device);
    if (device.navigation && std::exchange(navigates, true))
      throw Error("two devices are to give the vehicle's navigation", device.place, "", "leave out navigation in one");
    if (std::ranges::find(names, device.called()) != names.end())
      throw Error("two devices are called " + device.called(), device.place, "", "give each a name");
    names.push_back(device.called());
  }
  check_front_seat(file);
  if (file.mission_from == VehicleFile::MissionFrom::kFile && file.mission_file.empty())
    throw Error("the mission is to come from a file, but none is named", {.key = "mission.file"});
}

}  // namespace

VehicleFile parse_vehicle_file(std::string_view text, const std::string& file) {
  VehicleFile vehicle;
  Schema schema = schema_of(vehicle);
  read_toml(text, file, schema);
  check_devices(vehicle);
  return vehicle;
}

VehicleFile load_vehicle_file(const std::string& file) {
  VehicleFile vehicle = parse_vehicle_file(text_of_file(file), file);
  std::string& key = vehicle.autopilot.key_file;
  if (!key.empty()) key = (std::filesystem::path(file).parent_path() / key).string();
  return vehicle;
}

std::string vehicle_file_text(VehicleFile vehicle) {
  VehicleFile usual;
  const Schema schema = schema_of(vehicle), defaults = schema_of(usual);
  std::string text;
  const auto say = [&text](const std::string& header, const std::vector<Field>& fields,
                           const std::vector<Field>& usual_fields) {
    text += (text.empty() ? "" : "\n") + header + "\n";
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const std::string& name = fields[i].name();
      const bool always = name == "kind" || name == "link" || name == "model" || name == "from";
      if (always || fields[i].value() != usual_fields[i].value()) text += name + " = " + fields[i].value() + "\n";
    }
  };
  for (std::size_t i = 0; i < schema.sections.size(); ++i) {
    say("[" + schema.sections[i].name + "]", schema.sections[i].fields, defaults.sections[i].fields);
  }
  for (DeviceConfig& device : vehicle.devices) {
    DeviceConfig plain;
    say("[[device]]", fields(device), fields(plain));
  }
  return text;
}

std::string vehicle_file_template() {
  VehicleFile vehicle;
  std::string text = write_template(schema_of(vehicle));
  const std::string none = "link = \"\"",
                    example = "link = \"udp:192.168.2.2:9092\"";  // of the device; it has no default
  if (const std::size_t at = text.find(none); at != std::string::npos) text.replace(at, none.size(), example);
  return text;
}

}  // namespace isobath
