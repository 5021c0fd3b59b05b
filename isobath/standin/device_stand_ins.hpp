// Stand-ins of sonars and of a velocity log: each speaks its device's bytes on its link, with the echoes of a simulated
// vehicle. A device that was not commanded says nothing, as the real ones; settings that the simulated sonar cannot
// follow are answered with its own.
//
//   Ping360   auto_transmit and transducer; the simulated scanning head sweeps as commanded
//   Ping1D    answers a request for `distance` with the newest range downward
//   Oculus    images for 3 s after each fire message
//   DVL A50   velocity and position reports
//
// on_bytes comes from the thread of the links, on_event from the simulator's.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/links/device_config.hpp>
#include <isobath/sonar/scan_command.hpp>
#include <isobath/standin/stand_in_link.hpp>
#include <memory>
#include <mutex>
#include <optional>

namespace isobath {

class DeviceStandIn : public ByteReceiver {
 public:
  DeviceStandIn(DeviceKind kind, const UnplugConfig& unplug, std::uint64_t stream)
      : kind_(kind), link_(unplug, stream) {}
  void use(LinkHub& hub, ByteLink& link) {
    hub_ = &hub;
    link_.use(link);
  }
  /// What the simulated vehicle measures.
  virtual void on_event(const Event& event, Time now) = 0;
  /// How the simulated sonar is to look, if a host has commanded it since the last call.
  [[nodiscard]] virtual std::optional<ScanCommand> take_command() { return std::nullopt; }
  [[nodiscard]] DeviceKind kind() const { return kind_; }
  [[nodiscard]] int port() const { return link_.port(); }
  [[nodiscard]] int pulled() const { return link_.pulled(); }

 protected:
  /// From any thread.
  void send(std::vector<std::byte> bytes, Time now) {
    hub_->post([this, now, bytes = std::move(bytes)]() mutable { link_.send(std::move(bytes), now); });
  }

 private:
  DeviceKind kind_;
  LinkHub* hub_ = nullptr;
  StandInLink link_;
};

std::unique_ptr<DeviceStandIn> make_device_stand_in(DeviceKind kind, const UnplugConfig& unplug, std::uint64_t stream);

}  // namespace isobath
