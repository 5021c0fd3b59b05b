#include <arpa/inet.h>
#include <isobath/io/formats/oculus/oculus_status.hpp>
#include <isobath/io/formats/ping/ping_discovery.hpp>
#include <isobath/standin/device_stand_ins.hpp>

namespace isobath {
namespace {

constexpr Duration kStatusInterval = std::chrono::seconds(1);
constexpr std::uint32_t kDeviceNumber = 7892;
constexpr std::uint16_t kM750d = 1032;

std::vector<std::byte> status_at(const LinkAddress& sonar) {
  in_addr ip{};
  const bool stated = ::inet_pton(AF_INET, sonar.host.c_str(), &ip) == 1;
  return oculus_status_bytes(
      {.device = kDeviceNumber, .part = kM750d, .ip = stated ? ntohl(ip.s_addr) : 0, .client = 0});
}

}  // namespace

OculusBeacon::OculusBeacon(const LinkAddress& sonar) : status_(status_at(sonar)) {}

void OculusBeacon::on_tick(Time now) {
  if (now - told_ < kStatusInterval) return;
  told_ = now;
  link_->send(status_);
}

void Ping360Finder::on_bytes(Bytes bytes, Time /*time*/) {
  if (text_of(bytes) != kPing360Discovery) return;
  const std::string answer = ping360_discovery_answer(host_);
  const Bytes text = bytes_of(answer);
  link_->send({text.begin(), text.end()});
}

}  // namespace isobath
