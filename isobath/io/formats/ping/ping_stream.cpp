#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/ping/ping_device.hpp>
#include <isobath/io/formats/ping/ping_logs.hpp>

namespace isobath {
namespace {

class PingStream final : public LogSource {
 public:
  PingStream(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "ping protocol stream"), device_(config, report_) {
    report_.details["time"] = "estimated from the range setting: the stream has no times";
  }

 private:
  std::optional<Event> read() override {
    while (const auto frame = next_frame(input_, ping_frame_at, report_)) {
      auto event = device_.event(*frame, {}, input_.owner());
      if (event) return clock_.stamped(std::move(*event), device_.interval());
    }
    return {};
  }

  PingDevice device_;
  SyntheticClock clock_;
};

}  // namespace

bool looks_like_ping_stream(Bytes head) { return holds_frame(head, ping_frame_at); }

std::unique_ptr<Source> open_ping_stream(ByteWindow input, const InputConfig& config) {
  return std::make_unique<PingStream>(std::move(input), config);
}

}  // namespace isobath
