// Bytes of an unknown device, as `isobath setup` hears them while it looks what speaks on a link.
#include <isobath/links/link_probe.hpp>
#include <tests/fuzz/drain.hpp>

namespace isobath::fuzz {

class MuteLink final : public ByteLink {
 public:
  void send(std::vector<std::byte> /*bytes*/) override {}
  void cut(std::chrono::milliseconds /*lasts*/) override {}
  [[nodiscard]] int port() const override { return 0; }
  [[nodiscard]] std::uint64_t dropped() const override { return 0; }
};

}  // namespace isobath::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const Bytes bytes = std::as_bytes(std::span(data, size));
  fuzz::MuteLink link;
  LinkProbe probe(link_address_of("serial:/dev/ttyUSB0:115200", "link"));
  probe.use(link);
  probe.on_open({});
  probe.on_bytes(bytes.first(size / 2), {});
  probe.on_bytes(bytes.subspan(size / 2), {});
  if (const auto speaker = probe.speaker()) {
    ISOBATH_ASSERT(!speaker->what.empty());
    (void)link_address_of(speaker->link, "link");
  }
  return 0;
}
