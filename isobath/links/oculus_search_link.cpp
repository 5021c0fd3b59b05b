#include <fmt/format.h>
#include <isobath/io/formats/oculus/oculus_status.hpp>
#include <isobath/links/hub_link.hpp>

namespace isobath {
namespace {

constexpr std::uint16_t kDataPort = 52100;

/// Listens for the status that an Oculus broadcasts once a second, then connects to its data port; after a loss it
/// listens again, since the address may have changed.
class OculusSearchLink final : public StreamLink<tcp::socket> {
 public:
  using StreamLink::StreamLink;

  void open() override {
    error_code fault;
    const udp::endpoint here(udp::v4(), static_cast<std::uint16_t>(address_.port));
    search_.open(here.protocol(), fault);
    if (!fault) search_.set_option(net::socket_base::reuse_address(true), fault);
    if (!fault) search_.bind(here, fault);
    if (fault) return lose("cannot listen for its broadcasts: " + fault.message());
    listen();
  }
  void close() override {
    StreamLink::close();
    error_code ignored;
    search_.close(ignored);
  }

 private:
  void listen() {
    search_.async_receive_from(
        net::buffer(heard_), from_, [self = shared_from_this(), this, life = life_](error_code fault, std::size_t n) {
          if (fault == net::error::operation_aborted || life != life_) return;
          if (fault) return lose(fault.message());
          const auto status = oculus_status_of(Bytes(heard_.data(), n));
          if (!status || !is_wanted(*status)) return listen();
          error_code ignored;
          search_.close(ignored);
          connect({net::ip::address_v4(oculus_address(*status, from_.address().to_v4().to_uint())), kDataPort});
        });
  }
  [[nodiscard]] bool is_wanted(const OculusStatus& status) const {
    return address_.host == LinkAddress::kAnyOculus || address_.host == fmt::format("{}", status.device);
  }
  void connect(const tcp::endpoint& sonar) {
    stream_.async_connect(sonar, [self = shared_from_this(), this, life = life_](error_code fault) {
      if (life != life_) return;
      if (fault) return lose(fault.message());
      error_code ignored;
      stream_.set_option(tcp::no_delay(true), ignored);
      begin();
    });
  }

  udp::socket search_{context_};
  udp::endpoint from_;
};

}  // namespace

std::shared_ptr<HubLink> make_oculus_search_link(net::io_context& context, const HubClock& clock,
                                                 const LinkAddress& address, ByteReceiver& receiver) {
  return std::make_shared<OculusSearchLink>(context, clock, address, receiver);
}

}  // namespace isobath
