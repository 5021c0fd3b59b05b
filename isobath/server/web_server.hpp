// WebServer: a page, a socket (WebSocket, RFC 6455) and two pages for machines, over HTTP 1.1. It knows nothing of what
// is shown: that is the WebSessions' (one a client) and the site's.
//
//   /socket           frames to the client, text messages from it
//   /health, /metrics JSON, and text for Prometheus; asked for no more than ten times a second
//   anything else     a file of the site, in memory; there is no file system behind it
//
// Pull, not push: `frames_hz` times a second each client whose last frame is gone is asked what is new. A slow client
// so gets fewer frames, never older ones; for each there is one frame under way, and kUnsentBytes in the system. One
// that takes nothing for `stalled_s` is dropped.
//
// Open to the own machine only, unless `address` says otherwise, and to pages of its own only: a Host that is neither
// an address, localhost nor one of `hosts` is refused, and so is a socket that a page of another origin opens. All of a
// request is bounded: kMostHeader bytes of header, no body, `request_s` until it is whole; of a client, message size,
// messages a second, bytes a second. What is refused, held back or dropped is counted by reason. It speaks no TLS.
//
// One thread of its own; nobody else ever waits for it. Errors: Error where the address cannot be used; later nothing
// is thrown: what a session or the site throws ends that request.
#pragma once

#include <functional>
#include <isobath/base/config.hpp>
#include <isobath/server/web_counts.hpp>
#include <isobath/server/web_session.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace isobath {

struct WebServerConfig {
  std::string address = "127.0.0.1";
  int port = 8484;  ///< 0: any that is free
  std::string hosts;
  int most_clients = 16;
  int most_connections = 64;
  int most_message_bytes = 4096;
  double messages_hz = 20;
  double frames_hz = 10;
  double request_s = 10;
  double silent_s = 30;
  double stalled_s = 10;
};
std::vector<Field> fields(WebServerConfig& config);

struct WebFile {
  std::string media_type;  ///< "text/html; charset=utf-8"
  std::string bytes;
  std::string gzipped = {};  ///< the same as gzip, for who takes it; may be empty
};

/// All is called by the server's thread, and must neither wait nor outlive what it leans on.
struct WebSite {
  std::map<std::string, WebFile, std::less<>> files;  ///< by path: "/"
  std::function<std::unique_ptr<WebSession>()> open_session;
  std::function<std::string()> health = {};   ///< a JSON object
  std::function<std::string()> metrics = {};  ///< lines to stand after the server's own
};

class WebServer {
 public:
  static constexpr std::size_t kMostHeader = 8192, kMostTarget = 1024;
  static constexpr std::size_t kUnsentBytes = 128 * 1024;

  WebServer(const WebServerConfig& config, WebSite site);
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  ~WebServer();

  [[nodiscard]] int port() const;
  [[nodiscard]] WebCounts counts() const;  ///< from any thread
  /// Ends all connections; returns when no session is called any more, which is at once.
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
