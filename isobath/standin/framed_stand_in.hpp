// FramedStandIn: a stand-in whose host speaks in frames. The mutex guards what the frames have set.
#pragma once

#include <isobath/io/bytes/framing.hpp>
#include <isobath/standin/device_stand_in.hpp>
#include <mutex>
#include <optional>
#include <utility>

namespace isobath {

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
