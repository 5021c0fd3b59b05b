// HttpConnection: a connection from its first byte. It checks each request against the limits and hosts of the server,
// answers it with a file of the site or a report, and hands a request for the socket on to a SocketClient. Internal to
// the sources of this folder, because it needs Boost.Beast. All functions are called by the thread of the server.
#pragma once

#include <cstdint>
#include <isobath/server/web_hub.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace isobath::web {

class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Hub& hub, tcp::socket socket, std::uint64_t number);
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;
  ~HttpConnection();
  void read();
  void drop();

 private:
  static constexpr std::size_t kMaxHeader = 8192, kMaxTarget = 1024;
  using Response = http::response<http::span_body<const char>>;
  static ReadLimit limit_of(const WebServerConfig& c);
  void on_read(error_code ec);
  void answer(http::request<http::empty_body> request);
  void report(bool health);
  void upgrade(http::request<http::empty_body> request, const WebSite::Socket& wanted);
  [[nodiscard]] bool may_open(std::string_view origin, const WebSite::Socket& wanted) const;
  [[nodiscard]] std::string framers() const;
  Response response_of(http::status status, std::string_view type, std::string_view cache) const;
  void refuse(http::status status, std::string_view reason);

  /// The body must live until it is sent: text_, or a file of the site.
  void send(Response response, std::string_view body);
  void on_sent(error_code ec);
  void linger();

  Hub& hub_;
  std::uint64_t number_;
  Seating place_;
  Stream stream_;
  beast::flat_buffer buffer_{2 * kMaxHeader};
  std::optional<http::request_parser<http::empty_body>> parser_;
  bool keep_alive_ = false, head_ = false;
  std::string host_, text_, rest_;
  std::size_t lingered_ = 0;
  Response response_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
};

}  // namespace isobath::web
