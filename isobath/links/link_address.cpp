#include <array>
#include <charconv>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/formats/oculus/oculus_status.hpp>
#include <isobath/links/link_address.hpp>

namespace isobath {
namespace {

using Kind = LinkAddress::Kind;
constexpr std::array<std::pair<std::string_view, Kind>, 7> kKinds{{{"udp", Kind::kUdp},
                                                                   {"udp-server", Kind::kUdpServer},
                                                                   {"tcp", Kind::kTcp},
                                                                   {"tcp-server", Kind::kTcpServer},
                                                                   {"serial", Kind::kSerial},
                                                                   {"oculus", Kind::kOculus},
                                                                   {"pty", Kind::kPty}}};
constexpr int kMaxBaud = 4'000'000, kMaxPort = 65535;

std::string_view word_of(Kind kind) {
  for (const auto& [word, k] : kKinds) {
    if (k == kind) return word;
  }
  return "";
}

}  // namespace

std::string LinkAddress::text() const {
  if (kind == Kind::kPty) return fmt::format("{}:{}", word_of(kind), host);
  return fmt::format("{}:{}:{}", word_of(kind), host, port);
}

LinkAddress link_address_of(std::string_view text, const std::string& key) {
  const auto refuse = [&](const std::string& what) -> LinkAddress {
    throw Error(
        fmt::format("{}: {}", text.substr(0, 80), what), {.key = key},
        "udp:HOST:PORT, udp-server:PORT, tcp:HOST:PORT, tcp-server:PORT, serial:DEVICE:BAUD, oculus:auto or pty:PATH");
  };
  const std::size_t head = text.find(':');
  if (head == std::string_view::npos) return refuse("not the address of a link");
  LinkAddress address;
  bool known = false;
  for (const auto& [word, kind] : kKinds) {
    if (text.substr(0, head) != word) continue;
    address.kind = kind;
    known = true;
  }
  if (!known) return refuse("no such kind of link");
  std::string_view rest = text.substr(head + 1);
  if (address.kind == Kind::kPty && !rest.empty()) {
    address.host = rest;
    return address;
  }
  if (address.kind == Kind::kOculus && rest.find(':') == std::string_view::npos) {
    address.host = rest;
    address.port = kOculusStatusPort;
    if (rest.empty()) return refuse("auto or the number of the device is missing");
    return address;
  }
  const std::size_t last = rest.rfind(':');
  const bool server = address.kind == Kind::kUdpServer || address.kind == Kind::kTcpServer;
  if (last == std::string_view::npos && !server) return refuse("the host or the port is missing");
  address.host = last == std::string_view::npos ? "127.0.0.1" : std::string(rest.substr(0, last));
  const std::string_view number = last == std::string_view::npos ? rest : rest.substr(last + 1);
  const auto [end, fault] = std::from_chars(number.data(), number.data() + number.size(), address.port);
  const int most = address.kind == Kind::kSerial ? kMaxBaud : kMaxPort;
  if (fault != std::errc() || end != number.data() + number.size() || address.port < 0 || address.port > most)
    return refuse(address.kind == Kind::kSerial ? "the baud rate is no number" : "the port is no number up to 65535");
  if (address.port == 0 && !server) return refuse("port 0 is for servers only");
  if (address.host.empty()) return refuse("the host is missing");
  return address;
}

}  // namespace isobath
