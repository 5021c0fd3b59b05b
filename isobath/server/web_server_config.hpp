// Address and limits of a WebServer.
#pragma once

#include <isobath/base/config.hpp>
#include <string>
#include <vector>

namespace isobath {

struct WebServerConfig {
  std::string address = "127.0.0.1";
  int port = 8484;  ///< 0: any free port
  std::string hosts;
  std::string viewer_origins;
  std::string frame_origins;
  int max_clients = 16;
  int max_connections = 64;
  int max_message_bytes = 16384;
  double messages_hz = 20;
  double frames_hz = 10;
  double request_s = 10;
  double silent_s = 30;
  double stalled_s = 10;
};
std::vector<Field> fields(WebServerConfig& config);

}  // namespace isobath
