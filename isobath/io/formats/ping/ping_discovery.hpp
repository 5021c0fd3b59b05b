// How a Ping360 with Ethernet is found: a host broadcasts "Discovery" to UDP port 30303, and each head answers with
// lines of text, among them "SONAR PING360" and its address, whose octets are padded with zeros. Its data are at UDP
// port 12345. Source: Blue Robotics' Ping Viewer; no head was at hand.
#pragma once

#include <isobath/io/bytes/bytes.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace isobath {

inline constexpr int kPing360DiscoveryPort = 30303, kPing360DataPort = 12345;
inline constexpr std::string_view kPing360Discovery = "Discovery";

/// "192.168.1.20" in the answer of a head; empty: another text.
std::optional<std::string> ping360_address_in(Bytes answer);
/// The answer of a head at this address.
std::string ping360_discovery_answer(const std::string& address);

}  // namespace isobath
