#include <boost/asio.hpp>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/links/hub_link.hpp>
#include <isobath/links/link_hub.hpp>
#include <optional>
#include <termios.h>
#include <thread>

namespace isobath {
namespace {

net::ip::address address_of(const LinkAddress& address) {
  error_code fault;
  const auto found = net::ip::make_address(address.host, fault);
  if (fault) throw Error(fmt::format("{} is no address of this machine", address.host), {.key = address.text()});
  return found;
}

class UdpLink final : public HubLink {
 public:
  using HubLink::HubLink;
  void listen() {
    error_code fault;
    const udp::endpoint end(address_of(address_), static_cast<std::uint16_t>(address_.port));
    socket_.open(end.protocol(), fault);
    if (!fault) socket_.bind(end, fault);
    if (fault) throw Error("cannot listen: " + fault.message(), {.key = address_.text()}, "a free port");
    port_ = socket_.local_endpoint().port();
  }
  void open() override {
    if (address_.kind == LinkAddress::Kind::kUdp) {
      error_code fault;
      udp::resolver resolver(context_);
      const auto found = resolver.resolve(address_.host, std::to_string(address_.port), fault);
      if (fault || found.empty()) return lose(fault.message());
      peer_ = found.begin()->endpoint();
      if (!socket_.is_open()) socket_.open(peer_->protocol(), fault);
      if (!fault) socket_.set_option(net::socket_base::broadcast(true), fault);
      if (fault) return lose(fault.message());
    }
    opened();
    if (!receiving_) receive();
  }
  void close() override {}

 private:
  void receive() {
    receiving_ = true;
    socket_.async_receive_from(
        net::buffer(heard_), from_, [self = shared_from_this(), this](error_code fault, std::size_t count) {
          receiving_ = false;
          if (fault == net::error::operation_aborted) return;
          const bool ours =
              address_.kind == LinkAddress::Kind::kUdpServer || (peer_ && (from_ == *peer_ || to_all(*peer_)));
          if (!fault && ours) {
            if (address_.kind == LinkAddress::Kind::kUdpServer) peer_ = from_;
            deliver(count);
          }
          receive();
        });
  }
  /// Whether it is an address of broadcasts, which others answer.
  static bool to_all(const udp::endpoint& peer) {
    constexpr std::uint32_t kEverywhere = 0xffffffff, kLoopback = 0x7fffffff;
    if (!peer.address().is_v4()) return false;
    const std::uint32_t address = peer.address().to_v4().to_uint();
    return address == kEverywhere || address == kLoopback;
  }
  void transmit(const std::vector<std::byte>& bytes) override {
    if (!peer_) {
      dropped_ += bytes.size();
      return net::post(context_, [self = shared_from_this(), this] { sent({}); });
    }
    socket_.async_send_to(net::buffer(bytes), *peer_,
                          [self = shared_from_this(), this](error_code fault, std::size_t) { sent(fault); });
  }

  udp::socket socket_{context_};
  udp::endpoint from_;
  std::optional<udp::endpoint> peer_;
  bool receiving_ = false;
};

class TcpClientLink final : public StreamLink<tcp::socket> {
 public:
  using StreamLink::StreamLink;
  void open() override {
    resolver_.async_resolve(address_.host, std::to_string(address_.port),
                            [self = shared_from_this(), this, life = life_](error_code fault, const auto& found) {
                              if (life != life_) return;
                              if (fault) return lose(fault.message());
                              connect(found);
                            });
  }

 private:
  void connect(const tcp::resolver::results_type& found) {
    net::async_connect(stream_, found, [self = shared_from_this(), this, life = life_](error_code fault, const auto&) {
      if (life != life_) return;
      if (fault) return lose(fault.message());
      error_code ignored;
      stream_.set_option(tcp::no_delay(true), ignored);
      begin();
    });
  }

