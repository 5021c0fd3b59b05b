#include <algorithm>
#include <exception>
#include <fmt/format.h>
#include <isobath/server/http_connection.hpp>
#include <isobath/server/socket_client.hpp>

namespace isobath::web {
namespace {

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

}  // namespace

HttpConnection::HttpConnection(Hub& hub, tcp::socket socket, std::uint64_t number)
    : hub_(hub), number_(number), place_(hub), stream_(limit_of(hub.config), std::move(socket)) {
  hub_.requesting.emplace(number_, this);
}

HttpConnection::~HttpConnection() { hub_.requesting.erase(number_); }

void HttpConnection::read() {
  parser_.emplace();
  parser_->header_limit(kMaxHeader);
  parser_->body_limit(0);
  stream_.expires_after(ticks_of(hub_.config.request_s));
  http::async_read(stream_, buffer_, *parser_,
                   [self = shared_from_this()](error_code ec, std::size_t) { self->on_read(ec); });
}

void HttpConnection::drop() { stream_.close(); }

ReadLimit HttpConnection::limit_of(const WebServerConfig& c) {
  const double messages = 2 * c.messages_hz * c.max_message_bytes;
  return ReadLimit(std::max(2 * kMaxHeader, static_cast<std::size_t>(messages)));
}

void HttpConnection::on_read(error_code ec) {
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

void HttpConnection::answer(http::request<http::empty_body> request) {
  keep_alive_ = request.keep_alive();
  head_ = request.method() == http::verb::head;
  if (!head_ && request.method() != http::verb::get) return refuse(http::status::method_not_allowed, "method");
  if (request.target().size() > kMaxTarget) return refuse(http::status::uri_too_long, "target_bytes");
  if (request.count(http::field::host) != 1 || request.count(http::field::origin) > 1) {
    return refuse(http::status::bad_request, "request");
  }
  host_ = view(request[http::field::host]);
  if (!is_own_host(host_, hub_.hosts)) return refuse(http::status::misdirected_request, "host");
  const auto path = path_of_target(view(request.target()));
  if (!path) return refuse(http::status::bad_request, "path");
  if (const auto socket = hub_.site.sockets.find(*path); socket != hub_.site.sockets.end()) {
    return upgrade(std::move(request), socket->second);
  }
  if (*path == "/health" || *path == "/metrics") return report(*path == "/health");

  const auto file = hub_.site.files.find(*path);
  if (file == hub_.site.files.end()) return refuse(http::status::not_found, "not_found");
  const bool gzip = !file->second.gzipped.empty() && takes_gzip(view(request[http::field::accept_encoding]));
  auto response = response_of(http::status::ok, file->second.media_type, "no-cache");
  response.set(http::field::vary, "Accept-Encoding");
  if (gzip) response.set(http::field::content_encoding, "gzip");
  send(std::move(response), gzip ? file->second.gzipped : file->second.bytes);
}

void HttpConnection::report(bool health) {
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

void HttpConnection::upgrade(http::request<http::empty_body> request, const WebSite::Socket& wanted) {
  if (head_ || !websocket::is_upgrade(request) || buffer_.size() > 0) {
    return refuse(http::status::upgrade_required, "no_upgrade");
  }
  const auto origin = request.find(http::field::origin);
  if (origin != request.end() && !may_open(view(origin->value()), wanted)) {
    return refuse(http::status::forbidden, "origin");
  }
  std::string protocol;
  if (!wanted.protocols.empty()) {
    const auto offered = names_of_list(view(request[http::field::sec_websocket_protocol]));
    const auto agreed = std::ranges::find_first_of(wanted.protocols, offered);
    if (agreed == wanted.protocols.end()) return refuse(http::status::bad_request, "protocol");
    protocol = *agreed;
  }
  const bool full = hub_.clients.size() >= static_cast<std::size_t>(hub_.config.max_clients);
  stream_.expires_never();
  std::make_shared<SocketClient>(hub_, std::move(stream_), std::move(place_), wanted)
      ->accept(std::move(request), full, protocol);
}

bool HttpConnection::may_open(std::string_view origin, const WebSite::Socket& wanted) const {
  if (is_origin_of(origin, host_)) return true;
  return wanted.foreign && std::ranges::find(hub_.viewer_origins, origin) != hub_.viewer_origins.end();
}

/// Who may show the page in a frame, for the browser.
std::string HttpConnection::framers() const {
  return hub_.frame_origins.empty() ? "'none'" : fmt::format("{}", fmt::join(hub_.frame_origins, " "));
}

HttpConnection::Response HttpConnection::response_of(http::status status, std::string_view type,
                                                     std::string_view cache) const {
  Response response{status, 11};
  response.set(http::field::content_type, beast::string_view(type.data(), type.size()));
  response.set(http::field::cache_control, beast::string_view(cache.data(), cache.size()));
  // The page is one file with script and style: it loads nothing from elsewhere and sends only to this server. Older
  // browsers do not count the socket as 'self'.
  response.set("Content-Security-Policy",
               fmt::format("default-src 'none'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; "
                           "img-src 'self' data: blob:; font-src 'self' data:; worker-src 'self' blob:; "
                           "connect-src 'self'{}; base-uri 'none'; form-action 'none'; frame-ancestors {}",
                           host_.empty() ? "" : fmt::format(" ws://{0} wss://{0}", host_), framers()));
  response.set("X-Content-Type-Options", "nosniff");
  if (hub_.frame_origins.empty()) response.set("X-Frame-Options", "DENY");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  return response;
}

void HttpConnection::refuse(http::status status, std::string_view reason) {
  hub_.refuse(reason);
  keep_alive_ = false;
  if (reason == "host" || status == http::status::bad_request) host_.clear();  // must not be in a header
  text_ = fmt::format("{} ({})\n", view(http::obsolete_reason(status)), reason);
  Response response = response_of(status, "text/plain; charset=utf-8", "no-store");
  if (status == http::status::method_not_allowed) response.set(http::field::allow, "GET, HEAD");
  if (status == http::status::upgrade_required) response.set(http::field::upgrade, "websocket");
  send(std::move(response), text_);
}

void HttpConnection::send(Response response, std::string_view body) {
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

void HttpConnection::on_sent(error_code ec) {
  if (ec == beast::error::timeout) hub_.refuse("request_time");
  if (ec) return;
  if (keep_alive_) return read();
  // If the client is still sending, a full close could destroy the answer (RFC 9112, 9.6). So close only our half and
  // read on until the client closes.
  stream_.socket().shutdown(tcp::socket::shutdown_send, ec);
  linger();
}

void HttpConnection::linger() {
  stream_.expires_after(kCloseWithin);
  rest_.resize(kPieceBytes);
  stream_.async_read_some(net::buffer(rest_), [self = shared_from_this()](error_code ec, std::size_t n) {
    self->lingered_ += n;
    if (!ec && self->lingered_ < kPieceBytes) self->linger();
  });
}

}  // namespace isobath::web
