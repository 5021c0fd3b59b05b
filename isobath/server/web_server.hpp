// WebServer: serves a page, a socket (WebSocket, RFC 6455) and two pages for machines over HTTP 1.1. The content comes
// from the site and from the WebSessions, one per client.
//
//   /socket           frames to the client, text messages from it
//   /health, /metrics JSON, and text for Prometheus; made anew at most ten times a second
//   anything else     a file of the site, in memory; there is no file system behind it
//
// Pull, not push: `frames_hz` times a second the server asks the session of each client whose last frame is sent for
// what is new. A slow client therefore gets fewer frames, never older ones. Per client one frame is being sent, with at
// most kUnsentBytes in the system. The server drops a client that takes nothing for `stalled_s`.
//
// By default the server listens to this machine only (`address`) and serves its own pages only: it refuses a Host that
// is neither a numeric address, localhost nor one of `hosts`, and a socket that a page of another origin opens, but for
// a viewer of one of `viewer_origins` where the site lets viewers in (WebSite::Socket). A request is bounded: 8192
// bytes of header, no body, complete within `request_s`. A client is bounded in message size, messages per second and
// bytes per second. Everything refused, held back or dropped is counted by reason. There is no TLS.
//
// The server has one thread of its own; no other thread waits for it. Errors: the constructor throws Error if the
// address cannot be used. Later nothing is thrown; an exception of a session or of the site ends that request.
#pragma once

#include <cstddef>
#include <isobath/server/web_counts.hpp>
#include <isobath/server/web_server_config.hpp>
#include <isobath/server/web_site.hpp>
#include <memory>

namespace isobath {

class WebServer {
 public:
  static constexpr std::size_t kUnsentBytes = 128 * 1024;

  WebServer(const WebServerConfig& config, WebSite site);
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  ~WebServer();

  [[nodiscard]] int port() const;
  [[nodiscard]] WebCounts counts() const;  ///< from any thread
  /// Closes all connections. Returns at once; no session is called afterwards.
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
