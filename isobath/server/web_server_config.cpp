#include <isobath/server/web_server_config.hpp>

namespace isobath {

std::vector<Field> fields(WebServerConfig& c) {
  constexpr Range kWait{0.1, 3600};
  return {
      Field::text("address", &c.address,
                  "Address at which the page is served: 127.0.0.1 is this machine only, 0.0.0.0 all."),
      Field::integer("port", &c.port, {0, 65535}, "1", "Port; 0: any free port."),
      Field::text("hosts", &c.hosts, "Host names that requests may use besides addresses, separated by commas."),
      Field::text("viewer_origins", &c.viewer_origins,
                  "Origins of pages elsewhere that may watch through /foxglove, such as https://app.foxglove.dev, "
                  "separated by commas."),
      Field::text(
          "frame_origins", &c.frame_origins,
          "Origins of pages that may show the page in a frame, such as http://blueos.local, separated by commas."),
      Field::integer("max_clients", &c.max_clients, {1, 1000}, "1", "Pages on the socket at a time.")
          .was("most_clients"),
      Field::integer("max_connections", &c.max_connections, {2, 10000}, "1", "Connections at a time, including pages.")
          .was("most_connections"),
      Field::integer("max_message_bytes", &c.max_message_bytes, {256, 65536}, "byte", "Size of a message from a page.")
          .was("most_message_bytes"),
      Field::real("messages_hz", &c.messages_hz, {1, 1000}, "1/s", "Messages accepted from a page; further ones wait."),
      Field::real("frames_hz", &c.frames_hz, {0.1, 60}, "1/s", "Frames sent to a page."),
      Field::real("request_s", &c.request_s, kWait, "s", "A request that is not complete by then is dropped."),
      Field::real("silent_s", &c.silent_s, kWait, "s", "A page that answers no ping for this long is dropped."),
      Field::real("stalled_s", &c.stalled_s, kWait, "s",
                  "A page that takes nothing of a frame for this long is dropped."),
  };
}

}  // namespace isobath
