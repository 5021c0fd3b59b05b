// DeviceStandIn: a device that is played on its link, with what a simulated vehicle measures (device_stand_ins.hpp).
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/links/device_config.hpp>
#include <isobath/sonar/scan_command.hpp>
#include <isobath/standin/stand_in_link.hpp>
#include <optional>
#include <utility>
#include <vector>

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

}  // namespace isobath
