// What all connections of a WebServer share: its configuration and site, the counts, the reports, the open connections,
// and the stream on which they read and write, with its limit. Internal to the sources of this folder, because it needs
// Boost.Beast. One thread runs all handlers; `mutex` guards the counts, which other threads read.
#pragma once

// The handlers of one thread need no fences, which the thread sanitizer could not follow.
#define BOOST_ASIO_DISABLE_FENCED_BLOCK
#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <isobath/server/web_counts.hpp>
#include <isobath/server/web_request.hpp>
#include <isobath/server/web_server_config.hpp>
#include <isobath/server/web_site.hpp>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isobath::web {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = net::ip::tcp;
using Clock = std::chrono::steady_clock;
using beast::error_code;

constexpr std::size_t kPieceBytes = 64 * 1024;  ///< written at a time; a client that takes a piece is alive
constexpr Clock::duration kCloseWithin = std::chrono::milliseconds(500);
constexpr Clock::duration kReportsKept = std::chrono::milliseconds(100);

Clock::duration ticks_of(double s);

/// A RatePolicy of Beast. It bounds all bytes that are read from a connection, also those that become no message.
class ReadLimit {
 public:
  explicit ReadLimit(std::size_t bytes_a_second) : most_(bytes_a_second), left_(bytes_a_second) {}
  [[nodiscard]] int seconds_full() const { return full_; }

 private:
  friend class beast::rate_policy_access;
  [[nodiscard]] std::size_t available_read_bytes() const { return left_; }
  static std::size_t available_write_bytes() { return std::numeric_limits<std::size_t>::max(); }
  void transfer_read_bytes(std::size_t n) { left_ -= std::min(left_, n); }
  static void transfer_write_bytes(std::size_t) {}
  void on_timer() {
    full_ = left_ == 0 ? full_ + 1 : 0;
    left_ = most_;
  }

  std::size_t most_, left_;
  int full_ = 0;
};

struct Stream : beast::basic_stream<tcp, net::any_io_executor, ReadLimit> {
  using basic_stream::basic_stream;
};

/// Beast closes a socket with this function. The default would wait for a misbehaving client to close its end.
template <class Handler>
void async_teardown(beast::role_type, Stream& stream, Handler&& handler) {
  error_code ignored;
  stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
  net::post(stream.get_executor(), beast::bind_front_handler(std::forward<Handler>(handler), error_code()));
}

class HttpConnection;
class SocketClient;

/// A connection lives as long as one of its operations is pending; all operations end with the context, which is
/// destroyed first.
struct Hub {
  Hub(const WebServerConfig& c, WebSite s)
      : config(c),
        site(std::move(s)),
        hosts(names_of_list(c.hosts)),
        viewer_origins(names_of_list(c.viewer_origins)),
        frame_origins(names_of_list(c.frame_origins)) {}

  WebServerConfig config;
  WebSite site;
  std::vector<std::string> hosts, viewer_origins, frame_origins;
  mutable std::mutex mutex;  ///< guards the counts
  WebCounts counts;
  std::map<std::uint64_t, HttpConnection*> requesting;  ///< the oldest first
  std::set<SocketClient*> clients;
  struct Report {
    std::string text;
    std::optional<Clock::time_point> made;
  };
  Report health, metrics;
  net::io_context context{1};

  template <class Change>
  void count(const Change& change) {
    const std::lock_guard lock(mutex);
    change(counts);
  }
  void refuse(std::string_view reason) {
    count([&](WebCounts& c) { c.refuse(reason); });
  }
  const std::string& report(Report& report, const std::function<std::string()>& make);
};

/// Counts one connection for as long as it lives.
class Seating {
 public:
  explicit Seating(Hub& hub) : hub_(&hub) {
    hub.count([](WebCounts& c) { ++c.connections, ++c.connections_ever; });
  }
  Seating(Seating&& other) noexcept : hub_(std::exchange(other.hub_, nullptr)) {}
  Seating& operator=(Seating&&) = delete;
  ~Seating() {
    if (hub_) hub_->count([](WebCounts& c) { --c.connections; });
  }

 private:
  Hub* hub_;
};

}  // namespace isobath::web
