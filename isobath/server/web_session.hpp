// WebSession: what one client of a WebServer is told and may ask. The server knows bytes and clients; what is shown is
// known here only.
//
// Made when a client has connected, ended when it is gone; the server's thread calls it, one call at a time. A call
// keeps all other clients waiting. What it throws ends the connection of its client, and is counted.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace isobath {

/// What came of a message. `refused`: why it was not followed, a word of a closed list that the server counts by.
struct Hearing {
  std::string_view refused = {};
  bool hang_up = false;
};

/// One binary message: what many clients get alike, then what is this client's own.
struct WebFrame {
  std::shared_ptr<const std::string> shared = nullptr;
  std::string own = {};
  bool more = false;  ///< there is more to send as soon as this is gone

  [[nodiscard]] std::size_t bytes() const { return (shared ? shared->size() : 0) + own.size(); }
};

class WebSession {
 public:
  virtual ~WebSession() = default;

  /// A text message; UTF-8, no longer than the server allows.
  virtual Hearing hear(std::string_view text) = 0;
  /// What has changed since the last frame, all of which has been sent; without bytes: nothing.
  virtual WebFrame next() = 0;
};

}  // namespace isobath
