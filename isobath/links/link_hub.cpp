#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <deque>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/links/link_hub.hpp>
#include <optional>
#include <thread>

namespace isobath {
namespace {

namespace net = boost::asio;
using net::ip::tcp;
using net::ip::udp;
using Wait = std::chrono::milliseconds;
using boost::system::error_code;

constexpr Wait kFirstRetry{250}, kLastRetry{4000};
constexpr std::size_t kMaxWaiting = 1 << 20;  // bytes

/// The clock of the hub.
struct HubClock {
  double speed = 1;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  Time wall = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
  [[nodiscard]] Time now() const {
    const Duration since = std::chrono::steady_clock::now() - start;
    return wall +
           (speed == 1 ? since : Duration(static_cast<std::int64_t>(static_cast<double>(since.count()) * speed)));
  }
};

net::ip::address address_of(const LinkAddress& address) {
  error_code fault;
  const auto found = net::ip::make_address(address.host, fault);
  if (fault) throw Error(fmt::format("{} is no address of this machine", address.host), {.key = address.text()});
  return found;
}

/// What all links share: the receiver, the retries, and what waits to be sent.
class HubLink : public ByteLink, public std::enable_shared_from_this<HubLink> {
 public:
  HubLink(net::io_context& context, const HubClock& clock, LinkAddress address, ByteReceiver& receiver)
      : context_(context), clock_(clock), address_(std::move(address)), receiver_(receiver), retry_(context) {}

  void send(std::vector<std::byte> bytes) override {
    net::post(context_,
              [self = shared_from_this(), bytes = std::move(bytes)]() mutable { self->queue(std::move(bytes)); });
  }
  void cut(Wait lasts) override {
    net::post(context_, [self = shared_from_this(), lasts] {
      self->lose("cut", lasts);
      self->deaf_until_ = std::chrono::steady_clock::now() + lasts;
    });
  }
  [[nodiscard]] int port() const override { return port_; }
  [[nodiscard]] std::uint64_t dropped() const override { return dropped_; }

  virtual void open() = 0;
  virtual void close() = 0;
  void tick() { receiver_.on_tick(clock_.now()); }

 protected:
  virtual void transmit(const std::vector<std::byte>& bytes) = 0;

  [[nodiscard]] bool deaf() const { return std::chrono::steady_clock::now() < deaf_until_; }
  void opened() {
    is_open_ = true;
    wait_ = kFirstRetry;
    receiver_.on_open(clock_.now());
  }
  void deliver(std::size_t count) {
    if (!deaf()) receiver_.on_bytes(Bytes(heard_.data(), count), clock_.now());
  }
  /// Closes the link and opens it again later.
  void lose(const std::string& why, std::optional<Wait> after = {}) {
    close();
    is_open_ = sending_ = false;
    for (const auto& bytes : waiting_) dropped_ += bytes.size();
    waiting_.clear();
    waiting_bytes_ = 0;
    receiver_.on_closed(clock_.now(), why);
    retry_.expires_after(after.value_or(wait_));
    wait_ = std::min(2 * wait_, kLastRetry);
    retry_.async_wait([self = shared_from_this()](error_code fault) {
      if (!fault) self->open();
    });
  }
  void queue(std::vector<std::byte> bytes) {
    if (!is_open_ || deaf() || waiting_bytes_ + bytes.size() > kMaxWaiting) {
      dropped_ += bytes.size();
      return;
    }
    waiting_bytes_ += bytes.size();
    waiting_.push_back(std::move(bytes));
    if (!sending_) send_next();
  }
  void send_next() {
    sending_ = !waiting_.empty();
    if (sending_) transmit(waiting_.front());
  }
  /// Any result of a transmission that this link made while it was open.
  void sent(error_code fault) {
    if (!is_open_ || waiting_.empty()) return;
    waiting_bytes_ -= waiting_.front().size();
    waiting_.pop_front();
    if (fault && address_.kind != LinkAddress::Kind::kUdp && address_.kind != LinkAddress::Kind::kUdpServer)
      return lose(fault.message());
    send_next();
  }

  net::io_context& context_;
  const HubClock& clock_;
  const LinkAddress address_;
  ByteReceiver& receiver_;
  net::steady_timer retry_;
  Wait wait_ = kFirstRetry;
  std::array<std::byte, 65536> heard_{};
  std::deque<std::vector<std::byte>> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::atomic<int> port_{0};
  std::atomic<std::uint64_t> dropped_{0};
  std::chrono::steady_clock::time_point deaf_until_{};
  bool is_open_ = false, sending_ = false;
  std::uint64_t life_ = 0;  ///< of the socket: answers to an earlier one are stale
};

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
          const bool ours = address_.kind == LinkAddress::Kind::kUdpServer || (peer_ && from_ == *peer_);
          if (!fault && ours) {
            if (address_.kind == LinkAddress::Kind::kUdpServer) peer_ = from_;
            deliver(count);
          }
          receive();
        });
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

/// A link on which bytes follow one another: TCP or a serial line.
template <class Stream>
class StreamLink : public HubLink {
 public:
  using HubLink::HubLink;
  void close() override {
    ++life_;
    error_code ignored;
    stream_.close(ignored);
  }

 protected:
  void receive() {
    stream_.async_read_some(net::buffer(heard_),
                            [self = shared_from_this(), this, life = life_](error_code fault, std::size_t count) {
                              if (life != life_) return;
                              if (fault) return lose(fault.message());
                              deliver(count);
                              receive();
                            });
  }
  void transmit(const std::vector<std::byte>& bytes) override {
    net::async_write(stream_, net::buffer(bytes),
                     [self = shared_from_this(), this, life = life_](error_code fault, std::size_t) {
                       if (life == life_) sent(fault);
                     });
  }
  void begin() {
    opened();
    receive();
  }

  Stream stream_{context_};
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
