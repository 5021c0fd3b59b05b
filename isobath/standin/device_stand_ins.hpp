// Stand-ins of sonars and of a velocity log: each speaks its device's bytes on its link, with the echoes of a simulated
// vehicle. A device that was not commanded says nothing, as the real ones; settings that the simulated sonar cannot
// follow are answered with its own.
//
//   Ping360   auto_transmit and transducer; the simulated scanning head sweeps as commanded
//   Ping1D    answers a request for `distance` with the newest range downward
//   Micron    settings and requests for single lines; says mtAlive once a second until it is asked for a line
//   Oculus    images for 3 s after each fire message; OculusBeacon broadcasts its status
//   DVL A50   velocity and position reports
//   NMEA      GGA, RMC, HDT and DPT, at most five times a second, of the vehicle at the surface above its place
//   Ping360 and Ping1D also say what they are.
//
// on_bytes comes from the thread of the links, on_event from the simulator's.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/links/device_config.hpp>
#include <isobath/standin/device_stand_in.hpp>
#include <memory>
#include <string>
#include <vector>

namespace isobath {

/// Says once a second where the sonar of an Oculus stand-in is.
class OculusBeacon final : public ByteReceiver {
 public:
  /// `sonar`: the address of its data.
  explicit OculusBeacon(const LinkAddress& sonar);
  void use(ByteLink& link) { link_ = &link; }
  void on_bytes(Bytes /*bytes*/, Time /*time*/) override {}
  void on_tick(Time now) override;

 private:
  const std::vector<std::byte> status_;
  ByteLink* link_ = nullptr;
  Time told_{};
};

/// Answers the broadcasts of those that look for a Ping360 with Ethernet.
class Ping360Finder final : public ByteReceiver {
 public:
  /// `head`: the address of its data; its port should be 12345.
  explicit Ping360Finder(const LinkAddress& head) : host_(head.host) {}
  void use(ByteLink& link) { link_ = &link; }
  void on_bytes(Bytes bytes, Time time) override;

 private:
  const std::string host_;
  ByteLink* link_ = nullptr;
};

/// `origin`: of the world.
std::unique_ptr<DeviceStandIn> make_device_stand_in(DeviceKind kind, const UnplugConfig& unplug, std::uint64_t stream,
                                                    const GeoOrigin& origin);
// Two of them; make_device_stand_in calls these.
std::unique_ptr<DeviceStandIn> make_micron_stand_in(const UnplugConfig& unplug, std::uint64_t stream);
std::unique_ptr<DeviceStandIn> make_nmea_stand_in(const UnplugConfig& unplug, std::uint64_t stream,
                                                  const GeoOrigin& origin);

}  // namespace isobath