  tcp::resolver resolver_{context_};
};

class TcpServerLink final : public StreamLink<tcp::socket> {
 public:
  using StreamLink::StreamLink;
  void listen() {
    error_code fault;
    const tcp::endpoint end(address_of(address_), static_cast<std::uint16_t>(address_.port));
    acceptor_.open(end.protocol(), fault);
    if (!fault) acceptor_.set_option(net::socket_base::reuse_address(true), fault);
    if (!fault) acceptor_.bind(end, fault);
    if (!fault) acceptor_.listen(1, fault);
    if (fault) throw Error("cannot listen: " + fault.message(), {.key = address_.text()}, "a free port");
    port_ = acceptor_.local_endpoint().port();
  }
  void open() override {
    acceptor_.async_accept(stream_, [self = shared_from_this(), this, life = life_](error_code fault) {
      if (fault == net::error::operation_aborted || life != life_) return;
      if (fault) return lose(fault.message());
      error_code ignored;
      stream_.set_option(tcp::no_delay(true), ignored);
      begin();
    });
  }

 private:
  tcp::acceptor acceptor_{context_};
};

class SerialLink final : public StreamLink<net::serial_port> {
 public:
  using StreamLink::StreamLink;
  void open() override {
    error_code fault;
    stream_.open(address_.host, fault);
    if (!fault) stream_.set_option(net::serial_port::baud_rate(static_cast<unsigned>(address_.port)), fault);
    if (!fault) stream_.set_option(net::serial_port::character_size(8), fault);
    if (fault) return lose(fault.message());
    ::tcflush(stream_.native_handle(), TCIOFLUSH);  // what came before is old
    begin();
  }
};

}  // namespace

struct LinkHub::State {
  explicit State(double speed) { clock.speed = speed; }
  HubClock clock;
  net::io_context context;
  net::steady_timer ticker{context};
  std::vector<std::shared_ptr<HubLink>> links;
  std::thread thread;

  void tick() {
    ticker.expires_after(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(kTickInterval) / clock.speed));
    ticker.async_wait([this](error_code fault) {
      if (fault) return;
      for (const auto& link : links) link->tick();
      tick();
    });
  }
};

LinkHub::LinkHub(double speed) : state_(std::make_unique<State>(speed)) {}

LinkHub::~LinkHub() { stop(); }

ByteLink& LinkHub::add(const LinkAddress& address, ByteReceiver& receiver) {
  const auto made = [&]<class Link>(std::type_identity<Link>) {
    return std::make_shared<Link>(state_->context, state_->clock, address, receiver);
  };
  using Kind = LinkAddress::Kind;
  std::shared_ptr<HubLink> link;
  switch (address.kind) {
    case Kind::kUdp: link = made(std::type_identity<UdpLink>{}); break;
    case Kind::kUdpServer: {
      auto server = made(std::type_identity<UdpLink>{});
      server->listen();
      link = server;
      break;
    }
    case Kind::kTcp: link = made(std::type_identity<TcpClientLink>{}); break;
    case Kind::kTcpServer: {
      auto server = made(std::type_identity<TcpServerLink>{});
      server->listen();
      link = server;
      break;
    }
    case Kind::kSerial: link = made(std::type_identity<SerialLink>{}); break;
    case Kind::kPty: link = make_pty_link(state_->context, state_->clock, address, receiver); break;
    case Kind::kOculus: link = make_oculus_search_link(state_->context, state_->clock, address, receiver); break;
  }
  return *state_->links.emplace_back(std::move(link));
}

void LinkHub::start() {
  for (const auto& link : state_->links) net::post(state_->context, [link] { link->open(); });
  state_->tick();
  state_->thread = std::thread([this] { state_->context.run(); });
}

void LinkHub::stop() {
  if (!state_->thread.joinable()) return;
  state_->context.stop();
  state_->thread.join();
}

void LinkHub::post(std::function<void()> work) { net::post(state_->context, std::move(work)); }

Time LinkHub::now() const { return state_->clock.now(); }

}  // namespace isobath
