// One thread runs all handlers, so they need no fences, which the thread sanitizer could not follow.
#define BOOST_ASIO_DISABLE_FENCED_BLOCK
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <csignal>
#include <fmt/format.h>
#include <isobath/base/time.hpp>
#include <isobath/server/web_request.hpp>
#include <isobath/server/web_server.hpp>
#include <mutex>
#include <netinet/tcp.h>
#include <optional>
#include <set>
#include <thread>
#include <utility>

namespace isobath {

std::vector<Field> fields(WebServerConfig& c) {
  constexpr Range kWait{0.1, 3600};
  return {
      Field::text("address", &c.address,
                  "Address at which the page is served: 127.0.0.1 is this machine only, 0.0.0.0 all."),
      Field::integer("port", &c.port, {0, 65535}, "1", "Port; 0: any free port."),
      Field::text("hosts", &c.hosts, "Host names that requests may use besides addresses, separated by commas."),
      Field::integer("most_clients", &c.most_clients, {1, 1000}, "1", "Pages on the socket at a time."),
      Field::integer("most_connections", &c.most_connections, {2, 10000}, "1",
                     "Connections at a time, including pages."),
      Field::integer("most_message_bytes", &c.most_message_bytes, {256, 65536}, "byte",
                     "Size of a message from a page."),
      Field::real("messages_hz", &c.messages_hz, {1, 1000}, "1/s", "Messages accepted from a page; further ones wait."),
      Field::real("frames_hz", &c.frames_hz, {0.1, 60}, "1/s", "Frames sent to a page."),
      Field::real("request_s", &c.request_s, kWait, "s", "A request that is not complete by then is dropped."),
      Field::real("silent_s", &c.silent_s, kWait, "s", "A page that answers no ping for this long is dropped."),
      Field::real("stalled_s", &c.stalled_s, kWait, "s",
                  "A page that takes nothing of a frame for this long is dropped."),
  };
}

namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = net::ip::tcp;
using Clock = std::chrono::steady_clock;
using beast::error_code;

constexpr std::size_t kPieceBytes = 64 * 1024;  ///< written at a time; a client that takes a piece is alive
constexpr int kMostFragments = 64;              ///< per message
constexpr int kFloodSeconds = 2;                ///< consecutive seconds at the limit of bytes
constexpr Clock::duration kCloseWithin = std::chrono::milliseconds(500);
constexpr Clock::duration kReportsKept = std::chrono::milliseconds(100);

Clock::duration ticks_of(double s) { return std::chrono::duration_cast<Clock::duration>(seconds(s)); }
double seconds_of(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

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

/// A rate limit of `hz` per second, with bursts of one second's worth.
class Allowance {
 public:
  explicit Allowance(double hz) : hz_(hz), left_(hz) {}
  /// Takes one, possibly in advance. Returns the time to wait before the next may be taken.
  Clock::duration take(Clock::time_point now) {
    left_ = std::min(hz_, left_ + seconds_of(now - last_) * hz_) - 1;
    last_ = now;
    return left_ >= 0 ? Clock::duration::zero() : ticks_of(-left_ / hz_);
  }

 private:
  double hz_, left_;
  Clock::time_point last_ = Clock::now();
};

class HttpConnection;
class SocketClient;

/// State that all connections share. A connection lives as long as one of its operations is pending; all operations
/// end with the context, which is destroyed first.
struct Hub {
  Hub(const WebServerConfig& c, WebSite s) : config(c), site(std::move(s)), hosts(names_of_list(c.hosts)) {}

  WebServerConfig config;
  WebSite site;
  std::vector<std::string> hosts;
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
  tcp::acceptor acceptor{context};
  net::steady_timer ticker{context}, acceptor_rest{context};

  template <class Change>
  void count(const Change& change) {
    const std::lock_guard lock(mutex);
    change(counts);
  }
  void refuse(std::string_view reason) {
    count([&](WebCounts& c) { c.refuse(reason); });
  }
  void listen();
  void accept();
  void enter(tcp::socket socket);
  void tick();
  void run();
  void close_all();
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

// ---------------------------------------------------------------------------------------------- a client of the socket

class SocketClient : public std::enable_shared_from_this<SocketClient> {
 public:
  SocketClient(Hub& hub, Stream stream, Seating place)
      : hub_(hub),
        place_(std::move(place)),
        socket_(std::move(stream)),
        pause_(hub.context),
        messages_(hub.config.messages_hz),
        controls_(hub.config.messages_hz) {
    hub_.clients.insert(this);
  }
  SocketClient(const SocketClient&) = delete;
  SocketClient& operator=(const SocketClient&) = delete;
  ~SocketClient() {
    hub_.clients.erase(this);
    if (session_) hub_.count([](WebCounts& c) { --c.clients; });
  }

  void accept(http::request<http::empty_body> request) {
    const WebServerConfig& c = hub_.config;
    socket_.set_option(websocket::stream_base::timeout{ticks_of(c.request_s), ticks_of(c.silent_s), true});
    socket_.read_message_max(static_cast<std::size_t>(c.most_message_bytes));
    socket_.auto_fragment(false);
    socket_.binary(true);
    socket_.control_callback([this](websocket::frame_type kind, beast::string_view) {
      const bool close = kind == websocket::frame_type::close;
      if (close || controls_.take(Clock::now()) < std::chrono::seconds(1)) return;
      net::post(hub_.context, [self = shared_from_this()] { self->refuse("pings"); });
    });
    request_ = std::move(request);
    socket_.async_accept(request_, [self = shared_from_this()](error_code ec) {
      if (ec) return self->hub_.refuse("handshake");
      self->open();
    });
  }

  /// Called once per frame period.
  void tick(Clock::time_point now) {
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

  void drop() {
    closing_ = true;
    pause_.cancel();
    lowest().close();
  }

 private:
  Stream& lowest() { return beast::get_lowest_layer(socket_); }

  void open() {
    if (call([&] { session_ = hub_.site.open_session(); })) {
      hub_.count([](WebCounts& c) { ++c.clients, ++c.clients_ever; });
      ask();
    }
    read();
  }

  /// Calls a session; an exception ends its connection. Returns whether none was thrown.
  template <class Function>
  bool call(const Function& function) {
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

  void read() {
    const auto room = static_cast<std::size_t>(hub_.config.most_message_bytes);
    socket_.async_read_some(heard_, room,
                            [self = shared_from_this()](error_code ec, std::size_t) { self->on_read(ec); });
  }

  void on_read(error_code ec) {
    if (ec) return on_read_error(ec);
    if (closing_) {  // wait for the client's close
      heard_.clear();
      return read();
    }
    if (!socket_.got_text()) {
      refuse("binary", websocket::close_code::unknown_data);
    } else if (!socket_.is_message_done()) {
      if (++fragments_ > kMostFragments) refuse("fragments");
    } else {
      fragments_ = 0;
      return hear();
    }
    read();
  }

  void on_read_error(error_code ec) {
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

  /// Beast has sent the reason. A close at once, with bytes still unread, could keep it from arriving.
  void break_off(std::string_view reason) {
    hub_.refuse(reason);
    closing_ = true;
    closing_since_ = Clock::now();
    pause_.expires_after(kCloseWithin);
    pause_.async_wait([self = shared_from_this()](error_code) { self->drop(); });
  }

  void hear() {
    hub_.count([](WebCounts& c) { ++c.messages; });
    Hearing hearing;
    const auto bytes = heard_.cdata();
    const std::string_view text(static_cast<const char*>(bytes.data()), bytes.size());
    if (!call([&] { hearing = session_->hear(text); })) return read();
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

  void ask() {
    if (writing_ || closing_) return;
    if (!call([&] { frame_ = session_->next(); }) || frame_.bytes() == 0) return;
    writing_ = true;
    sent_ = 0;
    write();
  }

  void write() {
    const std::size_t shared = frame_.shared ? frame_.shared->size() : 0;
    const std::string_view part = sent_ < shared ? std::string_view(*frame_.shared).substr(sent_)
                                                 : std::string_view(frame_.own).substr(sent_ - shared);
    const std::string_view piece = part.substr(0, kPieceBytes);
    sent_ += piece.size();
    piece_since_ = Clock::now();
    socket_.async_write_some(sent_ == frame_.bytes(), net::buffer(piece.data(), piece.size()),
                             [self = shared_from_this()](error_code ec, std::size_t) { self->on_written(ec); });
  }

  void on_written(error_code ec) {
    if (ec) return drop();
    if (sent_ < frame_.bytes()) return write();
    hub_.count([&](WebCounts& c) { ++c.frames, c.frame_bytes += sent_; });
    const bool more = frame_.more;
    frame_ = {};
    writing_ = false;
    if (more) ask();
  }

  void refuse(std::string_view reason, websocket::close_code code = websocket::close_code::policy_error) {
    if (closing_) return;
    hub_.refuse(reason);
    hang_up(code);
  }

  void hang_up(websocket::close_code code) {
    if (std::exchange(closing_, true)) return;
    closing_since_ = Clock::now();
    socket_.async_close(code, [self = shared_from_this()](error_code) { self->drop(); });
  }

  Hub& hub_;
  Seating place_;
  websocket::stream<Stream> socket_;
  net::steady_timer pause_;
  Allowance messages_, controls_;
  http::request<http::empty_body> request_;
  std::unique_ptr<WebSession> session_;
  beast::flat_buffer heard_;
  int fragments_ = 0;
  WebFrame frame_;
  std::size_t sent_ = 0;
  Clock::time_point piece_since_, closing_since_;
  bool writing_ = false, closing_ = false, asked_ = false;
};

// ------------------------------------------------------------------------------------------------------ HTTP requests

class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Hub& hub, tcp::socket socket, std::uint64_t number)
      : hub_(hub), number_(number), place_(hub), stream_(limit_of(hub.config), std::move(socket)) {
    hub_.requesting.emplace(number_, this);
  }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;
  ~HttpConnection() { hub_.requesting.erase(number_); }

  void read() {
    parser_.emplace();
    parser_->header_limit(WebServer::kMostHeader);
    parser_->body_limit(0);
    stream_.expires_after(ticks_of(hub_.config.request_s));
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](error_code ec, std::size_t) { self->on_read(ec); });
  }

  void drop() { stream_.close(); }

 private:
  static ReadLimit limit_of(const WebServerConfig& c) {
    const double messages = 2 * c.messages_hz * c.most_message_bytes;
    return ReadLimit(std::max(2 * WebServer::kMostHeader, static_cast<std::size_t>(messages)));
  }

  void on_read(error_code ec) {
    if (ec == beast::error::timeout && buffer_.size() + (parser_->got_some() ? 1 : 0) > 0) hub_.refuse("request_time");
    if (ec == http::error::header_limit || ec == http::error::buffer_overflow) {
      return refuse(http::status::request_header_fields_too_large, "header_bytes");
    }
    if (ec == http::error::body_limit || ec == http::error::unexpected_body) {
      return refuse(http::status::payload_too_large, "body");
    }
    static const auto& kHttp = make_error_code(http::error::bad_method).category();
    if (ec && ec.category() == kHttp && ec != http::error::end_of_stream && ec != http::error::partial_message) {
      return refuse(http::status::bad_request, "request");
    }
    if (ec) return;
    hub_.count([](WebCounts& c) { ++c.requests; });
    answer(parser_->release());
  }

  static std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

  void answer(http::request<http::empty_body> request) {
    keep_alive_ = request.keep_alive();
    head_ = request.method() == http::verb::head;
    if (!head_ && request.method() != http::verb::get) return refuse(http::status::method_not_allowed, "method");
    if (request.target().size() > WebServer::kMostTarget) return refuse(http::status::uri_too_long, "target_bytes");
    if (request.count(http::field::host) != 1 || request.count(http::field::origin) > 1) {
      return refuse(http::status::bad_request, "request");
    }
    host_ = view(request[http::field::host]);
    if (!is_own_host(host_, hub_.hosts)) return refuse(http::status::misdirected_request, "host");
    const auto path = path_of_target(view(request.target()));
    if (!path) return refuse(http::status::bad_request, "path");
    if (*path == "/socket") return upgrade(std::move(request));
    if (*path == "/health" || *path == "/metrics") return report(*path == "/health");

    const auto file = hub_.site.files.find(*path);
    if (file == hub_.site.files.end()) return refuse(http::status::not_found, "not_found");
    const bool gzip = !file->second.gzipped.empty() && takes_gzip(view(request[http::field::accept_encoding]));
    auto response = response_of(http::status::ok, file->second.media_type, "no-cache");
    response.set(http::field::vary, "Accept-Encoding");
    if (gzip) response.set(http::field::content_encoding, "gzip");
    send(std::move(response), gzip ? file->second.gzipped : file->second.bytes);
  }

  void report(bool health) {
    try {
      text_ = health ? hub_.report(hub_.health, hub_.site.health) : hub_.report(hub_.metrics, hub_.site.metrics);
    } catch (const std::exception&) {
      return refuse(http::status::internal_server_error, "site");
    }
    if (!health) {
      const std::lock_guard lock(hub_.mutex);
      text_.insert(0, to_prometheus(hub_.counts));
    } else if (text_.empty()) {
      text_ = "{}";
    }
    const char* type = health ? "application/json" : "text/plain; version=0.0.4; charset=utf-8";
    send(response_of(http::status::ok, type, "no-store"), text_);
  }

  void upgrade(http::request<http::empty_body> request) {
    if (head_ || !websocket::is_upgrade(request) || buffer_.size() > 0) {
      return refuse(http::status::upgrade_required, "no_upgrade");
    }
    const auto origin = request.find(http::field::origin);
    if (origin != request.end() && !is_origin_of(view(origin->value()), host_)) {
      return refuse(http::status::forbidden, "origin");
    }
    if (hub_.clients.size() >= static_cast<std::size_t>(hub_.config.most_clients)) {
      return refuse(http::status::service_unavailable, "clients");
    }
    stream_.expires_never();
    std::make_shared<SocketClient>(hub_, std::move(stream_), std::move(place_))->accept(std::move(request));
  }

  using Response = http::response<http::span_body<const char>>;

  Response response_of(http::status status, std::string_view type, std::string_view cache) const {
    Response response{status, 11};
    response.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response.set(http::field::cache_control, beast::string_view(cache.data(), cache.size()));
    // The page is one file with script and style: it loads nothing from elsewhere and sends only to this server. Older
    // browsers do not count the socket as 'self'.
    response.set("Content-Security-Policy",
                 fmt::format("default-src 'none'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; "
                             "img-src 'self' data: blob:; font-src 'self' data:; worker-src 'self' blob:; "
                             "connect-src 'self'{}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
                             host_.empty() ? "" : fmt::format(" ws://{0} wss://{0}", host_)));
    response.set("X-Content-Type-Options", "nosniff");
    response.set("X-Frame-Options", "DENY");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Opener-Policy", "same-origin");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    return response;
  }

  void refuse(http::status status, std::string_view reason) {
    hub_.refuse(reason);
    keep_alive_ = false;
    if (reason == "host" || status == http::status::bad_request) host_.clear();  // must not be in a header
    text_ = fmt::format("{} ({})\n", view(http::obsolete_reason(status)), reason);
    Response response = response_of(status, "text/plain; charset=utf-8", "no-store");
    if (status == http::status::method_not_allowed) response.set(http::field::allow, "GET, HEAD");
    if (status == http::status::upgrade_required) response.set(http::field::upgrade, "websocket");
    send(std::move(response), text_);
  }

  /// The body must live until it is sent: text_, or a file of the site.
  void send(Response response, std::string_view body) {
    response_ = std::move(response);
    response_.body() = {body.data(), body.size()};
    response_.content_length(body.size());
    response_.keep_alive(keep_alive_);
    serializer_.emplace(response_);
    // The page may be sent over a slow link; 10 kB/s is the slowest allowed.
    stream_.expires_after(ticks_of(hub_.config.request_s + static_cast<double>(body.size()) / 1e4));
    auto sent = [self = shared_from_this()](error_code ec, std::size_t) { self->on_sent(ec); };
    if (head_) {
      serializer_->split(true);
      http::async_write_header(stream_, *serializer_, std::move(sent));
    } else {
      http::async_write(stream_, *serializer_, std::move(sent));
    }
  }

  void on_sent(error_code ec) {
    if (ec == beast::error::timeout) hub_.refuse("request_time");
    if (ec) return;
    if (keep_alive_) return read();
    // If the client is still sending, a full close could destroy the answer (RFC 9112, 9.6). So close only our half and
    // read on until the client closes.
    stream_.socket().shutdown(tcp::socket::shutdown_send, ec);
    linger();
  }

  void linger() {
    stream_.expires_after(kCloseWithin);
    rest_.resize(kPieceBytes);
    stream_.async_read_some(net::buffer(rest_), [self = shared_from_this()](error_code ec, std::size_t n) {
      self->lingered_ += n;
      if (!ec && self->lingered_ < kPieceBytes) self->linger();
    });
  }

  Hub& hub_;
  std::uint64_t number_;
  Seating place_;
  Stream stream_;
  beast::flat_buffer buffer_{2 * WebServer::kMostHeader};
  std::optional<http::request_parser<http::empty_body>> parser_;
  bool keep_alive_ = false, head_ = false;
  std::string host_, text_, rest_;
  std::size_t lingered_ = 0;
  Response response_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
};

// ------------------------------------------------------------------------------------------------------------ the hub

void Hub::listen() {
  error_code ec;
  const auto advise = [&](const std::string& problem) {
    throw Error(problem + ": " + ec.message(), {.key = "address, port"}, "an address of this machine, a free port",
                "choose another port, or 0 for any");
  };
  const auto address = net::ip::make_address(config.address, ec);
  if (ec) advise("no address: " + config.address);
  const tcp::endpoint end(address, static_cast<std::uint16_t>(config.port));
  acceptor.open(end.protocol(), ec);
  if (!ec) acceptor.set_option(net::socket_base::reuse_address(true), ec);
  if (!ec) acceptor.bind(end, ec);
  if (!ec) acceptor.listen(128, ec);
  if (ec) advise(fmt::format("cannot serve at {}, port {}", config.address, config.port));
}

void Hub::accept() {
  acceptor.async_accept([this](error_code ec, tcp::socket socket) {
    if (!acceptor.is_open()) return;
    if (!ec) {
      enter(std::move(socket));
      return accept();
    }
    refuse("accept");  // out of descriptors, mostly
    acceptor_rest.expires_after(kReportsKept);
    acceptor_rest.async_wait([this](error_code) { accept(); });
  });
}

void Hub::enter(tcp::socket socket) {
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
#ifdef TCP_NOTSENT_LOWAT
  const int unsent = static_cast<int>(WebServer::kUnsentBytes);
  setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
#endif
  std::uint64_t number = 0;
  bool full = false;
  count([&](WebCounts& c) {
    number = c.connections_ever;
    full = c.connections >= config.most_connections;
  });
  if (full) {  // drop the connection that has waited longest for its request
    refuse("connections");
    if (requesting.empty()) return;
    requesting.begin()->second->drop();
    requesting.erase(requesting.begin());
  }
  std::make_shared<HttpConnection>(*this, std::move(socket), number)->read();
}

void Hub::tick() {
  ticker.expires_after(ticks_of(1 / config.frames_hz));
  ticker.async_wait([this](error_code ec) {
    if (ec) return;
    const auto now = Clock::now();
    for (SocketClient* client : std::vector(clients.begin(), clients.end())) client->tick(now);
    tick();
  });
}

void Hub::run() {
  accept();
  tick();
  for (bool again = true; again;) {
    try {
      context.run();
      again = false;
    } catch (const std::exception&) {
      refuse("exception");
    }
  }
}

void Hub::close_all() {
  error_code ignored;
  acceptor.close(ignored);
  for (SocketClient* client : std::vector(clients.begin(), clients.end())) client->drop();
  for (const auto& [number, connection] : std::map(requesting)) connection->drop();
}

const std::string& Hub::report(Report& report, const std::function<std::string()>& make) {
  const auto now = Clock::now();
  if (!report.made || now - *report.made >= kReportsKept) {
    if (make) report.text = make();
    report.made = now;
  }
  return report.text;
}

}  // namespace

struct WebServer::State {
  State(const WebServerConfig& config, WebSite site) : hub(config, std::move(site)) {}
  Hub hub;
  int port = 0;
  std::thread thread;
};

WebServer::WebServer(const WebServerConfig& config, WebSite site)
    : state_(std::make_unique<State>(config, std::move(site))) {
  Hub& hub = state_->hub;
  hub.listen();
  state_->port = hub.acceptor.local_endpoint().port();
  // The server's thread blocks all signals; the main thread handles them.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    state_->thread = std::thread([&hub] { hub.run(); });
  } catch (const std::system_error&) {
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    throw Error("the system cannot start a thread for the page");
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

WebServer::~WebServer() {
  try {
    stop();
  } catch (...) {  // Asio may report that a timer could not be cancelled, which does not matter here
  }
}

int WebServer::port() const { return state_->port; }

WebCounts WebServer::counts() const {
  const std::lock_guard lock(state_->hub.mutex);
  return state_->hub.counts;
}

void WebServer::stop() {
  if (!state_->thread.joinable()) return;
  state_->hub.context.stop();
  state_->thread.join();
  state_->hub.close_all();
}

}  // namespace isobath
