// PingDevice: converts the frames of a Blue Robotics device to events.
//
// Ping360: 0 gradians is the head's forward mark. The range of bin k is c T (k + 0.5) / 2 with the sample period T; the
// host sets the speed of sound c. Beam 2 x 25 degrees. Ping1D: the device computes ranges with its own speed of sound.
// A distance becomes a RangeReading (no echo if the device states no confidence), a profile becomes a ping of one beam
// ahead. Cone 25 degrees. Messages that cannot be used are counted in the report, by reason; messages without echoes
// are skipped.
#pragma once

#include <isobath/io/formats/ping/ping_protocol.hpp>
#include <isobath/io/input/scanning_head.hpp>

namespace isobath {

class PingDevice {
 public:
  /// `report` must outlive this object.
  PingDevice(const InputConfig& config, SourceReport& report);

  void set_type(PingDeviceType type) { type_ = type; }
  /// The event of one frame from ping_frame_at; `owner` keeps its bytes alive.
  std::optional<Event> event(Bytes bytes, Time time, const std::shared_ptr<const void>& owner);
  /// For logs without times: estimated time from the last event to the next, for listening and turning the head.
  [[nodiscard]] Duration interval() const { return interval_; }

 private:
  std::optional<Event> line(const PingFrame& frame, Time time, const std::shared_ptr<const void>& owner);
  std::optional<Event> reading(const PingFrame& frame, Time time, const std::shared_ptr<const void>& owner);
  void describe(const Ping360Line& line);
  void describe(const Ping1DReading& reading);
  std::optional<Event> reject(MessageFault fault);

  SourceReport& report_;
  ScanningHead scanner_;
  ScanningHead sounder_;  ///< a head that does not turn
  PingDeviceType type_ = PingDeviceType::kUnknown;
  double device_sound_speed_ = 1500;
  Duration interval_{};
  /// The settings that the report already describes; texts are made only when they change.
  struct Described {
    std::array<std::uint32_t, 5> values{};
    bool any = false;
    bool change(const std::array<std::uint32_t, 5>& now) {
      const bool changed = !any || values != now;
      values = now;
      any = true;
      return changed;
    }
  } described_;
};

}  // namespace isobath
