#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/tritech/tritech_device.hpp>
#include <isobath/io/formats/tritech/tritech_logs.hpp>

namespace isobath {
namespace {

class TritechStream final : public LogSource {
 public:
  TritechStream(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "Tritech serial stream"), device_(config, report_) {
    report_.details["time"] = "estimated from the range setting and the serial line: the stream has no times";
  }

 private:
  std::optional<Event> read() override {
    while (const auto frame = next_frame(input_, tritech_frame_at, report_)) {
      auto event = device_.event(*frame, {}, input_.owner());
      if (event) return clock_.stamped(std::move(*event), device_.interval());
    }
    return {};
  }

  TritechDevice device_;
  SyntheticClock clock_;
};

}  // namespace

bool looks_like_tritech_stream(Bytes head) { return holds_frame(head, tritech_frame_at); }

std::unique_ptr<Source> open_tritech_stream(ByteWindow input, const InputConfig& config) {
  return std::make_unique<TritechStream>(std::move(input), config);
}

}  // namespace isobath
