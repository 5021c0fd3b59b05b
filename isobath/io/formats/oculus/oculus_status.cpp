#include <isobath/io/bytes/record_writer.hpp>
#include <isobath/io/formats/oculus/oculus_status.hpp>

namespace isobath {
namespace {

constexpr std::uint16_t kOculusMark = 0x4F53, kImagingSonar = 1;
constexpr std::size_t kStatusHeader = 16, kStatusBytes = 142;

/// Octets in order, read as a little-endian number.
std::uint32_t reversed(std::uint32_t octets) {
  return octets << 24 | (octets & 0xff00) << 8 | (octets >> 8 & 0xff00) | octets >> 24;
}

}  // namespace

std::vector<std::byte> oculus_status_bytes(const OculusStatus& status) {
  RecordWriter out(kStatusBytes);
  out.put(0, kOculusMark).put(2, static_cast<std::uint16_t>(status.device));
  out.put(10, static_cast<std::uint32_t>(kStatusBytes - kStatusHeader));
  out.put(16, status.device).put(20, kImagingSonar).put(22, status.part);
  return out.put(52, reversed(status.ip)).put(60, reversed(status.client)).take();
}

std::optional<OculusStatus> oculus_status_of(Bytes message) {
  const RecordView view(message);
  if (message.size() < kStatusBytes || view.at<std::uint16_t>(0) != kOculusMark ||
      view.at<std::uint16_t>(20) != kImagingSonar)
    return std::nullopt;
  return OculusStatus{view.at<std::uint32_t>(16), view.at<std::uint16_t>(22), reversed(view.at<std::uint32_t>(52)),
                      reversed(view.at<std::uint32_t>(60))};
}

std::uint32_t oculus_address(const OculusStatus& status, std::uint32_t sender) {
  return status.ip == 0 || reversed(status.ip) == sender ? sender : status.ip;
}

std::string oculus_model(std::uint16_t part) {
  switch (part) {
    case 1041: return "M370s";
    case 1032: return "M750d";
    case 1042: return "M1200d";
    case 2203: return "M3000d";
    default: return "";
  }
}

}  // namespace isobath
