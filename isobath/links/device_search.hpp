// search_devices: looks for devices and an autopilot at the given links for a while (LinkProbe), all at once.
// DeviceTrial: one found device at work, as a vehicle file would have it, and what comes of it.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/links/device_link.hpp>
#include <isobath/links/link_probe.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Where devices usually are: a Ping360 and a Ping1D as BlueOS bridges them, here and at 192.168.2.2; a Ping360 with
/// Ethernet, which answers a broadcast; an autopilot at UDP 14550 and 14551; the broadcasts of an Oculus; a WaterLinked
/// A50; NMEA 0183 at UDP 10110.
std::vector<std::string> usual_links();

struct SearchResult {
  std::vector<Speaker> speakers;      ///< autopilots first, then devices in the order of the links
  std::vector<std::string> problems;  ///< links that could not be tried, and why
};
/// `search_s`: of the clock of the links, which runs `speed` times as fast as that of the host. Throws Error for a text
/// that is no link.
SearchResult search_devices(const std::vector<std::string>& links, double search_s, double speed);

class DeviceTrial {
 public:
  DeviceTrial(const DeviceConfig& config, double speed);
  DeviceTrial(const DeviceTrial&) = delete;
  DeviceTrial& operator=(const DeviceTrial&) = delete;
  ~DeviceTrial() { hub_.stop(); }

  /// The next event of the device; empty: none within 50 ms.
  std::optional<Event> next();
  [[nodiscard]] const DeviceConfig& config() const { return config_; }
  [[nodiscard]] double age_s() const;  ///< of the trial, by the clock of the links
  /// "27.1 pings a second, range 20.0 m, the last 0.02 s old; 3 messages refused".
  [[nodiscard]] std::string summary() const;

 private:
  const DeviceConfig config_;
  LinkHub hub_;
  LinkSource source_;
  std::unique_ptr<DeviceLink> device_;
  Time began_;
  struct Count {
    int count = 0;
    std::string detail;
  };
  Count pings_, ranges_, fixes_;
  std::optional<Time> last_;
};

}  // namespace isobath
