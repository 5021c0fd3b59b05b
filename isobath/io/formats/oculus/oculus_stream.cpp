#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/oculus/oculus_device.hpp>
#include <isobath/io/formats/oculus/oculus_logs.hpp>

namespace isobath {
namespace {

constexpr std::size_t kHeaderOfPing = 202;  // up to the last size

class OculusStream final : public LogSource {
 public:
  OculusStream(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "Oculus message stream"), device_(config, report_) {
    const std::uint32_t promised = oculus_payload_promised(input_.want(16));
    if (promised > kOculusMaxPayload) {
      throw Error(fmt::format("the first message states a payload of {} bytes", promised),
                  {input_.name(), 10, {}, {}, "payload"}, fmt::format("up to {} bytes", kOculusMaxPayload));
    }
    report_.details["time"] = "clock of the device, or estimated from the ping rate: the stream has no recorder's time";
  }

 private:
  std::optional<Event> read() override {
    while (const auto message = next_frame(input_, oculus_message_at, report_)) {
      if (auto event = device_.event(*message, {}, input_.owner())) return event;
    }
    return {};
  }

  OculusDevice device_;
};

}  // namespace

bool looks_like_oculus_stream(Bytes head) {
  if (oculus_payload_promised(head) > kOculusMaxPayload) return true;  // so that opening reports the size
  const std::string_view text = text_of(head);
  for (std::size_t at = text.find("SO"); at != std::string_view::npos; at = text.find("SO", at + 1)) {
    const Bytes rest = head.subspan(at);
    if (rest.size() >= kHeaderOfPing && starts_oculus_ping(rest)) return true;
    // Two letters and a short message of no ping also stand in samples of other sonars: its neighbour must be one, too,
    // or the stream starts or ends with it.
    const Framing message = oculus_message_at(rest);
    if (message.kind != Framing::Kind::kFrame) continue;
    const Bytes behind = rest.subspan(message.bytes);
    if (at == 0 || behind.empty() || oculus_message_at(behind).kind == Framing::Kind::kFrame) return true;
  }
  return false;
}

std::unique_ptr<Source> open_oculus_stream(ByteWindow input, const InputConfig& config) {
  return std::make_unique<OculusStream>(std::move(input), config);
}

}  // namespace isobath
