// LinkProbe: tells what speaks on a link. It hears frames of Ping, Tritech, Oculus and MAVLink, NMEA 0183 sentences and
// the reports of a WaterLinked A50, and asks for what answers only a question: the device information of the Ping
// protocol and, on a serial line, the version of a Tritech head; at UDP port 30303 it asks Ping360 heads for their
// addresses. It commands nothing. A link on which nothing is understood has no speaker. Bytes that are no message are
// passed over; the memory is bounded by the longest message.
#pragma once

#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/bytes/line_stream.hpp>
#include <isobath/links/device_config.hpp>
#include <isobath/links/link_hub.hpp>
#include <mutex>
#include <optional>
#include <string>

namespace isobath {

struct Speaker {
  std::optional<DeviceKind> device;  ///< empty: an autopilot
  std::string link;                  ///< for a vehicle file
  std::string what;                  ///< for people: "Oculus M750d, number 7892"
};

class LinkProbe final : public ByteReceiver {
 public:
  explicit LinkProbe(const LinkAddress& address);
  void use(ByteLink& link) { link_ = &link; }

  void on_open(Time time) override;
  void on_bytes(Bytes bytes, Time time) override;
  void on_tick(Time now) override;

  /// From any thread.
  [[nodiscard]] std::optional<Speaker> speaker() const;

 private:
  void ask();
  void found(std::optional<DeviceKind> device, std::string what, std::string link = {});
  void on_ping(Bytes frame);
  void on_tritech(Bytes frame);
  void on_mavlink(Bytes frame);
  void on_line(std::string_view line);

  const LinkAddress address_;
  const bool asks_;  ///< a link to one device, not a port where many may come
  ByteLink* link_ = nullptr;
  bool open_ = false;
  Time asked_{};
  SourceReport ignored_;
  FrameStream ping_, tritech_, oculus_, mavlink_;
  LineStream lines_;
  mutable std::mutex mutex_;
  std::optional<Speaker> speaker_;  ///< guarded by mutex_
};

}  // namespace isobath
