// HubLink: what all links of a LinkHub share: the receiver, the retries, and what waits to be sent. StreamLink: a link
// on which bytes follow one another. Only the sources of links include this header, which brings Boost.Asio.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio.hpp>
#include <deque>
#include <isobath/base/time.hpp>
#include <isobath/links/byte_link.hpp>
#include <isobath/links/link_address.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

namespace net = boost::asio;
using boost::system::error_code;
using net::ip::tcp;
using net::ip::udp;

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

/// What all links share: the receiver, the retries, and what waits to be sent.
class HubLink : public ByteLink, public std::enable_shared_from_this<HubLink> {
 public:
  using Wait = std::chrono::milliseconds;
  static constexpr Wait kFirstRetry{250}, kLastRetry{4000};
  static constexpr std::size_t kMaxWaiting = 1 << 20;  ///< bytes

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

/// A pseudo-terminal that stands in for a serial line; its other end is at the path of the address.
std::shared_ptr<HubLink> make_pty_link(net::io_context& context, const HubClock& clock, const LinkAddress& address,
                                       ByteReceiver& receiver);
/// A TCP connection to an Oculus that is found by its broadcasts.
std::shared_ptr<HubLink> make_oculus_search_link(net::io_context& context, const HubClock& clock,
                                                 const LinkAddress& address, ByteReceiver& receiver);

}  // namespace isobath
