// The status that an Oculus sonar broadcasts about once a second on UDP port 52102, and from which a host learns its
// address. Source: the open driver liboculus; the byte order of the address was not checked on a sonar.
#pragma once

#include <cstdint>
#include <isobath/io/bytes/bytes.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

inline constexpr int kOculusStatusPort = 52102;

struct OculusStatus {
  std::uint32_t device = 0;  ///< its number
  std::uint16_t part = 0;
  std::uint32_t ip = 0;      ///< IPv4, as a number: 192.168.2.4 is 0xC0A80204; the message has its octets in order
  std::uint32_t client = 0;  ///< the host that is connected to it, likewise; 0: none
};
std::vector<std::byte> oculus_status_bytes(const OculusStatus& status);
/// Empty: another message, or the status of another device than a sonar.
std::optional<OculusStatus> oculus_status_of(Bytes message);
/// Where the sonar is: the address in its status, but that of the sender where the status has none or the same one with
/// its octets reversed.
std::uint32_t oculus_address(const OculusStatus& status, std::uint32_t sender);
/// "M750d"; "" for a part number that is not known.
std::string oculus_model(std::uint16_t part);

}  // namespace isobath
