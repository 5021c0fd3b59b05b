// VehicleLinks: the vehicle of a run aboard: the links of a vehicle file, the events that they give, and what goes out.
//
//   VehicleLinks vehicle(file);
//   vehicle.start();
//   while (auto event = vehicle.source().next()) { ...; vehicle.autopilot().command(setpoint, ...); }
//
// Any thread may call what FrontSeat and DeviceLink allow.
#pragma once

#include <isobath/links/device_link.hpp>
#include <isobath/links/vehicle_file.hpp>
#include <memory>

namespace isobath {

class VehicleLinks {
 public:
  /// Throws Error if a link cannot be made. `speed`: of the clock, for stand-ins that run as fast.
  explicit VehicleLinks(VehicleFile file, double speed = 1);
  VehicleLinks(const VehicleLinks&) = delete;
  VehicleLinks& operator=(const VehicleLinks&) = delete;
  ~VehicleLinks();

  void start() { hub_.start(); }
  [[nodiscard]] Time now() const { return hub_.now(); }
  [[nodiscard]] const VehicleFile& file() const { return file_; }
  [[nodiscard]] LinkSource& source() { return source_; }
  [[nodiscard]] FrontSeat& autopilot() { return *autopilot_; }
  /// The first scanning head or multibeam sonar takes the command.
  void scan(const ScanCommand& command);
  [[nodiscard]] const std::vector<std::unique_ptr<DeviceLink>>& devices() const { return devices_; }

 private:
  const VehicleFile file_;
  LinkHub hub_;  ///< its thread ends before what it calls
  LinkSource source_;
  std::unique_ptr<FrontSeat> autopilot_;  ///< never null
  std::vector<std::unique_ptr<DeviceLink>> devices_;
};

}  // namespace isobath
