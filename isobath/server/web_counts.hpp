// WebCounts: what a WebServer has done and refused so far.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace isobath {

struct WebCounts {
  int connections = 0;  ///< now, including clients
  int clients = 0;      ///< now, on the socket
  std::uint64_t connections_ever = 0, clients_ever = 0;
  std::uint64_t requests = 0;
  std::uint64_t messages = 0;  ///< from clients
  std::uint64_t frames = 0, frame_bytes = 0;
  std::uint64_t longest_call_us = 0;  ///< longest call of a session; all clients wait meanwhile
  /// Requests, messages and clients that were refused, held back or dropped, by reason (docs/live-page.md).
  std::map<std::string, std::uint64_t, std::less<>> refused;

  void refuse(std::string_view reason);
};

/// In version 0.0.4 of the text format of Prometheus.
std::string to_prometheus(const WebCounts& counts);

}  // namespace isobath
