// WebSession: the content that one client of a WebServer gets and the requests that it may make. The server knows only
// bytes and clients; a session knows what is shown.
//
// The server makes a session when a client has connected and destroys it when the client is gone. The server's thread
// calls it, one call at a time; all other clients wait meanwhile. An exception ends the connection of this client and
// is counted.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace isobath {

/// The outcome of a message. `refused`: the reason for a refusal, from a closed list, by which the server counts it.
struct Hearing {
  std::string_view refused = {};
  bool hang_up = false;
};

/// One message: a part that is shared between clients, then a part of this client.
struct WebFrame {
  std::shared_ptr<const std::string> shared = nullptr;
  std::string own = {};
  bool more = false;  ///< ask again as soon as this is sent
  bool text = false;  ///< a text message (UTF-8), not a binary one

  [[nodiscard]] std::size_t bytes() const { return (shared ? shared->size() : 0) + own.size(); }
};

class WebSession {
 public:
  virtual ~WebSession() = default;

  /// Called once, before all else: the address of the client, or of the proxy before it.
  virtual void on_client(const std::string& /*address*/) {}
  /// Handles a text message: UTF-8, no longer than the server allows.
  virtual Hearing on_message(std::string_view text) = 0;
  /// The changes since the last frame, which has been sent completely; empty if nothing has changed.
  virtual WebFrame next() = 0;
};

}  // namespace isobath
