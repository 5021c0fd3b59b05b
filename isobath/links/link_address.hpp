// LinkAddress: where a device, an autopilot or a viewer is, as one word.
//
//   udp:192.168.2.2:9092          sends to this address and hears what comes back; of 255.255.255.255, from all
//   udp-server:14550              waits at this port of this machine; answers the one that was heard last
//   udp-server:0.0.0.0:14550      likewise for other machines
//   tcp:192.168.194.95:16171      connects, again and again until it works
//   tcp-server:52100              waits for one client at a time
//   serial:/dev/ttyUSB0:115200    8 data bits, no parity, 1 stop bit
//   oculus:auto                   the first Oculus sonar that broadcasts its status (UDP port 52102), then TCP to it
//   oculus:7892                   the one of this device number; oculus:7892:52199 with another port of the broadcasts
//   pty:/tmp/micron               makes a pseudo-terminal, for stand-ins: others open it as serial:/tmp/micron:115200
//
// Servers listen at 127.0.0.1 unless an address is given: other machines must be let in by name.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace isobath {

struct LinkAddress {
  enum class Kind : std::uint8_t { kUdp, kUdpServer, kTcp, kTcpServer, kSerial, kOculus, kPty };
  static constexpr const char* kAnyOculus = "auto";
  Kind kind = Kind::kUdp;
  std::string host;  ///< or the path of a serial device, or the device number of an Oculus
  int port = 0;      ///< or a baud rate
  [[nodiscard]] std::string text() const;
};

/// Throws Error with the forms that are known. `key`: for the message.
LinkAddress link_address_of(std::string_view text, const std::string& key);

}  // namespace isobath
