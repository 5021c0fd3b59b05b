// Tables of fan detections: any text.
#include <isobath/io/formats/fan_detections.hpp>
#include <sstream>
#include <string>
#include <tests/fuzz/drain.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  (void)looks_like_fan_detections(std::as_bytes(std::span(data, size)));
  try {
    const auto source = open_fan_detections(
        std::make_unique<std::istringstream>(std::string(reinterpret_cast<const char*>(data), size)), "fuzz", {});
    fuzz::drain(*source, size);
  } catch (const Error&) {
  }
  return 0;
}
