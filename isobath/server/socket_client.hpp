// SocketClient: a page on the socket. It gives the page's messages to its WebSession and sends the session's frames,
// one at a time, and refuses or drops a page that sends too much or takes nothing. Internal to the sources of this
// folder, because it needs Boost.Beast. All functions are called by the thread of the server.
#pragma once

#include <algorithm>
#include <isobath/server/web_hub.hpp>
#include <isobath/server/web_session.hpp>
#include <memory>
#include <string_view>

namespace isobath::web {

/// A rate limit of `hz` per second, with bursts of one second's worth.
class Allowance {
 public:
  explicit Allowance(double hz) : hz_(hz), left_(hz) {}
  /// Takes one, possibly in advance. Returns the time to wait before the next may be taken.
  Clock::duration take(Clock::time_point now) {
    left_ = std::min(hz_, left_ + std::chrono::duration<double>(now - last_).count() * hz_) - 1;
    last_ = now;
    return left_ >= 0 ? Clock::duration::zero() : ticks_of(-left_ / hz_);
  }

 private:
  double hz_, left_;
  Clock::time_point last_ = Clock::now();
};

class SocketClient : public std::enable_shared_from_this<SocketClient> {
 public:
  /// `wanted` is of the hub's site.
  SocketClient(Hub& hub, Stream stream, Seating place, const WebSite::Socket& wanted);
  SocketClient(const SocketClient&) = delete;
  SocketClient& operator=(const SocketClient&) = delete;
  ~SocketClient();
  /// `full`: there are as many clients as there may be. A browser tells a page why a socket was closed, but not why one
  /// was refused, so the client is let in and told to try again later.
  /// `protocol`: the sub-protocol that was agreed on; empty: none.
  void accept(http::request<http::empty_body> request, bool full, const std::string& protocol);

  /// Called once per frame period.
  void tick(Clock::time_point now);
  void drop();

 private:
  Stream& lowest();
  void open();

  /// Calls a session; an exception ends its connection. Returns whether none was thrown.
  template <class Function>
  bool call(const Function& function);
  void read();
  void on_read(error_code ec);
  void on_read_error(error_code ec);

  /// Beast has sent the reason. A close at once, with bytes still unread, could keep it from arriving.
  void break_off(std::string_view reason);
  void hear();
  void ask();
  void write();
  void on_written(error_code ec);
  void refuse(std::string_view reason, websocket::close_code code = websocket::close_code::policy_error);
  void hang_up(websocket::close_code code);

  Hub& hub_;
  Seating place_;
  websocket::stream<Stream> socket_;
  net::steady_timer pause_;
  Allowance messages_, controls_;
  http::request<http::empty_body> request_;
  const WebSite::Socket& wanted_;
  std::unique_ptr<WebSession> session_;
  beast::flat_buffer heard_;
  int fragments_ = 0;
  WebFrame frame_;
  std::size_t sent_ = 0;
  Clock::time_point piece_since_, closing_since_;
  bool writing_ = false, closing_ = false, asked_ = false;
};

}  // namespace isobath::web
