// WebCounts: what a WebServer has done so far, and what it would not do.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace isobath {

struct WebCounts {
  int connections = 0;  ///< now, clients among them
  int clients = 0;      ///< now, of the socket
  std::uint64_t connections_ever = 0, clients_ever = 0;
  std::uint64_t requests = 0;
  std::uint64_t messages = 0;  ///< from clients
  std::uint64_t frames = 0, frame_bytes = 0;
  std::uint64_t longest_call_us = 0;  ///< of a session: so long all clients waited
  /// Requests, messages and clients that were refused, held back or dropped, by reason (docs/live-page.md).
  std::map<std::string, std::uint64_t, std::less<>> refused;

  void refuse(std::string_view reason);
};

/// As Prometheus reads it, version 0.0.4 of its text format.
std::string to_prometheus(const WebCounts& counts);

}  // namespace isobath
