// DeviceLink: one sonar or velocity log on its link: it commands the device, decodes what it sends, and gives events to
// the run. make_device_link makes the one for a device's kind.
//
//   Ping360   auto_transmit: the head sweeps its sector by itself. If no line comes for 2 s, it is commanded again. An
//             older head that refuses is asked line by line (transducer).
//   Ping1D    a request for `distance` each interval
//   Micron    head command, then a request for each line (micron_link.cpp)
//   Oculus    a fire message each second
//   DVL A50   JSON lines (json_v3): altitude and beams become ranges, velocity reports the velocity
//   NMEA      sentences (nmea_decoder.hpp): depths; with DeviceConfig::navigation also position and heading
//
// Times: a ping has the time of its transmission, that is, of the arrival of its first byte less the time of listening.
// Bytes that are no message, and messages that cannot be used, are counted by reason; a message that was not asked for
// changes nothing. All calls come from the thread of the links, but `command`, which any thread may call.
#pragma once

#include <atomic>
#include <Eigen/Core>
#include <functional>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/links/device_config.hpp>
#include <isobath/links/link_hub.hpp>
#include <isobath/links/link_source.hpp>
#include <isobath/sonar/scan_command.hpp>
#include <memory>

namespace isobath {

/// The velocity of a sensor over the bottom, in the body (forward, starboard, down).
struct BodyMotion {
  Time time;
  Eigen::Vector3d v_B;  ///< m/s
  double sigma = 0;     ///< m/s, as the sensor states it
};

class DeviceLink : public ByteReceiver {
 public:
  DeviceLink(DeviceConfig config, LinkSource& events) : config_(std::move(config)), events_(events) {}
  DeviceLink(const DeviceLink&) = delete;
  DeviceLink& operator=(const DeviceLink&) = delete;

  /// Before the hub starts.
  void use(LinkHub& hub, ByteLink& link) {
    hub_ = &hub;
    link_ = &link;
  }
  /// How it is to look from now on; a device that cannot be commanded ignores it.
  virtual void command(const ScanCommand& /*command*/) {}

  /// `take` gets each velocity that the device measures, in the thread of the links; most devices measure none.
  virtual void report_motion_to(const std::function<void(const BodyMotion&)>& /*take*/) {}

  void on_open(Time time) override;
  void on_closed(Time time, const std::string& why) override;
  [[nodiscard]] const DeviceConfig& config() const { return config_; }
  /// Whether a whole message of the device has come.
  [[nodiscard]] bool heard() const { return heard_; }
  [[nodiscard]] std::uint64_t losses() const { return losses_; }  ///< of the link, after it was open

 protected:
  /// The device is to be told what it is to do: the link is open, or the device is silent.
  virtual void begin() = 0;
  /// `arrival`: of its last byte.
  void give(Event event, Time arrival);
  /// Tells the run what the decoders have counted since the last call; the origin stays in `report`.
  void tell(SourceReport& report);

  DeviceConfig config_;
  LinkSource& events_;
  LinkHub* hub_ = nullptr;
  ByteLink* link_ = nullptr;
  std::atomic<bool> heard_{false};
  std::atomic<std::uint64_t> losses_{0};
  bool open_ = false;
};

std::unique_ptr<DeviceLink> make_device_link(const DeviceConfig& config, LinkSource& events);
// One of each kind; make_device_link calls them.
std::unique_ptr<DeviceLink> make_ping360_link(const DeviceConfig& config, LinkSource& events);
std::unique_ptr<DeviceLink> make_ping1d_link(const DeviceConfig& config, LinkSource& events);
std::unique_ptr<DeviceLink> make_micron_link(const DeviceConfig& config, LinkSource& events);
std::unique_ptr<DeviceLink> make_oculus_link(const DeviceConfig& config, LinkSource& events);
std::unique_ptr<DeviceLink> make_dvl_link(const DeviceConfig& config, LinkSource& events);
std::unique_ptr<DeviceLink> make_nmea_link(const DeviceConfig& config, LinkSource& events);

}  // namespace isobath
