#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/formats/kongsberg/kongsberg_installation.hpp>

namespace isobath {
namespace {

std::optional<std::string_view> value_of(std::string_view text, std::string_view key) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string_view item = text.substr(at, end - at);
    if (item.size() > key.size() && item.starts_with(key) && item[key.size()] == '=')
      return item.substr(key.size() + 1);
    at = end + 1;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> AllInstallation::number(std::string_view text, std::string_view key) {
  const auto value = value_of(text, key);
  double number = 0;
  if (!value || std::from_chars(value->data(), value->data() + value->size(), number).ec != std::errc()) return {};
  return std::abs(number) < 1e4 ? std::optional(number) : std::nullopt;
}

AllInstallation AllInstallation::read(std::string_view text) {
  AllInstallation result;
  result.water_line_m = number(text, "WLZ").value_or(0);
  const auto active = std::clamp(std::lround(number(text, "APS").value_or(0)), 0L, 2L) + 1;
  const auto value = [&](const std::string& name, const char* key) { return number(text, name + key).value_or(0); };
  const std::string antenna = fmt::format("P{}", active);
  for (std::size_t i = 0; i < result.transducers.size(); ++i) {
    const std::string name = fmt::format("S{}", i + 1);
    WaterMount& transducer = result.transducers[i];
    transducer.p_BS << value(name, "X") - value(antenna, "X"), value(name, "Y") - value(antenna, "Y"), value(name, "Z");
    transducer.heading_deg = value(name, "H");
    transducer.pitch_deg = value(name, "P");
  }
  constexpr long kOneOfEach = 0, kTwoHeads = 2, kTwoReceivers = 3, kNotStated = -1;
  const auto configuration = number(text, "STC");
  const long kind = configuration ? std::lround(*configuration) : kNotStated;
  result.has_receiver = kind == kOneOfEach || kind == kTwoReceivers;
  const auto second = number(text, "R2S");
  if (second && *second > 0 && *second < 65536) {
    const auto serial = static_cast<std::uint16_t>(std::lround(*second));
    if (kind == kTwoHeads) result.second_head = serial;
    if (kind == kTwoReceivers) result.second_receiver = serial;
  }
  return result;
}

WaterMount AllInstallation::mount(std::uint16_t serial) const {
  WaterMount mount = transmitter(serial);
  const std::size_t receiver = second_receiver == serial ? 2 : 1;
  if (has_receiver) mount.p_BS = 0.5 * (mount.p_BS + transducers[receiver].p_BS);
  return mount;
}

}  // namespace isobath
