// PingDevice: what a Blue Robotics device says, frame by frame, as events.
//
// Ping360: 0 gradians is the head's forward mark; the range of bin k is c T (k + 0.5) / 2 with the sample period T; the
// speed of sound c is the host's. Beam 2 x 25 degrees. Ping1D: ranges are computed on board with the device's own speed
// of sound; a distance is a RangeReading (no echo where the device states no confidence), a profile a ping of one beam
// ahead. Cone 25 degrees. Messages that cannot be used are counted in the report, by reason; those without echoes are
// passed over.
#pragma once

#include <isobath/io/ping_protocol.hpp>
#include <isobath/io/scanning_head.hpp>

namespace isobath {

class PingDevice {
 public:
  /// `report` must live as long as this.
  PingDevice(const InputConfig& config, SourceReport& report);

  void set_type(PingDeviceType type) { type_ = type; }
  /// The event of the bytes of one frame of ping_frame_at, which `owner` keeps.
  std::optional<Event> event(Bytes bytes, Time time, const std::shared_ptr<const void>& owner);
  /// For logs without times: an estimate of the time from the last event to the next: listening, and turning the head.
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
  /// The settings that the report describes already: texts are made only when they change.
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
