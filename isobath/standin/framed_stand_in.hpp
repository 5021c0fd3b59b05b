// FramedStandIn: a stand-in whose host speaks in frames. The mutex guards what the frames have set.
#pragma once

#include <cmath>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/standin/device_stand_in.hpp>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace isobath {

/// The line of a scanning head of 8 bits; null: another event.
inline const Ping* scanned_line(const Event& event) {
  const auto* ping = std::get_if<Ping>(&event);
  return ping && ping->fan->beams() == 1 && ping->intensity.type() == SampleType::kU8 ? ping : nullptr;
}
inline std::vector<std::byte> samples_of(const Ping& line) {
  std::vector<std::byte> samples(static_cast<std::size_t>(line.window.bins));
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] = static_cast<std::byte>(std::lround(line.intensity(0, static_cast<int>(i))));
  return samples;
}

class FramedStandIn : public DeviceStandIn {
 public:
  FramedStandIn(DeviceKind kind, const UnplugConfig& unplug, std::uint64_t stream, FrameAt frame_at)
      : DeviceStandIn(kind, unplug, stream), frames_(frame_at) {}

  void on_bytes(Bytes bytes, Time time) final {
    const std::lock_guard lock(mutex_);
    frames_.push(bytes, time, 0);
    while (const auto found = frames_.next(report_)) on_frame(found->frame, time);
    report_ = SourceReport{};
  }
  std::optional<ScanCommand> take_command() final {
    const std::lock_guard lock(mutex_);
    return std::exchange(command_, std::nullopt);
  }

 protected:
  virtual void on_frame(Bytes frame, Time time) = 0;
  std::mutex mutex_;
  std::optional<ScanCommand> command_;

 private:
  SourceReport report_;
  FrameStream frames_;
};

}  // namespace isobath
