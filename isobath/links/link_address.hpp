// LinkAddress: where a device, an autopilot or a viewer is, as one word.
//
//   udp:192.168.2.2:9092          sends to this address and hears what comes back
//   udp-server:14550              waits at this port of this machine; answers the one that was heard last
//   udp-server:0.0.0.0:14550      likewise for other machines
//   tcp:192.168.194.95:16171      connects, again and again until it works
//   tcp-server:52100              waits for one client at a time
//   serial:/dev/ttyUSB0:115200    8 data bits, no parity, 1 stop bit
//
// Servers listen at 127.0.0.1 unless an address is given: other machines must be let in by name.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace isobath {

struct LinkAddress {
  enum class Kind : std::uint8_t { kUdp, kUdpServer, kTcp, kTcpServer, kSerial };
  Kind kind = Kind::kUdp;
  std::string host;  ///< or the path of the serial device
  int port = 0;      ///< or its baud rate
  [[nodiscard]] std::string text() const;
};

/// Throws Error with the forms that are known. `key`: for the message.
LinkAddress link_address_of(std::string_view text, const std::string& key);

}  // namespace isobath
