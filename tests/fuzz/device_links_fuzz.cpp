// Bytes of a device or of an autopilot as they come over a link: the first byte chooses who speaks, the rest comes in
// two chunks with a tick between them. What is decoded must be what a reader of logs may give; nothing that is heard
// leads to more than a bounded answer.
#include <isobath/links/autopilot_link.hpp>
#include <isobath/links/device_link.hpp>
#include <isobath/links/moos_link.hpp>
#include <tests/fuzz/drain.hpp>

namespace isobath::fuzz {

/// A link that counts what it is told to send.
class CountingLink final : public ByteLink {
 public:
  void send(std::vector<std::byte> bytes) override { sent += bytes.size(); }
  void cut(std::chrono::milliseconds /*lasts*/) override {}
  [[nodiscard]] int port() const override { return 0; }
  [[nodiscard]] std::uint64_t dropped() const override { return 0; }
  std::size_t sent = 0;
};

inline void hear(ByteReceiver& receiver, Bytes bytes, LinkHub& hub) {
  const Time now = hub.now();
  receiver.on_open(now);
  receiver.on_bytes(bytes.first(bytes.size() / 2), now);
  receiver.on_tick(now + std::chrono::seconds(1));
  receiver.on_bytes(bytes.subspan(bytes.size() / 2), now + std::chrono::seconds(1));
  receiver.on_tick(now + std::chrono::seconds(10));
}

}  // namespace isobath::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  if (size < 1) return 0;
  const Bytes bytes = std::as_bytes(std::span(data + 1, size - 1));
  LinkHub hub;  // does not start: all runs in this thread
  fuzz::CountingLink link;
  LinkSource source([&hub] { return hub.now(); });
  constexpr std::size_t kAnswer = 1024;  // bytes to a byte that is heard
  const unsigned who = data[0] % 8;
  constexpr unsigned kAutopilot = 4, kMoosdb = 7;
  if (who == kAutopilot) {
    AutopilotLink autopilot({}, source);
    autopilot.use(hub, link);
    autopilot.want_mission();
    fuzz::hear(autopilot, bytes, hub);
    (void)autopilot.mode();
  } else if (who == kMoosdb) {
    MoosLink moos({}, source);
    moos.use(hub, link);
    fuzz::hear(moos, bytes, hub);
    (void)moos.mode();
  } else {
    constexpr DeviceKind kKinds[] = {DeviceKind::kPing360, DeviceKind::kPing1D, DeviceKind::kOculus,
                                     DeviceKind::kDvlA50,  DeviceKind::kNmea,   DeviceKind::kMicron,
                                     DeviceKind::kNmea};  // the fifth is not used
    DeviceConfig config;
    config.kind = kKinds[who];
    config.navigation = true;
    const auto device = make_device_link(config, source);
    device->use(hub, link);
    fuzz::hear(*device, bytes, hub);
  }
  ISOBATH_ASSERT(link.sent <= kAnswer * (size + 8));
  source.give(Health{});
  while (const auto event = source.next()) {
    fuzz::look_at(*event);
    if (std::holds_alternative<Health>(*event) && time_of(*event) == Time{}) break;
  }
  return 0;
}
