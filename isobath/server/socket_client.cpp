#include <exception>
#include <isobath/server/socket_client.hpp>

namespace isobath::web {
namespace {

constexpr int kMaxFragments = 64;  ///< per message
constexpr int kFloodSeconds = 2;   ///< consecutive seconds at the limit of bytes

}  // namespace

SocketClient::SocketClient(Hub& hub, Stream stream, Seating place, const WebSite::Socket& wanted)
    : hub_(hub),
      place_(std::move(place)),
      socket_(std::move(stream)),
      pause_(hub.context),
      messages_(hub.config.messages_hz),
      controls_(hub.config.messages_hz),
      wanted_(wanted) {
  hub_.clients.insert(this);
}

SocketClient::~SocketClient() {
  hub_.clients.erase(this);
  if (session_) hub_.count([](WebCounts& c) { --c.clients; });
}

void SocketClient::accept(http::request<http::empty_body> request, bool full, const std::string& protocol) {
  const WebServerConfig& c = hub_.config;
  socket_.set_option(websocket::stream_base::timeout{ticks_of(c.request_s), ticks_of(c.silent_s), true});
  socket_.read_message_max(static_cast<std::size_t>(c.max_message_bytes));
  socket_.auto_fragment(false);
  if (!protocol.empty()) {
    socket_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, protocol);
    }));
  }
  socket_.control_callback([this](websocket::frame_type kind, beast::string_view) {
    const bool close = kind == websocket::frame_type::close;
    if (close || controls_.take(Clock::now()) < std::chrono::seconds(1)) return;
    net::post(hub_.context, [self = shared_from_this()] { self->refuse("pings"); });
  });
  request_ = std::move(request);
  socket_.async_accept(request_, [self = shared_from_this(), full](error_code ec) {
    if (ec) return self->hub_.refuse("handshake");
    if (!full) return self->open();
    self->refuse("clients", websocket::close_code::try_again_later);
    self->read();
  });
}

void SocketClient::tick(Clock::time_point now) {
  if (closing_) {
    if (now - closing_since_ > kCloseWithin) drop();
  } else if (writing_ && now - piece_since_ > ticks_of(hub_.config.stalled_s)) {
    hub_.refuse("stalled");
    drop();
  } else if (lowest().rate_policy().seconds_full() >= kFloodSeconds) {
    refuse("flood");
  } else if (session_ && !asked_) {
    asked_ = true;  // posted, so that reads of other clients come in between
    net::post(hub_.context, [self = shared_from_this()] {
      self->asked_ = false;
      self->ask();
    });
  }
}

void SocketClient::drop() {
  closing_ = true;
  pause_.cancel();
  lowest().close();
}

Stream& SocketClient::lowest() { return beast::get_lowest_layer(socket_); }

void SocketClient::open() {
  const auto opened = [&] {
    session_ = wanted_.open();
    error_code ec;
    const auto client = lowest().socket().remote_endpoint(ec);
    if (!ec) session_->on_client(client.address().to_string());
  };
  if (call(opened)) {
    hub_.count([](WebCounts& c) { ++c.clients, ++c.clients_ever; });
    ask();
  }
  read();
}

template <class Function>
bool SocketClient::call(const Function& function) {
  const auto begun = Clock::now();
  try {
    function();
  } catch (const std::exception&) {
    hub_.refuse("session");
    hang_up(websocket::close_code::internal_error);
    return false;
  }
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begun).count();
  hub_.count([&](WebCounts& c) { c.longest_call_us = std::max<std::uint64_t>(c.longest_call_us, us); });
  return true;
}

void SocketClient::read() {
  const auto room = static_cast<std::size_t>(hub_.config.max_message_bytes);
  socket_.async_read_some(heard_, room, [self = shared_from_this()](error_code ec, std::size_t) { self->on_read(ec); });
}

void SocketClient::on_read(error_code ec) {
  if (ec) return on_read_error(ec);
  if (closing_) {  // wait for the client's close
    heard_.clear();
    return read();
  }
  if (!socket_.got_text()) {
    refuse("binary", websocket::close_code::unknown_data);
  } else if (!socket_.is_message_done()) {
    if (++fragments_ > kMaxFragments) refuse("fragments");
  } else {
    fragments_ = 0;
    return hear();
  }
  read();
}

void SocketClient::on_read_error(error_code ec) {
  if (closing_) return drop();
  using Error = websocket::error;
  if (ec == Error::message_too_big) {
    break_off("message_bytes");
  } else if (ec == Error::bad_frame_payload) {
    break_off("message_utf8");
  } else if (ec == websocket::condition::protocol_violation) {
    break_off("message_frame");
  } else {
    if (ec == beast::error::timeout) hub_.refuse("silent");
    drop();
  }
}

void SocketClient::break_off(std::string_view reason) {
  hub_.refuse(reason);
  closing_ = true;
  closing_since_ = Clock::now();
  pause_.expires_after(kCloseWithin);
  pause_.async_wait([self = shared_from_this()](error_code) { self->drop(); });
}

void SocketClient::hear() {
  hub_.count([](WebCounts& c) { ++c.messages; });
  Hearing hearing;
  const auto bytes = heard_.cdata();
  const std::string_view text(static_cast<const char*>(bytes.data()), bytes.size());
  if (!call([&] { hearing = session_->on_message(text); })) return read();
  heard_.clear();
  if (!hearing.refused.empty()) hub_.refuse(hearing.refused);
  if (hearing.hang_up) refuse("hung_up");
  ask();  // answer at once, not at the next tick
  const Clock::duration wait = messages_.take(Clock::now());
  if (wait == Clock::duration::zero() || closing_) return read();
  hub_.refuse("message_rate");
  pause_.expires_after(wait);
  pause_.async_wait([self = shared_from_this()](error_code) { self->read(); });
}

void SocketClient::ask() {
  if (writing_ || closing_) return;
  if (!call([&] { frame_ = session_->next(); }) || frame_.bytes() == 0) return;
  writing_ = true;
  sent_ = 0;
  socket_.text(frame_.text);
  write();
}

void SocketClient::write() {
  const std::size_t shared = frame_.shared ? frame_.shared->size() : 0;
  const std::string_view part = sent_ < shared ? std::string_view(*frame_.shared).substr(sent_)
                                               : std::string_view(frame_.own).substr(sent_ - shared);
  const std::string_view piece = part.substr(0, kPieceBytes);
  sent_ += piece.size();
  piece_since_ = Clock::now();
  socket_.async_write_some(sent_ == frame_.bytes(), net::buffer(piece.data(), piece.size()),
                           [self = shared_from_this()](error_code ec, std::size_t) { self->on_written(ec); });
}

void SocketClient::on_written(error_code ec) {
  if (ec) return drop();
  if (sent_ < frame_.bytes()) return write();
  hub_.count([&](WebCounts& c) { ++c.frames, c.frame_bytes += sent_; });
  const bool more = frame_.more;
  frame_ = {};
  writing_ = false;
  if (more) ask();
}

void SocketClient::refuse(std::string_view reason, websocket::close_code code) {
  if (closing_) return;
  hub_.refuse(reason);
  hang_up(code);
}

void SocketClient::hang_up(websocket::close_code code) {
  if (std::exchange(closing_, true)) return;
  closing_since_ = Clock::now();
  socket_.async_close(code, [self = shared_from_this()](error_code) { self->drop(); });
}

}  // namespace isobath::web
