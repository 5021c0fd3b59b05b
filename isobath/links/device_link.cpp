#include <fmt/format.h>
#include <isobath/links/device_link.hpp>

namespace isobath {

void DeviceLink::on_open(Time /*time*/) {
  open_ = true;
  events_.note(config_.called(), fmt::format("{} at {}, open", to_text(config_.kind), config_.link));
  begin();
}

void DeviceLink::on_closed(Time /*time*/, const std::string& why) {
  if (std::exchange(open_, false)) ++losses_;
  events_.note(config_.called(),
               fmt::format("{} at {}, lost {} times: {}", to_text(config_.kind), config_.link, losses_.load(), why));
}

void DeviceLink::give(Event event, Time arrival) {
  heard_ = true;
  events_.give(std::move(event), arrival);
}

void DeviceLink::tell(SourceReport& report) {
  for (const auto& [reason, count] : report.rejected)
    events_.refuse(fmt::format("{}: {}", config_.called(), reason), count);
  if (report.bytes_skipped > 0) events_.refuse(fmt::format("{}: bytes that are no message", config_.called()));
  for (const auto& [key, value] : report.details) events_.note(fmt::format("{}, {}", config_.called(), key), value);
  SourceReport empty;
  empty.origin = report.origin;
  report = std::move(empty);
}

std::unique_ptr<DeviceLink> make_device_link(const DeviceConfig& config, LinkSource& events) {
  switch (config.kind) {
    case DeviceKind::kPing360: return make_ping360_link(config, events);
    case DeviceKind::kPing1D: return make_ping1d_link(config, events);
    case DeviceKind::kMicron: return make_micron_link(config, events);
    case DeviceKind::kOculus: return make_oculus_link(config, events);
    case DeviceKind::kDvlA50: return make_dvl_link(config, events);
    case DeviceKind::kNmea: return make_nmea_link(config, events);
  }
  return nullptr;
}

}  // namespace isobath
