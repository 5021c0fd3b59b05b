#include <isobath/links/autopilot_link.hpp>
#include <isobath/links/moos_link.hpp>
#include <isobath/links/vehicle_links.hpp>

namespace isobath {

std::unique_ptr<FrontSeat> make_front_seat(const FrontSeatConfig& config, LinkSource& events) {
  if (config.kind == FrontSeatKind::kMoos) return std::make_unique<MoosLink>(config, events);
  return std::make_unique<AutopilotLink>(config, events);
}

VehicleLinks::VehicleLinks(VehicleFile file, double speed)
    : file_(std::move(file)),
      hub_(speed),
      source_([this] { return hub_.now(); }),
      autopilot_(make_front_seat(file_.autopilot, source_)) {
  autopilot_->use(hub_, hub_.add(link_address_of(file_.autopilot.link, "autopilot.link"), *autopilot_));
  for (const DeviceConfig& config : file_.devices) {
    DeviceLink& device = *devices_.emplace_back(make_device_link(config, source_));
    if (config.navigation) autopilot_->leave_navigation_to_device();
    if (file_.autopilot.dvl_motion)
      device.report_motion_to([this](const BodyMotion& motion) { autopilot_->show_motion(motion); });
    device.use(hub_, hub_.add(link_address_of(config.link, "link"), device));
  }
}

VehicleLinks::~VehicleLinks() {
  autopilot_->end();
  hub_.stop();
}

void VehicleLinks::scan(const ScanCommand& command) {
  for (const auto& device : devices_) {
    if (device->config().images()) return device->command(command);
  }
}

}  // namespace isobath
