// WebSite: what a WebServer serves.
#pragma once

#include <functional>
#include <isobath/server/web_session.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace isobath {

struct WebFile {
  std::string media_type;  ///< "text/html; charset=utf-8"
  std::string bytes;
  std::string gzipped = {};  ///< the same bytes as gzip, for clients that accept it; may be empty
};

/// The server's thread calls all functions. They must not block, and what they refer to must outlive the server.
struct WebSite {
  std::map<std::string, WebFile, std::less<>> files;  ///< by path: "/"
  using OpenSession = std::function<std::unique_ptr<WebSession>()>;
  struct Socket {
    OpenSession open;
    /// Sub-protocols of the socket, of which a client must offer one; empty: none.
    std::vector<std::string> protocols = {};
    /// Whether pages of the origins that the server's settings name may open it, and not only its own.
    bool foreign = false;
  };
  std::map<std::string, Socket, std::less<>> sockets;  ///< by path: "/socket"
  std::function<std::string()> health = {};            ///< a JSON object
  std::function<std::string()> metrics = {};           ///< lines to append to the server's own
};

}  // namespace isobath
