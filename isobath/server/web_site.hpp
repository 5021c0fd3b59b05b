// WebSite: what a WebServer serves.
#pragma once

#include <functional>
#include <isobath/server/web_session.hpp>
#include <map>
#include <memory>
#include <string>

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
  std::map<std::string, OpenSession, std::less<>> sockets;  ///< by path: "/socket"
  std::function<std::string()> health = {};                 ///< a JSON object
  std::function<std::string()> metrics = {};                ///< lines to append to the server's own
};

}  // namespace isobath
