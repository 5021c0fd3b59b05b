// The tracks beside fan detections: a satellite track, and after a byte 0x1e a dead reckoning that uses its compass.
#include <algorithm>
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/io/formats/fan_detections.hpp>
#include <sstream>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = std::min(text.find('\x1e'), text.size());
  const auto satellite = [&] {
    return open_satellite_track(std::make_unique<std::istringstream>(text.substr(0, cut)), "fuzz", {});
  };
  const auto drain = [](Source& source) {
    while (const auto event = source.next()) {
      if (!std::get<Navigation>(*event).X_WB.is_finite()) __builtin_trap();
    }
  };
  try {
    drain(*satellite());
    const std::string rest = cut < text.size() ? text.substr(cut + 1) : std::string();
    drain(*open_dead_reckoning(std::make_unique<std::istringstream>(rest), "fuzz", satellite()));
  } catch (const Error&) {
  }
  return 0;
}
