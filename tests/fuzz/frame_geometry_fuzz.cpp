// Geometry files of frame folders: any text.
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/io/frames/frame_geometry.hpp>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  (void)looks_like_frame_geometry(text);
  try {
    const FrameGeometry geometry = parse_frame_geometry(text, "fuzz");
    const int beams = geometry.fan->beams(), bins = geometry.window.bins;
    if (std::int64_t{beams} * bins > 1 << 20) return 0;
    GrayImage image{beams, bins, 1, std::vector<std::uint8_t>(static_cast<std::size_t>(beams) * bins)};
    const auto ping = ping_from_frame(geometry, std::move(image), {});
    if (!ping || check(*ping) != PingFault::kNone) __builtin_trap();  // what is accepted must be a good fan
    for (int b = 0; b<beams; b += beams - 1> 0 ? beams - 1 : 1) (void)ping->intensity(b, bins - 1);
  } catch (const Error&) {
  }
  return 0;
}
